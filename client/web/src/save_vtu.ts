// VTK's unstructured grids, .vtu: all of the mesh.
import { xml } from "./file_names";
import type { FileParts } from "./file_parts";
import { fieldsOf, kLabelBytes, tetLabels, valuesOf } from "./mesh_columns";
import { distinctNames } from "./tet_groups";
import type { TetMesh } from "./tet_mesh";
import { forEachPoints, isWide } from "./world_points";

interface Column {
  attributes: string;
  bytes: number;
  write: () => void;
}

function labelColumn(mesh: TetMesh, file: FileParts): Column | undefined {
  const labels = tetLabels(mesh.header);
  return labels && { attributes: `type="${labels.type}" Name="${labels.name}"`,
    bytes: Number(mesh.header.tetCount) * kLabelBytes[labels.type],
    write: () => mesh.store.forEach((columns) => file.bytes(labels.of(columns))) };
}

function fieldColumns(mesh: TetMesh, file: FileParts): Column[] {
  const { header, store } = mesh;
  return fieldsOf(header).map((field) => ({
    attributes: `type="Float32" Name="${xml(field.name)}"${field.components === 3 ? ' NumberOfComponents="3"' : ""}`,
    bytes: store.vertices * field.components * 4,
    write: () => store.forEach((columns) => file.bytes(valuesOf(field, columns))) }));
}

function fieldData(mesh: TetMesh): string {
  const one = (type: string, name: string, number: number | bigint): string =>
    `<DataArray type="${type}" Name="${xml(name)}" NumberOfTuples="1" format="ascii">${number}</DataArray>\n`;
  const { parts, labels } = mesh.header, names = distinctNames(labels);
  const text = parts.map((part, i) => one("Int32", part.name, i + 1)).join("") +
    labels.map((label, i) => (label.name ? one("Int64", names[i]!, label.value) : "")).join("");
  return text && `<FieldData>\n${text}</FieldData>\n`;
}

export function writeVtu(mesh: TetMesh, file: FileParts): void {
  const { header, store } = mesh;
  const tets = Number(header.tetCount), wide = isWide(header);
  const points: Column = { attributes: `type="${wide ? "Float64" : "Float32"}" Name="Points" NumberOfComponents="3"`,
    bytes: store.vertices * 3 * (wide ? 8 : 4), write: () => forEachPoints(header, store, (p) => file.bytes(p)) };
  const cells: Column[] = [
    { attributes: 'type="Int32" Name="connectivity"', bytes: tets * 16,
      write: () => store.forEach((columns) => file.bytes(columns.tets.slice())) },
    { attributes: 'type="Int32" Name="offsets"', bytes: tets * 4,
      write: () => store.forEach(({ firstTet, count }) =>
        file.bytes(Int32Array.from({ length: count }, (_, t) => (firstTet + t + 1) * 4))) },
    { attributes: 'type="UInt8" Name="types"', bytes: tets,
      write: () => store.forEach(({ count }) => file.bytes(new Uint8Array(count).fill(10))) }];
  const fields = fieldColumns(mesh, file), label = labelColumn(mesh, file);
  let offset = 0;
  const named = (columns: Column[]): string => columns.map(({ attributes, bytes }) => {
    const text = `<DataArray ${attributes} format="appended" offset="${offset}"/>\n`;
    offset += 8 + bytes;
    return text;
  }).join("");
  file.text(`<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<UnstructuredGrid>
${fieldData(mesh)}<Piece NumberOfPoints="${store.vertices}" NumberOfCells="${tets}">
<Points>
${named([points])}</Points>
<Cells>
${named(cells)}</Cells>
${label ? `<CellData>\n${named([label])}</CellData>\n` : ""}` +
    `${fields.length > 0 ? `<PointData>\n${named(fields)}</PointData>\n` : ""}</Piece>
</UnstructuredGrid>
<AppendedData encoding="raw">
_`);
  for (const column of [points, ...cells, ...(label ? [label] : []), ...fields]) {
    file.bytes(new BigUint64Array([BigInt(column.bytes)]));
    column.write();
  }
  file.text("\n</AppendedData>\n</VTKFile>\n");
}
