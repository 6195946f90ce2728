// A mesh in the worker: chunks in, surfaces to draw out.
import type { MeshChunk, MeshHeader } from "../generated/tetstream/v1/meshes_pb";
import { CoordinateType, IndexType } from "../generated/tetstream/v1/meshes_pb";
import { FaceSet } from "./face_set";
import { unpack } from "./packed";

export interface Surface {
  positions: Float32Array;  // 9 a triangle
  colours: Uint8Array;      // 9 a triangle
  triangles: number;
}

export interface Cut {
  axis: number;
  at: number;
}

export interface WorstTet {
  tet: number;
  angle: number;
  at: [number, number, number];
}

// A corner of a tet is opposite to the face with the same number; faces are wound outwards.
const kFaces = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]] as const;
// More tets than these are drawn by their surface alone.
export const kMostTets = 30_000_000;
const kWorst = 10;

export class TetMesh {
  readonly positions: Float32Array | Float64Array;
  readonly tets: Uint32Array | undefined;  // undefined where only the surface is kept
  readonly regions: Uint8Array | undefined;
  readonly fields: Float32Array | undefined;
  readonly fieldFloats: number;
  private readonly faces = new FaceSet();
  private readonly worst: WorstTet[] = [];
  tetsSoFar = 0;
  chunks = 0;

  constructor(readonly header: MeshHeader) {
    if (header.indexType === IndexType.UINT64) throw new Error("the mesh has more vertices than a tab can hold");
    const vertices = Number(header.vertexCount), tets = Number(header.tetCount);
    const wide = header.coordinateType === CoordinateType.FLOAT64;
    this.positions = wide ? new Float64Array(vertices * 3) : new Float32Array(vertices * 3);
    if (tets <= kMostTets) this.tets = new Uint32Array(tets * 4);
    if (header.hasRegions && this.tets) this.regions = new Uint8Array(tets);
    this.fieldFloats = header.fields.reduce((sum, field) => sum + field.components, 0);
    if (this.fieldFloats > 0) this.fields = new Float32Array(vertices * this.fieldFloats);
  }

  get keepsTets(): boolean {
    return this.tets !== undefined;
  }

  add(chunk: MeshChunk): void {
    const firstVertex = Number(chunk.firstVertex), vertices = Number(chunk.vertexCount);
    const firstTet = Number(chunk.firstTet), count = Number(chunk.tetCount);
    const wide = this.positions instanceof Float64Array;
    const columns = chunk.packed.length > 0
      ? unpack(chunk.packed, { firstVertex, vertices, tets: count, wide, regions: this.header.hasRegions,
          fieldFloats: this.fieldFloats })
      : this.plain(chunk, wide);
    this.positions.set(columns.positions, firstVertex * 3);
    this.tets?.set(columns.tets, firstTet * 4);
    if (columns.regions) this.regions?.set(columns.regions, firstTet);
    if (columns.fields) {
      const floats = new Float32Array(columns.fields.buffer, columns.fields.byteOffset, columns.fields.length / 4);
      this.fields?.set(floats, firstVertex * this.fieldFloats);
    }
    this.addFaces(columns.tets, firstTet, count);
    this.tetsSoFar += count;
    ++this.chunks;
  }

  private plain(chunk: MeshChunk, wide: boolean) {
    const bytes = chunk.positions.slice().buffer;
    return {
      positions: wide ? new Float64Array(bytes) : new Float32Array(bytes),
      tets: new Uint32Array(chunk.tets.slice().buffer),
      regions: chunk.regions.length > 0 ? chunk.regions : undefined,
      fields: chunk.fields.length > 0 ? chunk.fields.slice() : undefined,
    };
  }

  private addFaces(tets: Uint32Array, first: number, count: number): void {
    for (let t = 0; t < count; ++t) {
      const at = t * 4;
      for (const [i, j, k] of kFaces) {
        this.faces.toggle(tets[at + i]!, tets[at + j]!, tets[at + k]!, first + t);
      }
    }
  }

  /** Looks for the tets with the smallest angles; once all are there. */
  findWorst(): WorstTet[] {
    const tets = this.tets;
    if (!tets) return [];
    this.worst.length = 0;
    for (let t = 0; t < this.tetsSoFar; ++t) {
      const angle = this.smallestAngle(t);
      if (this.worst.length === kWorst && angle >= this.worst[kWorst - 1]!.angle) continue;
      this.worst.push({ tet: t, angle, at: this.centroid(t) });
      this.worst.sort((a, b) => a.angle - b.angle);
      this.worst.length = Math.min(this.worst.length, kWorst);
    }
    return this.worst;
  }

  /** Edges of the surface that have not two triangles: pairs of ends, 6 numbers each. */
  seams(): Float32Array {
    const triangles = new Map<number, number>();
    const vertices = this.positions.length / 3;
    this.faces.forEach((p, q, r) => {
      for (const [a, b] of [[p, q], [q, r], [r, p]] as const) {
        const edge = Math.min(a, b) * vertices + Math.max(a, b);
        triangles.set(edge, (triangles.get(edge) ?? 0) + 1);
      }
    });
    const ends: number[] = [];
    for (const [edge, count] of triangles) {
      if (count === 2) continue;
      for (const v of [Math.floor(edge / vertices), edge % vertices]) {
        ends.push(this.positions[v * 3]!, this.positions[v * 3 + 1]!, this.positions[v * 3 + 2]!);
      }
    }
    return Float32Array.from(ends);
  }

  get surfaceTriangles(): number {
    return this.faces.count;
  }

  private centroid(tet: number): [number, number, number] {
    const p = this.positions, t = this.tets!;
    const sum = (axis: number): number =>
      (p[t[tet * 4]! * 3 + axis]! + p[t[tet * 4 + 1]! * 3 + axis]! +
       p[t[tet * 4 + 2]! * 3 + axis]! + p[t[tet * 4 + 3]! * 3 + axis]!) / 4;
    return [sum(0), sum(1), sum(2)];
  }

  /** The smallest dihedral angle, degrees. */
  private smallestAngle(tet: number): number {
    const p = this.positions, t = this.tets!;
    const normals: number[][] = [];
    for (const [i, j, k] of kFaces) {
      const a = t[tet * 4 + i]! * 3, b = t[tet * 4 + j]! * 3, c = t[tet * 4 + k]! * 3;
      const ux = p[b]! - p[a]!, uy = p[b + 1]! - p[a + 1]!, uz = p[b + 2]! - p[a + 2]!;
      const vx = p[c]! - p[a]!, vy = p[c + 1]! - p[a + 1]!, vz = p[c + 2]! - p[a + 2]!;
      const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
      const length = Math.hypot(x, y, z) || 1;
      normals.push([x / length, y / length, z / length]);
    }
    let largest = -1;
    for (let i = 0; i < 4; ++i) {
      for (let j = i + 1; j < 4; ++j) {
        const m = normals[i]!, n = normals[j]!;
        largest = Math.max(largest, -(m[0]! * n[0]! + m[1]! * n[1]! + m[2]! * n[2]!));
      }
    }
    return (Math.acos(Math.min(1, largest)) * 180) / Math.PI;
  }

  private volume(tet: number): number {
    const p = this.positions, t = this.tets!;
    const a = t[tet * 4]! * 3, b = t[tet * 4 + 1]! * 3, c = t[tet * 4 + 2]! * 3, d = t[tet * 4 + 3]! * 3;
    const e = (q: number, axis: number): number => p[q + axis]! - p[a + axis]!;
    return (e(b, 0) * (e(c, 1) * e(d, 2) - e(c, 2) * e(d, 1)) -
      e(b, 1) * (e(c, 0) * e(d, 2) - e(c, 2) * e(d, 0)) +
      e(b, 2) * (e(c, 0) * e(d, 1) - e(c, 1) * e(d, 0))) / 6;
  }

  /** The surface of all tets, or of those whose centroids lie below the cut, whole. */
  surface(colourBy: string, cut?: Cut): Surface {
    const corners: number[] = [], owners: number[] = [];
    const keep = cut && this.tets ? this.keeper(cut) : undefined;
    this.faces.forEach((p, q, r, tet) => {
      if (keep && !keep(tet)) return;
      corners.push(p, q, r);
      owners.push(tet);
    });
    if (keep) this.addCutFaces(keep, cut!, corners, owners);
    const positions = new Float32Array(corners.length * 3);
    for (let i = 0; i < corners.length; ++i) {
      for (let axis = 0; axis < 3; ++axis) positions[i * 3 + axis] = this.positions[corners[i]! * 3 + axis]!;
    }
    return { positions, colours: this.colours(colourBy, corners, owners), triangles: owners.length };
  }

  private keeper(cut: Cut): (tet: number) => boolean {
    const p = this.positions, t = this.tets!;
    const limit = cut.at * 4;
    return (tet) => {
      const at = tet * 4, axis = cut.axis;
      return p[t[at]! * 3 + axis]! + p[t[at + 1]! * 3 + axis]! + p[t[at + 2]! * 3 + axis]! +
        p[t[at + 3]! * 3 + axis]! <= limit;
    };
  }

  /** Faces between a tet that is kept and one that is not. Both lie within three of their extents. */
  private addCutFaces(keep: (tet: number) => boolean, cut: Cut, corners: number[], owners: number[]): void {
    const p = this.positions, t = this.tets!;
    const kept: number[] = [], gone = new FaceSet();
    for (let tet = 0; tet < this.tetsSoFar; ++tet) {
      let low = Infinity, high = -Infinity;
      for (let k = 0; k < 4; ++k) {
        const value = p[t[tet * 4 + k]! * 3 + cut.axis]!;
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
      const reach = 3 * (high - low);
      if (low - reach > cut.at || high + reach < cut.at) continue;
      if (keep(tet)) kept.push(tet);
      else for (const [i, j, k] of kFaces) gone.toggle(t[tet * 4 + i]!, t[tet * 4 + j]!, t[tet * 4 + k]!, tet);
    }
    for (const tet of kept) {
      for (const [i, j, k] of kFaces) {
        const a = t[tet * 4 + i]!, b = t[tet * 4 + j]!, c = t[tet * 4 + k]!;
        if (!gone.has(a, b, c)) continue;
        corners.push(a, b, c);
        owners.push(tet);
      }
    }
  }

  private colours(by: string, corners: number[], owners: number[]): Uint8Array {
    const colours = new Uint8Array(corners.length * 3);
    if (by === "field" && this.fields) {
      const values = corners.map((v) => this.fields![v * this.fieldFloats]!);
      paint(colours, values);
      return colours;
    }
    const value = this.tets ? this.valueOf(by) : undefined;
    if (!value) return colours.fill(190);
    const values: number[] = [];
    for (const tet of owners) {
      const v = value(tet);
      values.push(v, v, v);
    }
    paint(colours, values);
    return colours;
  }

  private valueOf(by: string): ((tet: number) => number) | undefined {
    if (by === "size") return (tet) => Math.cbrt(this.volume(tet));
    if (by === "angle") return (tet) => this.smallestAngle(tet);
    if (by === "region" && this.regions) return (tet) => this.regions![tet]!;
    return undefined;
  }
}

/** From blue over white to orange, over the range that there is. */
function paint(colours: Uint8Array, values: number[]): void {
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  const scale = high > low ? 1 / (high - low) : 0;
  values.forEach((value, i) => {
    const x = (value - low) * scale;
    const towards = x < 0.5 ? [40, 110, 190] : [230, 130, 30];
    const far = Math.abs(x - 0.5) * 2;
    for (let k = 0; k < 3; ++k) colours[i * 3 + k] = 235 + (towards[k]! - 235) * far;
  });
}
