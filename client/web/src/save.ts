// Files of a mesh: the formats of core/files.
import { FileParts } from "./file_parts";
import type { SavedFormat } from "./formats";
import { writeExodus } from "./save_exodus";
import { writeInp } from "./save_inp";
import { writeMfem } from "./save_mfem";
import { writeMsh } from "./save_msh";
import { writePolyMesh } from "./save_polymesh";
import { writeObj, writePly, writeStl } from "./save_surface";
import { writeUsd } from "./save_usd";
import { writeVtkHdf } from "./save_vtkhdf";
import { writeVtu } from "./save_vtu";
import { writeXdmf } from "./save_xdmf";
import type { TetMesh } from "./tet_mesh";

const kWriters: Record<SavedFormat, (mesh: TetMesh, file: FileParts) => void> = {
  vtu: writeVtu, vtkhdf: writeVtkHdf, msh: writeMsh, inp: writeInp, xdmf: writeXdmf, exo: writeExodus,
  polyMesh: writePolyMesh, mesh: writeMfem, usda: writeUsd, stl: writeStl, obj: writeObj, ply: writePly };

export type { SavedFormat };

export function fileOf(mesh: TetMesh, format: SavedFormat): Blob {
  if (!mesh.keepsTets && format !== "stl") throw new Error("the tab does not hold the whole mesh: the command line saves it");
  const file = new FileParts();
  kWriters[format](mesh, file);
  return file.blob();
}
