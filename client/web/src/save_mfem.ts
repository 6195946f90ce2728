// MFEM's .mesh, as core/files/write_mfem.cpp writes it.
import { cornersOf, faceGroups } from "./face_groups";
import { inComment } from "./file_names";
import { shortFloat32, type FileParts } from "./file_parts";
import { tetGroups } from "./tet_groups";
import type { TetMesh } from "./tet_mesh";
import { forEachPoints, isWide } from "./world_points";

export function writeMfem(mesh: TetMesh, file: FileParts): void {
  const { header, store } = mesh;
  const groups = tetGroups(header), surfaces = faceGroups(mesh);
  const text = isWide(header) ? String : shortFloat32;
  file.text("MFEM mesh v1.0\n\n# written by tetstream\n" +
    groups.names.map((name, i) => `# attribute ${groups.tags[i]}: ${inComment(name)}\n`).join("") +
    surfaces.map(({ tag, name }) => `# boundary attribute ${tag}: ${inComment(name)}\n`).join("") +
    `\ndimension\n3\n\nelements\n${header.tetCount}\n`);
  store.forEach((columns) => {
    const of = groups.of(columns), { tets } = columns;
    file.lines(columns.count, (t) =>
      `${groups.tags[of(t)]} 4 ${tets[t * 4]} ${tets[t * 4 + 1]} ${tets[t * 4 + 2]} ${tets[t * 4 + 3]}\n`);
  });
  file.text(`\nboundary\n${surfaces.reduce((sum, { faces }) => sum + faces.length, 0)}\n`);
  for (const { tag, faces } of surfaces) {
    const lines: string[] = [];
    mesh.forFaces(faces, (_, columns, tet, corner) =>
      lines.push(`${tag} 2 ${cornersOf(columns, tet, corner).join(" ")}\n`));
    file.lines(lines.length, (i) => lines[i]!);
  }
  file.text(`\nvertices\n${store.vertices}\n3\n`);
  forEachPoints(header, store, (p) => file.lines(p.length / 3, (v) =>
    `${text(p[v * 3]!)} ${text(p[v * 3 + 1]!)} ${text(p[v * 3 + 2]!)}\n`));
}
