// The boundary triangles of a mesh and the names that they have, as core/mesh/find_faces.h finds them.
import { kFaceCorners, type Columns } from "./chunk_store";
import { FaceSet } from "./face_set";
import { distinctNames, freeName } from "./tet_groups";
import type { TetMesh } from "./tet_mesh";

export interface FaceGroup {
  tag: number;
  name: string;
  faces: Uint32Array;  // numbers, rising
}

const kBox = ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"];
const kCutField = "cut_face";
// More pairs of labels than this are told apart as two kinds alone.
const kMostLabels = 0xffff;

interface Found {
  faces: Uint32Array;
  labels: Uint16Array;  // of each
  names: string[];
}

function facesOfColumns(mesh: TetMesh): Found {
  const faces = new Uint32Array(Number(mesh.header.faceCount)), labels = new Uint16Array(faces.length);
  let next = 0;
  mesh.store.forEach((columns) => {
    faces.set(columns.faces!, next);
    labels.set(columns.faceLabels!, next);
    next += columns.faces!.length;
  });
  return { faces, labels, names: mesh.header.faceLabels.map((label) => label.name) };
}

/** Faces that one tet has, or two of different groups: of the one with the lower group. */
function facesOfGroups(mesh: TetMesh): { faces: Uint32Array; front: Uint16Array; behind: Int32Array } {
  const groups = new Uint16Array(Number(mesh.header.tetCount));
  mesh.store.forEach(({ firstTet, groups: own }) => groups.set(own!, firstTet));
  const open = new FaceSet(mesh.tally);
  const found: [number, number][] = [];
  mesh.store.forEach(({ tets, firstTet, count }) => {
    for (let t = 0; t < count; ++t) {
      for (let f = 0; f < 4; ++f) {
        const [i, j, k] = kFaceCorners[f]!;
        const face = (firstTet + t) * 4 + f;
        const other = open.toggle(tets[t * 4 + i]!, tets[t * 4 + j]!, tets[t * 4 + k]!, face);
        if (other < 0) continue;
        const mine = groups[face >>> 2]!, its = groups[other >>> 2]!;
        if (mine !== its) found.push(mine < its ? [face, its] : [other, mine]);
      }
    }
  });
  open.forEach((_p, _q, _r, face) => found.push([face, -1]));
  open.free();
  found.sort((a, b) => a[0] - b[0]);
  return { faces: Uint32Array.from(found, ([face]) => face), front: Uint16Array.from(found, ([face]) => groups[face >>> 2]!),
    behind: Int32Array.from(found, ([, group]) => group) };
}

function pairsOfLabels(mesh: TetMesh): Found {
  const { faces, front, behind } = facesOfGroups(mesh);
  const pairOf = (i: number): number => front[i]! * 0x10000 + behind[i]! + 1;
  const pairs = [...new Set(Array.from(faces, (_, i) => pairOf(i)))].sort((a, b) => a - b);
  if (pairs.length > kMostLabels) {
    return { faces, labels: Uint16Array.from(behind, (group) => (group < 0 ? 0 : 1)), names: ["surface", "interface"] };
  }
  const names = distinctNames(mesh.header.labels), taken = new Set<string>();
  const places = new Map(pairs.map((pair, i) => [pair, i]));
  return { faces, labels: Uint16Array.from(faces, (_, i) => places.get(pairOf(i))!),
    names: pairs.map((pair) => {
      const other = (pair & 0xffff) - 1;
      return freeName(`${names[pair >>> 16]}_${other < 0 ? "surface" : names[other]}`, taken);
    }) };
}

/** A normal of a triangle, outwards. */
function normalOf(p: ArrayLike<number>, [a, b, c]: number[]): [number, number, number] {
  const [ux, uy, uz] = [0, 1, 2].map((k) => p[b! * 3 + k]! - p[a! * 3 + k]!) as [number, number, number];
  const [vx, vy, vz] = [0, 1, 2].map((k) => p[c! * 3 + k]! - p[a! * 3 + k]!) as [number, number, number];
  return [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
}

/** The face of the box around all vertices that each of some faces is nearest to, of those on whose side it looks. */
function nearestBoxFaces(mesh: TetMesh, faces: Uint32Array): Uint16Array {
  const p = mesh.store.allPositions();
  const box = [Infinity, -Infinity, Infinity, -Infinity, Infinity, -Infinity];
  for (let i = 0; i < p.length; ++i) {
    const axis = (i % 3) * 2;
    if (p[i]! < box[axis]!) box[axis] = p[i]!;
    if (p[i]! > box[axis + 1]!) box[axis + 1] = p[i]!;
  }
  const nearest = new Uint16Array(faces.length);
  mesh.forFaces(faces, (i, columns, tet, corner) => {
    const corners = cornersOf(columns, tet, corner), normal = normalOf(p, corners);
    let best = 0, bestLooks = false, least = Infinity;
    box.forEach((place, side) => {
      const axis = side >> 1, looks = side % 2 === 0 ? normal[axis]! < 0 : normal[axis]! > 0;
      const away = corners.reduce((sum, vertex) => sum + Math.abs(p[vertex * 3 + axis]! - place), 0);
      if (looks === bestLooks ? away >= least : bestLooks) return;
      [best, bestLooks, least] = [side, looks, away];
    });
    nearest[i] = best;
  });
  return nearest;
}

function sidesOfRegions(mesh: TetMesh): Found {
  const { faces, behind } = facesOfGroups(mesh);
  const nearest = nearestBoxFaces(mesh, faces);
  return { faces, labels: nearest.map((side, i) => (behind[i]! < 0 ? 1 + side : 0)),
    names: ["interface", ...kBox.map((name) => `box_${name}`)] };
}

function sidesOfCut(mesh: TetMesh): Found {
  const floats = mesh.header.fields.reduce((sum, field) => sum + field.components, 0);
  const sides = new Uint8Array(mesh.store.vertices);
  mesh.store.forEach(({ firstVertex, vertices, fields }) => {
    for (let v = 0; v < vertices; ++v) {
      const number = fields![(v + 1) * floats - 1]!;
      sides[firstVertex + v] = number >= 0 && number <= 63 ? number : 0;
    }
  });
  const faces = mesh.outsideFaces, labels = new Uint16Array(faces.length);
  mesh.forFaces(faces, (i, { tets }, tet, corner) => {
    const shared = kFaceCorners[corner]!.reduce((both, k) => both & sides[tets[tet * 4 + k]!]!, 63);
    labels[i] = shared === 0 ? 0 : 1 + (31 - Math.clz32(shared & -shared));
  });
  return { faces, labels, names: ["surface", ...kBox.map((name) => `cut_${name}`)] };
}

function foundFaces(mesh: TetMesh): Found {
  const { header } = mesh;
  if (header.faceLabels.length > 0) return facesOfColumns(mesh);
  if (header.labels.length > 0) return pairsOfLabels(mesh);
  const found = header.hasRegions ? sidesOfRegions(mesh)
    : header.fields.at(-1)?.name === kCutField ? sidesOfCut(mesh)
    : { faces: mesh.outsideFaces, labels: new Uint16Array(mesh.outsideFaces.length), names: ["surface"] };
  if (header.parts.length === 0) return found;
  const own = found.names.length;
  const labels = new Uint16Array(found.faces.length);
  for (let i = 0, part = 0; i < labels.length; ++i) {
    while (part + 1 < header.parts.length && found.faces[i]! >>> 2 >= Number(header.parts[part + 1]!.firstTet)) ++part;
    labels[i] = part * own + found.labels[i]!;
  }
  return { faces: found.faces, labels,
    names: header.parts.flatMap((part) => found.names.map((name) => `${part.name}_${name}`)) };
}

/** All faces of a mesh by their names; only names that some have. */
export function faceGroups(mesh: TetMesh): FaceGroup[] {
  const { faces, labels, names } = foundFaces(mesh);
  const counts = names.map(() => 0);
  for (const label of labels) ++counts[label]!;
  const groups = names.map((name, i) => ({ tag: i + 1, name, faces: new Uint32Array(counts[i]!) }));
  counts.fill(0);
  labels.forEach((label, i) => (groups[label]!.faces[counts[label]!++] = faces[i]!));
  return groups.filter((group) => group.faces.length > 0);
}

export function cornersOf({ tets }: Columns, tet: number, corner: number): [number, number, number] {
  const [i, j, k] = kFaceCorners[corner]!;
  return [tets[tet * 4 + i]!, tets[tet * 4 + j]!, tets[tet * 4 + k]!];
}

/** The vertices of some faces, each once, rising. */
export function verticesOf(mesh: TetMesh, faces: Uint32Array): Uint32Array {
  const all = new Uint32Array(faces.length * 3);
  mesh.forFaces(faces, (i, columns, tet, corner) => all.set(cornersOf(columns, tet, corner), i * 3));
  all.sort();
  let count = 0;
  for (const vertex of all) if (count === 0 || all[count - 1] !== vertex) all[count++] = vertex;
  return all.subarray(0, count);
}

/** How many faces have a name. */
export function countFaces(groups: FaceGroup[]): number {
  return groups.reduce((sum, { faces }) => sum + faces.length, 0);
}
