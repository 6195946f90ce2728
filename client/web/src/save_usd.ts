// Universal Scene Description, .usda, as core/files/write_usd.cpp writes it: a TetMesh with its subsets.
import { cornersOf, faceGroups, type FaceGroup } from "./face_groups";
import { namesInFile } from "./file_names";
import { shortFloat32, type FileParts } from "./file_parts";
import { fieldsOf, valuesOf } from "./mesh_columns";
import { GroupedTets, tetGroups, type TetGroups } from "./tet_groups";
import type { TetMesh } from "./tet_mesh";

function tuple(numbers: number[]): string {
  return `(${numbers.map((x) => shortFloat32(Math.fround(x))).join(", ")})`;
}

/** Things with commas between them, in brackets: some more of them each time. */
class List {
  private next = 0;

  constructor(private readonly file: FileParts, name: string) {
    file.text(`${name} = [`);
  }

  /** Adds those of `count` that are something. */
  add(count: number, text: (i: number) => string): void {
    this.file.lines(count, (i) => {
      const one = text(i);
      if (!one) return "";
      return (this.next === 0 ? "" : this.next % 8 === 0 ? ",\n" : ", ") + (++this.next, one);
    });
  }

  end(behind = "\n"): void {
    this.file.text(`]${behind}`);
  }
}

/** Where the origin is: positions are stored relative to it, and stay so. */
function writePlace({ header }: TetMesh, file: FileParts): void {
  const o = header.origin, { min, max } = header.bounds ?? {};
  const x = o?.x ?? 0, y = o?.y ?? 0, z = o?.z ?? 0;
  file.text(`    double3 xformOp:translate = (${x}, ${y}, ${z})\n    uniform token[] xformOpOrder = ["xformOp:translate"]\n` +
    `    float3[] extent = [${tuple([(min?.x ?? 0) - x, (min?.y ?? 0) - y, (min?.z ?? 0) - z])}, ` +
    `${tuple([(max?.x ?? 0) - x, (max?.y ?? 0) - y, (max?.z ?? 0) - z])}]\n`);
}

function writeGeometry(mesh: TetMesh, surfaces: FaceGroup[], file: FileParts): void {
  const points = new List(file, "    point3f[] points");
  mesh.store.forEachPositions((_, p) =>
    points.add(p.length / 3, (v) => tuple([p[v * 3]!, p[v * 3 + 1]!, p[v * 3 + 2]!])));
  points.end();
  const tets = new List(file, "    int4[] tetVertexIndices");
  mesh.store.forEach(({ tets: t, count }) =>
    tets.add(count, (i) => `(${t[i * 4]}, ${t[i * 4 + 1]}, ${t[i * 4 + 2]}, ${t[i * 4 + 3]})`));
  tets.end();
  const triangles = new List(file, "    int3[] surfaceFaceVertexIndices");
  for (const { faces } of surfaces) {
    const rows = new Uint32Array(faces.length * 3);
    mesh.forFaces(faces, (i, columns, tet, corner) => rows.set(cornersOf(columns, tet, corner), i * 3));
    triangles.add(faces.length, (i) => `(${rows[i * 3]}, ${rows[i * 3 + 1]}, ${rows[i * 3 + 2]})`);
  }
  triangles.end();
}

function writePrimvars(mesh: TetMesh, file: FileParts): void {
  const fields = fieldsOf(mesh.header), names = namesInFile(fields.map(({ name }) => name));
  fields.forEach((field, i) => {
    const { components } = field;
    const list = new List(file, `    ${components === 1 ? "float[]" : "vector3f[]"} primvars:${names[i]}`);
    mesh.store.forEach((columns) => {
      const values = valuesOf(field, columns);
      list.add(columns.vertices, (v) => (components === 1 ? shortFloat32(values[v]!)
        : tuple([...values.subarray(v * 3, v * 3 + 3)])));
    });
    list.end(' (\n        interpolation = "vertex"\n    )\n');
  });
}

function beginSubset(file: FileParts, name: string, element: string, family: string): List {
  file.text(`\n    def GeomSubset "${name}"\n    {\n        uniform token elementType = "${element}"\n` +
    `        uniform token familyName = "${family}"\n`);
  return new List(file, "        int[] indices");
}

/** Their names are of one list: they are prims of one parent. */
function writeSubsets(mesh: TetMesh, groups: TetGroups, surfaces: FaceGroup[], file: FileParts): void {
  const grouped = new GroupedTets(groups, mesh.store);
  const names = namesInFile([...groups.names, ...surfaces.map(({ name }) => name)]);
  groups.names.forEach((_, group) => {
    const tets = beginSubset(file, names[group]!, "tetrahedron", "regions");
    grouped.forEach(group, ({ firstTet }, own) => tets.add(own.length, (i) => String(firstTet + own[i]!)));
    tets.end("\n    }\n");
  });
  let first = 0;
  surfaces.forEach(({ faces }, i) => {
    const list = beginSubset(file, names[groups.names.length + i]!, "face", "surfaces");
    list.add(faces.length, (face) => String(first + face));
    list.end("\n    }\n");
    first += faces.length;
  });
}

export function writeUsd(mesh: TetMesh, file: FileParts): void {
  const surfaces = faceGroups(mesh);
  file.text('#usda 1.0\n(\n    defaultPrim = "mesh"\n    metersPerUnit = 1\n    upAxis = "Z"\n)\n\ndef TetMesh "mesh"\n{\n');
  writePlace(mesh, file);
  writeGeometry(mesh, surfaces, file);
  writePrimvars(mesh, file);
  writeSubsets(mesh, tetGroups(mesh.header), surfaces, file);
  file.text("}\n");
}
