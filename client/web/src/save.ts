// Files of a mesh: the formats of core/files that take no library of their own.
import { FileParts } from "./file_parts";
import type { SavedFormat } from "./formats";
import { writeInp } from "./save_inp";
import { writeMfem } from "./save_mfem";
import { writeMsh } from "./save_msh";
import { writeObj, writePly, writeStl } from "./save_surface";
import { writeVtu } from "./save_vtu";
import type { TetMesh } from "./tet_mesh";

const kWriters: Record<SavedFormat, (mesh: TetMesh, file: FileParts) => void> = {
  vtu: writeVtu, msh: writeMsh, inp: writeInp, mesh: writeMfem, stl: writeStl, obj: writeObj, ply: writePly };

export type { SavedFormat };

export function fileOf(mesh: TetMesh, format: SavedFormat): Blob {
  if (!mesh.keepsTets && format !== "stl") throw new Error("the tab does not hold the whole mesh: the command line saves it");
  const file = new FileParts();
  kWriters[format](mesh, file);
  return file.blob();
}
