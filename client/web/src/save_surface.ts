// The surface alone: .stl, .obj and .ply, as core/files writes them.
import { cornersOf, faceGroups, type FaceGroup } from "./face_groups";
import { columnNames, inComment, namesInFile } from "./file_names";
import { shortFloat32, type FileParts } from "./file_parts";
import type { TetMesh } from "./tet_mesh";
import { forEachPoints, isWide, type WorldPoints } from "./world_points";

/** The vertices that faces have, numbered from 0 on in the mesh's order. */
class SurfaceVertices {
  private readonly place: Uint32Array;
  count = 0;

  constructor(private readonly mesh: TetMesh, groups: FaceGroup[]) {
    this.place = new Uint32Array(mesh.store.vertices);
    for (const { faces } of groups) {
      mesh.forFaces(faces, (_, columns, tet, corner) => cornersOf(columns, tet, corner).forEach((v) => (this.place[v] = 1)));
    }
    for (let v = 0; v < this.place.length; ++v) if (this.place[v]) this.place[v] = ++this.count;
  }

  has(vertex: number): boolean {
    return this.place[vertex]! > 0;
  }

  /** Calls `use` with the places of each face's corners. */
  forTriangles({ faces }: FaceGroup, use: (i: number, corners: number[]) => void): void {
    this.mesh.forFaces(faces, (i, columns, tet, corner) =>
      use(i, cornersOf(columns, tet, corner).map((v) => this.place[v]! - 1)));
  }
}

export function writeStl(mesh: TetMesh, file: FileParts): void {
  const all: WorldPoints = isWide(mesh.header) ? new Float64Array(mesh.store.vertices * 3)
    : new Float32Array(mesh.store.vertices * 3);
  forEachPoints(mesh.header, mesh.store, (p, first) => all.set(p, first * 3));
  const near = mesh.store.allPositions();  // far from zero a normal would lose its digits
  const triangles = stlTriangles(mesh);
  // Readers take a file that begins with "solid" for text.
  file.text("binary STL of a boundary, written by tetstream".padEnd(80));
  file.bytes(Uint32Array.of(triangles.length / 3));
  const rows = new DataView(new ArrayBuffer((triangles.length / 3) * 50));
  for (let i = 0; i * 3 < triangles.length; ++i) {
    const corners = triangles.subarray(i * 3, i * 3 + 3);
    normalOf(near, corners).forEach((x, axis) => rows.setFloat32(i * 50 + axis * 4, x, true));
    corners.forEach((v, k) => {
      for (let axis = 0; axis < 3; ++axis) rows.setFloat32(i * 50 + 12 + (k * 3 + axis) * 4, all[v * 3 + axis]!, true);
    });
  }
  file.bytes(rows);
}

/** Three vertices a triangle. A mesh that keeps its surface alone knows no names. */
function stlTriangles(mesh: TetMesh): Uint32Array {
  if (!mesh.keepsTets) return mesh.openCorners();
  const groups = faceGroups(mesh);
  const all = new Uint32Array(3 * groups.reduce((sum, { faces }) => sum + faces.length, 0));
  let first = 0;
  for (const { faces } of groups) {
    mesh.forFaces(faces, (i, columns, tet, corner) => all.set(cornersOf(columns, tet, corner), (first + i) * 3));
    first += faces.length;
  }
  return all;
}

function normalOf(p: Float32Array | Float64Array, corners: Uint32Array): number[] {
  const [a, b, c] = corners as unknown as [number, number, number];
  const u = [0, 1, 2].map((axis) => p[b * 3 + axis]! - p[a * 3 + axis]!);
  const v = [0, 1, 2].map((axis) => p[c * 3 + axis]! - p[a * 3 + axis]!);
  const n = [u[1]! * v[2]! - u[2]! * v[1]!, u[2]! * v[0]! - u[0]! * v[2]!, u[0]! * v[1]! - u[1]! * v[0]!];
  const length = Math.hypot(...n);
  return length === 0 ? [0, 0, 0] : n.map((x) => x / length);
}

export function writeObj(mesh: TetMesh, file: FileParts): void {
  const groups = faceGroups(mesh), vertices = new SurfaceVertices(mesh, groups);
  const names = namesInFile(groups.map(({ name }) => name));
  const text = isWide(mesh.header) ? String : shortFloat32;
  file.text("# the boundary of a mesh, written by tetstream\n");
  forEachPoints(mesh.header, mesh.store, (p, first) => file.lines(p.length / 3, (v) => (!vertices.has(first + v) ? ""
    : `v ${text(p[v * 3]!)} ${text(p[v * 3 + 1]!)} ${text(p[v * 3 + 2]!)}\n`)));
  groups.forEach((group, i) => {
    if (names[i] !== group.name) file.text(`# ${names[i]}: ${inComment(group.name)}\n`);
    file.text(`g ${names[i]}\n`);
    const lines: string[] = [];
    vertices.forTriangles(group, (_, [a, b, c]) => lines.push(`f ${a! + 1} ${b! + 1} ${c! + 1}\n`));
    file.lines(lines.length, (line) => lines[line]!);
  });
}

export function writePly(mesh: TetMesh, file: FileParts): void {
  const { header, store } = mesh;
  const groups = faceGroups(mesh), vertices = new SurfaceVertices(mesh, groups);
  const wide = isWide(header), bytes = wide ? 8 : 4;
  const axes = ["x", "y", "z"];
  const properties = columnNames(header.fields, { taken: axes }).flat().map((name) => `property float ${name}\n`);
  file.text("ply\nformat binary_little_endian 1.0\ncomment written by tetstream\n" +
    groups.map(({ tag, name }) => `comment label ${tag} ${inComment(name)}\n`).join("") +
    `element vertex ${vertices.count}\n` +
    axes.map((axis) => `property ${wide ? "double" : "float"} ${axis}\n`).join("") + properties.join("") +
    `element face ${groups.reduce((sum, { faces }) => sum + faces.length, 0)}\n` +
    "property list uchar int vertex_indices\nproperty ushort label\nend_header\n");
  const origin = [header.origin?.x ?? 0, header.origin?.y ?? 0, header.origin?.z ?? 0];
  store.forEach(({ firstVertex, vertices: count, positions, fields }) => {
    const size = 3 * bytes + properties.length * 4, rows = new DataView(new ArrayBuffer(count * size));
    let at = 0;
    for (let v = 0; v < count; ++v) {
      if (!vertices.has(firstVertex + v)) continue;
      for (let axis = 0; axis < 3; ++axis) {
        const x = positions[v * 3 + axis]! + origin[axis]!;
        if (wide) rows.setFloat64(at + axis * 8, x, true);
        else rows.setFloat32(at + axis * 4, x, true);
      }
      properties.forEach((_, f) => rows.setFloat32(at + 3 * bytes + f * 4, fields![v * properties.length + f]!, true));
      at += size;
    }
    file.bytes(new Uint8Array(rows.buffer, 0, at));
  });
  for (const group of groups) {
    const rows = new DataView(new ArrayBuffer(group.faces.length * 15));
    vertices.forTriangles(group, (i, corners) => {
      rows.setUint8(i * 15, 3);
      corners.forEach((place, k) => rows.setInt32(i * 15 + 1 + 4 * k, place, true));
      rows.setUint16(i * 15 + 13, group.tag, true);
    });
    file.bytes(rows);
  }
}
