// Gmsh's .msh 4.1, binary, as core/files/write_msh.cpp writes it: all is in physical groups.
import { cornersOf, faceGroups, type FaceGroup } from "./face_groups";
import { shortNames } from "./file_names";
import type { FileParts } from "./file_parts";
import { GroupedTets, tetGroups, type TetGroups } from "./tet_groups";
import type { TetMesh } from "./tet_mesh";
import { forEachPoints } from "./world_points";

const kSurface = 2, kVolume = 3, kTriangle = 2, kTet = 4;
// The format has names of at most 127 bytes, and readers fail on more.
const kMostNameBytes = 120;

/** Unsigned numbers of eight bytes, all below 2^32. */
function wide(...numbers: number[]): Uint32Array {
  return Uint32Array.from(numbers.flatMap((number) => [number, 0]));
}

/** Lines that name the physical groups of one dimension: quoted, each on its own line, none empty. */
function nameLines(dimension: number, tags: number[], names: string[]): string {
  const short = shortNames(names.map((name) => name.replace(/["\n\r]/g, "'") || "n"), kMostNameBytes);
  return tags.map((tag, i) => `${dimension} ${tag} "${short[i]}"\n`).join("");
}

function writeNames(file: FileParts, surfaces: FaceGroup[], volumes: TetGroups): void {
  file.text(`$PhysicalNames\n${surfaces.length + volumes.tags.length}\n` +
    nameLines(kSurface, surfaces.map(({ tag }) => tag), surfaces.map(({ name }) => name)) +
    nameLines(kVolume, volumes.tags, volumes.names) + "$EndPhysicalNames\n");
}

function writeEntities(mesh: TetMesh, file: FileParts, surfaces: number[], volumes: number[]): void {
  const { min, max } = mesh.header.bounds ?? {};
  const box = Float64Array.from([min, max].flatMap((p) => [p?.x ?? 0, p?.y ?? 0, p?.z ?? 0]));
  file.text("$Entities\n");
  file.bytes(wide(0, 0, surfaces.length, volumes.length));
  for (const tag of [...surfaces, ...volumes]) {
    file.bytes(Int32Array.of(tag));
    file.bytes(box);
    file.bytes(wide(1));
    file.bytes(Int32Array.of(tag));
    file.bytes(wide(0));
  }
  file.text("\n$EndEntities\n");
}

function writeNodes(mesh: TetMesh, file: FileParts, volume: number): void {
  const { header, store } = mesh;
  file.text("$Nodes\n");
  file.bytes(wide(1, store.vertices, 1, store.vertices));
  file.bytes(Int32Array.of(kVolume, volume, 0));
  file.bytes(wide(store.vertices));
  forEachPoints(header, store, (points, first) => {
    const numbers = new Uint32Array((points.length / 3) * 2);
    for (let v = 0; v * 2 < numbers.length; ++v) numbers[v * 2] = first + v + 1;
    file.bytes(numbers);
  });
  forEachPoints(header, store, (points) => file.bytes(points), true);
  file.text("\n$EndNodes\n");
}

/** The tets of a group, with their numbers in the mesh as tags. */
function writeTets(tets: GroupedTets, file: FileParts, group: number): void {
  tets.forEach(group, ({ tets, firstTet }, own) => {
    const rows = new Uint32Array(own.length * 10);
    own.forEach((t, row) => {
      rows[row * 10] = firstTet + t + 1;
      for (let k = 0; k < 4; ++k) rows[row * 10 + 2 + 2 * k] = tets[t * 4 + k]! + 1;
    });
    file.bytes(rows);
  });
}

function writeTriangles(mesh: TetMesh, file: FileParts, { faces }: FaceGroup, first: number): void {
  const rows = new Uint32Array(faces.length * 8);
  mesh.forFaces(faces, (i, columns, tet, corner) => {
    rows[i * 8] = first + i;
    cornersOf(columns, tet, corner).forEach((vertex, k) => (rows[i * 8 + 2 + 2 * k] = vertex + 1));
  });
  file.bytes(rows);
}

function writeFields(mesh: TetMesh, file: FileParts): void {
  const { header, store } = mesh;
  const floats = header.fields.reduce((sum, field) => sum + field.components, 0);
  let at = 0;
  for (const { name, components } of header.fields) {
    file.text(`$NodeData\n1\n"${name}"\n1\n0.0\n3\n0\n${components}\n${store.vertices}\n`);
    const own = at;
    store.forEach(({ firstVertex, vertices, fields }) => {
      const size = 4 + 8 * components, rows = new DataView(new ArrayBuffer(vertices * size));
      for (let v = 0; v < vertices; ++v) {
        rows.setInt32(v * size, firstVertex + v + 1, true);
        for (let c = 0; c < components; ++c) rows.setFloat64(v * size + 4 + 8 * c, fields![v * floats + own + c]!, true);
      }
      file.bytes(rows);
    });
    file.text("\n$EndNodeData\n");
    at += components;
  }
}

export function writeMsh(mesh: TetMesh, file: FileParts): void {
  const groups = tetGroups(mesh.header), surfaces = faceGroups(mesh);
  const grouped = new GroupedTets(groups, mesh.store), { counts } = grouped;
  const tets = Number(mesh.header.tetCount);
  const triangles = surfaces.reduce((sum, surface) => sum + surface.faces.length, 0);
  file.text("$MeshFormat\n4.1 1 8\n");
  file.bytes(Int32Array.of(1));  // tells a reader the byte order
  file.text("\n$EndMeshFormat\n");
  writeNames(file, surfaces, groups);
  writeEntities(mesh, file, surfaces.map(({ tag }) => tag), groups.tags);
  writeNodes(mesh, file, groups.tags[0]!);
  file.text("$Elements\n");
  // Not every reader takes an empty block.
  file.bytes(wide(counts.filter((count) => count > 0).length + surfaces.length, tets + triangles, 1, tets + triangles));
  counts.forEach((count, group) => {
    if (count === 0) return;
    file.bytes(Int32Array.of(kVolume, groups.tags[group]!, kTet));
    file.bytes(wide(count));
    writeTets(grouped, file, group);
  });
  let first = tets + 1;
  for (const surface of surfaces) {
    file.bytes(Int32Array.of(kSurface, surface.tag, kTriangle));
    file.bytes(wide(surface.faces.length));
    writeTriangles(mesh, file, surface, first);
    first += surface.faces.length;
  }
  file.text("\n$EndElements\n");
  writeFields(mesh, file);
}
