// The formats that a mesh is saved in.
export type SavedFormat =
  "vtu" | "vtkhdf" | "msh" | "inp" | "xdmf" | "exo" | "polyMesh" | "mesh" | "usda" | "stl" | "obj" | "ply";

interface Format {
  ending: SavedFormat;
  what: string;
  /** What is in the .zip, where the format is several files. */
  zipped?: string;
}

export const kFormats: Format[] = [
  { ending: "vtu", what: "ParaView, VTK" },
  { ending: "vtkhdf", what: "ParaView, VTK" },
  { ending: "msh", what: "Gmsh" },
  { ending: "inp", what: "Abaqus, CalculiX" },
  { ending: "xdmf", what: "FEniCS, ParaView", zipped: "mesh.xdmf and mesh.h5" },
  { ending: "exo", what: "Exodus II: MOOSE, Sierra" },
  { ending: "polyMesh", what: "OpenFOAM", zipped: "the folder polyMesh, to be unpacked in constant" },
  { ending: "mesh", what: "MFEM" },
  { ending: "usda", what: "USD" },
  { ending: "stl", what: "the surface" },
  { ending: "obj", what: "the surface, with names" },
  { ending: "ply", what: "the surface, with labels and fields" },
];

export function formatOf(ending: string): Format {
  return kFormats.find((format) => format.ending === ending) ?? kFormats[0]!;
}

/** What a file that the page saves is called. */
export function fileNameOf({ ending, zipped }: Format): string {
  return `mesh.${ending}${zipped ? ".zip" : ""}`;
}
