// The shape of one tet, by its corners and all positions.
import { kFaceCorners } from "./chunk_store";

type Positions = Float32Array | Float64Array;
type Ids = Uint32Array | number[];

const normals = new Float64Array(12);

/** The smallest dihedral angle, degrees, of the tet whose corners begin at `at`. */
export function smallestAngle(p: Positions, t: Ids, at: number): number {
  for (let f = 0; f < 4; ++f) {
    const [i, j, k] = kFaceCorners[f]!;
    const a = t[at + i]! * 3, b = t[at + j]! * 3, c = t[at + k]! * 3;
    const ux = p[b]! - p[a]!, uy = p[b + 1]! - p[a + 1]!, uz = p[b + 2]! - p[a + 2]!;
    const vx = p[c]! - p[a]!, vy = p[c + 1]! - p[a + 1]!, vz = p[c + 2]! - p[a + 2]!;
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    const length = Math.sqrt(x * x + y * y + z * z) || 1;
    normals[f * 3] = x / length;
    normals[f * 3 + 1] = y / length;
    normals[f * 3 + 2] = z / length;
  }
  let largest = -1;
  for (let i = 0; i < 9; i += 3) {
    for (let j = i + 3; j < 12; j += 3) {
      const dot = normals[i]! * normals[j]! + normals[i + 1]! * normals[j + 1]! + normals[i + 2]! * normals[j + 2]!;
      if (-dot > largest) largest = -dot;
    }
  }
  return (Math.acos(Math.min(1, largest)) * 180) / Math.PI;
}

export function volumeOf(p: Positions, t: Ids, at: number): number {
  const a = t[at]! * 3, b = t[at + 1]! * 3, c = t[at + 2]! * 3, d = t[at + 3]! * 3;
  const e = (q: number, axis: number): number => p[q + axis]! - p[a + axis]!;
  return (e(b, 0) * (e(c, 1) * e(d, 2) - e(c, 2) * e(d, 1)) -
    e(b, 1) * (e(c, 0) * e(d, 2) - e(c, 2) * e(d, 0)) +
    e(b, 2) * (e(c, 0) * e(d, 1) - e(c, 1) * e(d, 0))) / 6;
}

/**
 * The octree level of the leaves that a tet is of, by its longest edge: from 0.86 spacings of a part of a tet to 1.42 of
 * half a pyramid, and warped ones are of the finest level.
 */
export function levelOf(p: Positions, t: Ids, at: number, spacing: number): number {
  let longest = 0;
  for (let i = 0; i < 3; ++i) {
    for (let j = i + 1; j < 4; ++j) {
      const a = t[at + i]! * 3, b = t[at + j]! * 3;
      const x = p[a]! - p[b]!, y = p[a + 1]! - p[b + 1]!, z = p[a + 2]! - p[b + 2]!;
      longest = Math.max(longest, x * x + y * y + z * z);
    }
  }
  return Math.max(0, Math.floor(Math.log2(longest / (spacing * spacing)) / 2 + 0.25));
}

export function centroidOf(p: Positions, t: Ids, at: number): [number, number, number] {
  const sum = (axis: number): number =>
    (p[t[at]! * 3 + axis]! + p[t[at + 1]! * 3 + axis]! + p[t[at + 2]! * 3 + axis]! + p[t[at + 3]! * 3 + axis]!) / 4;
  return [sum(0), sum(1), sum(2)];
}
