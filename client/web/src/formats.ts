// The formats that a mesh is saved in: here, or by the command line alone.
export type SavedFormat = "vtu" | "msh" | "inp" | "mesh" | "stl" | "obj" | "ply";

interface Format {
  ending: string;
  what: string;
  here: boolean;
}

export const kFormats: Format[] = [
  { ending: "vtu", what: "ParaView, VTK", here: true },
  { ending: "msh", what: "Gmsh", here: true },
  { ending: "inp", what: "Abaqus, CalculiX", here: true },
  { ending: "mesh", what: "MFEM", here: true },
  { ending: "stl", what: "the surface", here: true },
  { ending: "obj", what: "the surface, with names", here: true },
  { ending: "ply", what: "the surface, with labels and fields", here: true },
  { ending: "vtkhdf", what: "ParaView, by the command line", here: false },
  { ending: "xdmf", what: "ParaView, FEniCS, by the command line", here: false },
  { ending: "exo", what: "Exodus II, by the command line", here: false },
  { ending: "polyMesh", what: "OpenFOAM, by the command line", here: false },
  { ending: "usda", what: "USD, by the command line", here: false },
];

export function formatOf(ending: string): Format {
  return kFormats.find((format) => format.ending === ending) ?? kFormats[0]!;
}

export function isSavedHere(ending: string): ending is SavedFormat {
  return formatOf(ending).here;
}
