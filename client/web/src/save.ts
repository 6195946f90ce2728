// Files of a mesh: VTK's for all of it, STL for its surface.
import type { TetMesh } from "./tet_mesh";

/** Adds the origin: stored positions are relative to it. */
function worldPositions(mesh: TetMesh): Float64Array {
  const origin = mesh.header.origin;
  const add = [origin?.x ?? 0, origin?.y ?? 0, origin?.z ?? 0];
  return Float64Array.from(mesh.positions, (x, i) => x + add[i % 3]!);
}

export function vtuOf(mesh: TetMesh): Blob {
  const tets = mesh.tets!;
  const count = tets.length / 4;
  const arrays: (Float64Array | Uint32Array | Uint8Array)[] = [
    worldPositions(mesh), tets, Uint32Array.from({ length: count }, (_, t) => (t + 1) * 4),
    new Uint8Array(count).fill(10)];
  if (mesh.regions) arrays.push(mesh.regions);
  const offsets: number[] = [];
  let offset = 0;
  for (const array of arrays) {
    offsets.push(offset);
    offset += 8 + array.byteLength;
  }
  const column = (type: string, name: string, k: number, more = ""): string =>
    `<DataArray type="${type}" Name="${name}" ${more}format="appended" offset="${offsets[k]}"/>`;
  const head = `<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<UnstructuredGrid><Piece NumberOfPoints="${mesh.positions.length / 3}" NumberOfCells="${count}">
<Points>${column("Float64", "Points", 0, 'NumberOfComponents="3" ')}</Points>
<Cells>${column("UInt32", "connectivity", 1)}${column("UInt32", "offsets", 2)}${column("UInt8", "types", 3)}</Cells>
<CellData>${mesh.regions ? column("UInt8", "region", 4) : ""}</CellData>
</Piece></UnstructuredGrid><AppendedData encoding="raw">_`;
  const parts: BlobPart[] = [head];
  for (const array of arrays) {
    parts.push(new BigUint64Array([BigInt(array.byteLength)]), array as unknown as BlobPart);
  }
  return new Blob([...parts, "</AppendedData></VTKFile>\n"], { type: "application/octet-stream" });
}

export function stlOf(mesh: TetMesh): Blob {
  const surface = mesh.surface("none");
  const origin = mesh.header.origin;
  const add = [origin?.x ?? 0, origin?.y ?? 0, origin?.z ?? 0];
  const file = new DataView(new ArrayBuffer(84 + 50 * surface.triangles));
  file.setUint32(80, surface.triangles, true);
  for (let t = 0; t < surface.triangles; ++t) {
    for (let k = 0; k < 9; ++k) {
      file.setFloat32(84 + t * 50 + 12 + k * 4, surface.positions[t * 9 + k]! + add[k % 3]!, true);
    }
  }
  return new Blob([file.buffer], { type: "model/stl" });
}
