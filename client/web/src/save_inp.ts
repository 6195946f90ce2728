// Input of Abaqus and CalculiX, .inp, as core/files/write_inp.cpp writes it.
import { faceGroups, verticesOf } from "./face_groups";
import { inComment, namesInFile } from "./file_names";
import { textOf, type FileParts } from "./file_parts";
import { GroupedTets, tetGroups } from "./tet_groups";
import type { TetMesh } from "./tet_mesh";
import { forEachPoints, isWide } from "./world_points";

/** The face opposite each corner of a C3D4. */
const kFaces = ["S3", "S4", "S2", "S1"];
/** Sets of all nodes and of all elements are the file's own. */
const kNames = { ignoresCase: true, taken: ["Nall", "Eall"] };

function renamed(what: string, names: string[], real: string[]): string {
  return names.map((name, i) => (name === real[i] ? "" : `** ${what} ${name}: ${inComment(real[i]!)}\n`)).join("");
}

export function writeInp(mesh: TetMesh, file: FileParts): void {
  const { header, store } = mesh;
  const wide = isWide(header);
  const groups = tetGroups(header), surfaces = faceGroups(mesh);
  const grouped = new GroupedTets(groups, store), { counts } = grouped;
  const sets = namesInFile(groups.names, kNames), names = namesInFile(surfaces.map(({ name }) => name), kNames);
  file.text(`*HEADING\n${store.vertices} nodes, ${header.tetCount} elements, written by tetstream\n` +
    renamed("ELSET", sets, groups.names) + renamed("SURFACE", names, surfaces.map(({ name }) => name)));
  file.text("*NODE, NSET=Nall\n");
  forEachPoints(header, store, (p, first) => file.lines(p.length / 3, (v) =>
    `${first + v + 1}, ${textOf(p[v * 3]!, wide)}, ${textOf(p[v * 3 + 1]!, wide)}, ${textOf(p[v * 3 + 2]!, wide)}\n`));
  counts.forEach((count, group) => {
    if (count === 0) return;  // readers take no empty set
    file.text(`*ELEMENT, TYPE=C3D4, ELSET=${sets[group]}\n`);
    grouped.forEach(group, ({ tets, firstTet }, own) => file.lines(own.length, (i) => {
      const t = own[i]!;
      return `${firstTet + t + 1}, ${tets[t * 4]! + 1}, ${tets[t * 4 + 1]! + 1}, ${tets[t * 4 + 2]! + 1}, ${tets[t * 4 + 3]! + 1}\n`;
    }));
  });
  file.text("*ELSET, ELSET=Eall\n" + sets.filter((_, i) => counts[i]! > 0).map((name) => `${name}\n`).join(""));
  surfaces.forEach(({ faces }, i) => {
    file.text(`*SURFACE, NAME=${names[i]}, TYPE=ELEMENT\n`);
    file.lines(faces.length, (f) => `${(faces[f]! >>> 2) + 1}, ${kFaces[faces[f]! & 3]}\n`);
    const nodes = verticesOf(mesh, faces);
    file.text(`*NSET, NSET=${names[i]}\n`);
    file.lines(nodes.length, (n) => `${nodes[n]! + 1}\n`);
  });
}
