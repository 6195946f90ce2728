// VTK's HDF5 unstructured grids, .vtkhdf of version 1.0, as core/files/write_vtkhdf.cpp writes them.
import { shortNames } from "./file_names";
import type { FileParts } from "./file_parts";
import { Hdf5Group, writeHdf5, type Hdf5Type } from "./hdf5";
import { fieldsOf, tetLabels, valuesOf, type LabelType } from "./mesh_columns";
import type { TetMesh } from "./tet_mesh";
import { forEachPoints, isWide } from "./world_points";

const kTetra = 10, kMostNameBytes = 4096;
const kTypes: Record<LabelType, Hdf5Type> = { UInt8: "u8", Int32: "i32", Int64: "i64" };

/** Names as HDF5 has them, for which a slash parts groups, a dot is the group itself, and none is no name; no two alike. */
function namesInHdf5(names: string[]): string[] {
  return shortNames(names.map((name) => (name === "." ? "_" : name.replace(/\//g, "_") || "n")), kMostNameBytes);
}

export function writeVtkHdf(mesh: TetMesh, file: FileParts): void {
  const { header, store } = mesh;
  const tets = Number(header.tetCount);
  const root = new Hdf5Group(), grid = root.group("VTKHDF");
  grid.integers("Version", [1, 0]);
  grid.text("Type", "UnstructuredGrid");
  grid.number("NumberOfPoints", store.vertices);
  grid.number("NumberOfCells", tets);
  grid.number("NumberOfConnectivityIds", tets * 4);
  grid.column("Points", isWide(header) ? "f64" : "f32", [store.vertices, 3],
    (to) => forEachPoints(header, store, (points) => to.bytes(points)));
  grid.column("Connectivity", "i32", [tets * 4], (to) => store.forEach((columns) => to.bytes(columns.tets.slice())));
  grid.column("Offsets", "i32", [tets + 1], (to) => {
    to.bytes(Int32Array.of(0));
    store.forEach(({ firstTet, count }) => to.bytes(Int32Array.from({ length: count }, (_, t) => (firstTet + t + 1) * 4)));
  });
  grid.column("Types", "u8", [tets], (to) => store.forEach(({ count }) => to.bytes(new Uint8Array(count).fill(kTetra))));
  const labels = tetLabels(header);
  if (labels) {
    grid.group("CellData").column(labels.name, kTypes[labels.type], [tets],
      (to) => store.forEach((columns) => to.bytes(labels.of(columns))));
  }
  if (header.parts.length > 0) {
    const numbers = grid.group("FieldData");
    namesInHdf5(header.parts.map(({ name }) => name)).forEach((name, i) => numbers.number(name, i + 1));
  }
  const fields = fieldsOf(header);
  if (fields.length > 0) {
    const data = grid.group("PointData"), names = namesInHdf5(fields.map(({ name }) => name));
    fields.forEach((field, i) => data.column(names[i]!, "f32",
      field.components === 1 ? [store.vertices] : [store.vertices, field.components],
      (to) => store.forEach((columns) => to.bytes(valuesOf(field, columns)))));
  }
  writeHdf5(file, root);
}
