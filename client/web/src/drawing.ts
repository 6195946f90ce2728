// What is drawn of a mesh: triangles by the numbers of their corners, each corner's place once, a paint a triangle.
import type { ChunkStore } from "./chunk_store";
import type { Tally } from "./tally";

/** Rows of textures: the arrays are filled up to whole ones. */
export const kTextureWidth = 4096;
/** The paint of a triangle that has no colour. Others are from 0, the least value, to 254, the most. */
const kNoPaint = 255, kMostPaint = 254;

export interface Surface {
  corners: Uint32Array;   // 3 a triangle: places
  places: Float32Array;   // 3 a place: x, y, z relative to the mesh's origin
  paints: Uint8Array;     // 1 a triangle
  triangles: number;
}

export function bytesOf(surface: Surface): number {
  return surface.corners.byteLength + surface.places.byteLength + surface.paints.byteLength;
}

export function wholeRows(count: number): number {
  return Math.max(Math.ceil(count / kTextureWidth), 1) * kTextureWidth;
}

function bitsIn(word: number): number {
  word -= (word >>> 1) & 0x55555555;
  word = (word & 0x33333333) + ((word >>> 2) & 0x33333333);
  return Math.imul((word + (word >>> 4)) & 0x0f0f0f0f, 0x01010101) >>> 24;
}

/** Which vertices are wanted, and each one's place among them. */
class Wanted {
  private readonly bits: Uint32Array;
  private readonly before: Uint32Array;
  count = 0;

  constructor(vertices: number, corners: Uint32Array, used: number) {
    this.bits = new Uint32Array(Math.ceil(vertices / 32));
    this.before = new Uint32Array(this.bits.length);
    for (let i = 0; i < used; ++i) this.bits[corners[i]! >>> 5]! |= 1 << (corners[i]! & 31);
    for (let w = 0; w < this.bits.length; ++w) {
      this.before[w] = this.count;
      this.count += bitsIn(this.bits[w]!);
    }
  }

  get byteLength(): number {
    return this.bits.byteLength + this.before.byteLength;
  }
  has(vertex: number): boolean {
    return ((this.bits[vertex >>> 5]! >>> (vertex & 31)) & 1) === 1;
  }
  placeOf(vertex: number): number {
    const word = vertex >>> 5;
    return this.before[word]! + bitsIn(this.bits[word]! & ((1 << (vertex & 31)) - 1));
  }
}

/** Makes a surface of triangles whose corners are vertices; `corners` has whole rows, and is changed. */
export function surfaceOf(store: ChunkStore, corners: Uint32Array, triangles: number, paints: Uint8Array,
    tally: Tally): Surface {
  const wanted = new Wanted(store.vertices, corners, triangles * 3);
  tally.add(wanted.byteLength);
  const places = new Float32Array(wholeRows(wanted.count * 3));
  tally.add(places.byteLength);
  store.forEachPositions((first, positions) => {
    for (let v = 0; v * 3 < positions.length; ++v) {
      if (!wanted.has(first + v)) continue;
      const place = wanted.placeOf(first + v) * 3;
      for (let axis = 0; axis < 3; ++axis) places[place + axis] = positions[v * 3 + axis]!;
    }
  });
  for (let i = 0; i < triangles * 3; ++i) corners[i] = wanted.placeOf(corners[i]!);
  tally.drop(wanted.byteLength);
  return { corners, places, paints, triangles };
}

/** Paints for values, over the range that there is; all alike where there are none. */
export function paintsOf(values: Float32Array | undefined, triangles: number): Uint8Array {
  const paints = new Uint8Array(wholeRows(triangles)).fill(kNoPaint);
  if (!values) return paints;
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  const scale = high > low ? kMostPaint / (high - low) : 0;
  values.forEach((value, t) => (paints[t] = (value - low) * scale));
  return paints;
}
