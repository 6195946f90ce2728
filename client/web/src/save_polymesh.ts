// OpenFOAM's polyMesh, as core/files/write_polymesh.cpp writes it, byte for byte: a folder, in a .zip.
import { cornersOf } from "./face_groups";
import { namesInFile } from "./file_names";
import type { FileParts } from "./file_parts";
import { FoamFaces } from "./foam_faces";
import { GroupedTets, tetGroups } from "./tet_groups";
import type { TetMesh } from "./tet_mesh";
import { forEachPoints } from "./world_points";
import { ZipFile } from "./zip";

const kFolder = "polyMesh/";
const kMostCorners = 2 ** 31 - 1;

/** Labels of 32 bits, written by the thousand. */
class Labels {
  private rows = new Int32Array(1 << 16);
  private held = 0;

  constructor(private readonly file: FileParts) {}

  put(label: number): void {
    if (this.held === this.rows.length) this.flush();
    this.rows[this.held++] = label;
  }

  flush(): void {
    this.file.bytes(this.rows.slice(0, this.held));
    this.held = 0;
  }
}

function foamHeader(of: string, object: string, binary: boolean, note = ""): string {
  return `FoamFile\n{\n    version     2.0;\n    format      ${binary ? "binary" : "ascii"};\n    class       ${of};\n` +
    (binary ? '    arch        "LSB;label=32;scalar=64";\n' : "") + note +
    `    location    "constant/polyMesh";\n    object      ${object};\n}\n\n`;
}

/** A list in binary: its length, and the bytes in parentheses. */
function writeList(file: FileParts, count: number, write: (put: (label: number) => void) => void): void {
  file.text(`${count}\n(`);
  const labels = new Labels(file);
  write((label) => labels.put(label));
  labels.flush();
  file.text(")\n");
}

function writePoints(mesh: TetMesh, file: FileParts): void {
  file.text(`${foamHeader("vectorField", "points", true)}${mesh.store.vertices}\n(`);
  forEachPoints(mesh.header, mesh.store, (points) => file.bytes(points), true);
  file.text(")\n");
}

/** Where each face begins among all corners, and the corners. */
function writeFaces(mesh: TetMesh, faces: FoamFaces, file: FileParts): void {
  const { count } = faces;
  file.text(foamHeader("faceCompactList", "faces", true));
  writeList(file, count + 1, (put) => {
    for (let i = 0; i <= count; ++i) put(3 * i);
  });
  writeList(file, 3 * count, (put) => {
    faces.forInner((columns, tet, corner) => cornersOf(columns, tet, corner).forEach(put));
    for (const patch of faces.patches) {
      mesh.forFaces(patch.faces, (_, columns, tet, corner) => cornersOf(columns, tet, corner).forEach(put));
    }
  });
}

function writeOwners(faces: FoamFaces, note: string, file: FileParts): void {
  file.text(foamHeader("labelList", "owner", true, note));
  writeList(file, faces.count, (put) => {
    faces.forInner((columns, tet) => put(columns.firstTet + tet));
    for (const patch of faces.patches) for (const face of patch.faces) put(face >>> 2);
  });
}

function writeNeighbours(faces: FoamFaces, note: string, file: FileParts): void {
  file.text(foamHeader("labelList", "neighbour", true, note));
  writeList(file, faces.innerCount, (put) => faces.forInner((_c, _t, _k, behind) => put(behind)));
}

function writePatches({ patches, innerCount }: FoamFaces, file: FileParts): void {
  const names = namesInFile(patches.map(({ name }) => name));
  let next = innerCount;
  file.text(`${foamHeader("polyBoundaryMesh", "boundary", false)}${patches.length}\n(\n` + patches.map(({ faces }, i) => {
    next += faces.length;
    return `    ${names[i]}\n    {\n        type            patch;\n        nFaces          ${faces.length};\n` +
      `        startFace       ${next - faces.length};\n    }\n`;
  }).join("") + ")\n");
}

/** The members of a zone as text, in parentheses. */
function writeMembers(file: FileParts, what: string, count: number, write: () => void): void {
  file.text(`        ${what}\n${count}\n(\n`);
  write();
  file.text(")\n;\n");
}

function writeCellZones(mesh: TetMesh, file: FileParts): void {
  const groups = tetGroups(mesh.header), grouped = new GroupedTets(groups, mesh.store), { there } = grouped;
  const names = namesInFile(there.map((i) => groups.names[i]!));
  file.text(`${foamHeader("regIOobject", "cellZones", false)}${there.length}\n(\n`);
  there.forEach((group, i) => {
    file.text(`    ${names[i]}\n    {\n        type cellZone;\n`);
    writeMembers(file, "cellLabels List<label>", grouped.counts[group]!, () =>
      grouped.forEach(group, ({ firstTet }, own) => file.lines(own.length, (i) => `${firstTet + own[i]!}\n`)));
    file.text("    }\n");
  });
  file.text(")\n");
}

function writeFaceZones({ zones }: FoamFaces, file: FileParts): void {
  const names = namesInFile(zones.map(({ name }) => name));
  file.text(`${foamHeader("regIOobject", "faceZones", false)}${zones.length}\n(\n`);
  zones.forEach(({ faces, flipped }, i) => {
    file.text(`    ${names[i]}\n    {\n        type faceZone;\n`);
    writeMembers(file, "faceLabels List<label>", faces.length, () => file.lines(faces.length, (f) => `${faces[f]}\n`));
    writeMembers(file, "flipMap List<bool>", faces.length,
      () => file.lines(faces.length, (f) => (flipped[f] ? "1\n" : "0\n")));
    file.text("    }\n");
  });
  file.text(")\n");
}

export function writePolyMesh(mesh: TetMesh, file: FileParts): void {
  const faces = new FoamFaces(mesh);
  try {
    if (3 * faces.count > kMostCorners) throw new Error("the mesh has more faces than a polyMesh counts");
    // OpenFOAM reads how many of everything there are before it reads the labels.
    const note = `    note        "nPoints:${mesh.store.vertices}  nCells:${mesh.header.tetCount}  nFaces:${faces.count}` +
      `  nInternalFaces:${faces.innerCount}";\n`;
    const zip = new ZipFile(file), add = (name: string, write: (to: FileParts) => void): void => zip.add(kFolder + name, write);
    add("points", (to) => writePoints(mesh, to));
    add("faces", (to) => writeFaces(mesh, faces, to));
    add("owner", (to) => writeOwners(faces, note, to));
    add("neighbour", (to) => writeNeighbours(faces, note, to));
    add("boundary", (to) => writePatches(faces, to));
    add("cellZones", (to) => writeCellZones(mesh, to));
    if (faces.zones.length > 0) add("faceZones", (to) => writeFaceZones(faces, to));
    zip.end();
  } finally {
    faces.free();
  }
}
