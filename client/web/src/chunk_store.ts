// The chunks of a mesh as they came, packed: what is wanted of them is unpacked when it is wanted.
import { CoordinateType, IndexType, type MeshChunk, type MeshHeader } from "../generated/tetstream/v1/meshes_pb";
import { unpack, unpackPositions, type Shape, type Unpacked } from "./packed";
import type { Tally } from "./tally";

/** The columns of one chunk. Positions and tets are good until the next one's are asked for. */
export interface Columns {
  firstVertex: number;
  firstTet: number;
  vertices: number;
  count: number;  // of tets
  positions: Float32Array | Float64Array;  // relative to the header's origin
  tets: Uint32Array;
  groups?: Uint8Array | Uint16Array;
  fields?: Float32Array;
  /** Numbers of faces: 4 times that of the tet, and the corner that the face is opposite of. */
  faces?: Uint32Array;
  faceLabels?: Uint16Array;
}

/** A corner of a tet is opposite to the face with the same number; faces are wound outwards. */
export const kFaceCorners: readonly (readonly [number, number, number])[] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

interface Kept {
  chunk: MeshChunk;
  shape: Shape;
  firstTet: number;
  /** Instead of the rest, where the surface alone is kept. */
  positions?: Float32Array | Float64Array;
}

function aligned(bytes: Uint8Array): ArrayBuffer {
  return bytes.slice().buffer as ArrayBuffer;
}

export class ChunkStore {
  private readonly kept: Kept[] = [];
  private readonly wide: boolean;
  private readonly fieldFloats: number;

  /** Where `surfaceAlone` says so positions are kept and no tets. */
  constructor(private readonly header: MeshHeader, private readonly surfaceAlone: boolean,
    private readonly tally: Tally) {
    if (header.indexType === IndexType.UINT64) throw new Error("the mesh has more vertices than a tab can hold");
    this.wide = header.coordinateType === CoordinateType.FLOAT64;
    this.fieldFloats = header.fields.reduce((sum, field) => sum + field.components, 0);
  }

  get count(): number {
    return this.kept.length;
  }

  get vertices(): number {
    return Number(this.header.vertexCount);
  }

  add(chunk: MeshChunk): Columns {
    const one: Kept = { chunk, firstTet: Number(chunk.firstTet), shape: {
      firstVertex: Number(chunk.firstVertex),
      vertices: Number(chunk.vertexCount),
      tets: Number(chunk.tetCount),
      wide: this.wide,
      regions: this.header.hasRegions,
      labels: this.header.labels.length,
      fieldFloats: this.fieldFloats,
      faces: Number(chunk.faceCount),
      faceLabels: this.header.faceLabels.length,
    } };
    const columns = this.columnsOf(one);
    if (this.surfaceAlone) {
      one.positions = columns.positions.slice();
      one.chunk = { ...chunk, packed: new Uint8Array(), positions: new Uint8Array(), tets: new Uint8Array() };
    }
    this.tally.add(one.positions?.byteLength ?? bytesOf(chunk));
    this.kept.push(one);
    return columns;
  }

  /** Unpacks chunk number i. */
  columns(i: number): Columns {
    return this.columnsOf(this.kept[i]!);
  }

  /** Calls `use` with the columns of each chunk, one after the other. */
  forEach(use: (columns: Columns) => void): void {
    for (const one of this.kept) use(this.columnsOf(one));
  }

  forEachPositions(use: (firstVertex: number, positions: Float32Array | Float64Array) => void): void {
    for (const one of this.kept) use(one.shape.firstVertex, this.positionsOf(one));
  }

  /** Positions of all vertices, for whoever drops them soon. */
  allPositions(): Float32Array | Float64Array {
    const all = this.wide ? new Float64Array(this.vertices * 3) : new Float32Array(this.vertices * 3);
    this.forEachPositions((first, positions) => all.set(positions, first * 3));
    return all;
  }

  private positionsOf({ chunk, shape, positions }: Kept): Float32Array | Float64Array {
    if (positions) return positions;
    if (chunk.packed.length > 0) return unpackPositions(chunk.packed, shape);
    const bytes = aligned(chunk.positions);
    return this.wide ? new Float64Array(bytes) : new Float32Array(bytes);
  }

  private columnsOf(one: Kept): Columns {
    const { chunk, shape, firstTet } = one;
    const unpacked = chunk.packed.length > 0 ? unpack(chunk.packed, shape) : this.plain(one);
    const { fields } = unpacked;
    return {
      firstVertex: shape.firstVertex, firstTet, vertices: shape.vertices, count: shape.tets,
      positions: unpacked.positions, tets: unpacked.tets, groups: unpacked.groups,
      fields: fields && new Float32Array(fields.buffer, fields.byteOffset, fields.length / 4),
      faces: unpacked.faces?.map((face) => face + 4 * firstTet), faceLabels: unpacked.faceLabels,
    };
  }

  private plain(one: Kept): Unpacked {
    const { chunk, shape } = one;
    const positions = this.positionsOf(one);
    const tets = new Uint32Array(aligned(chunk.tets));
    const whole = positions.length === shape.vertices * 3 && (tets.length === shape.tets * 4 || this.surfaceAlone);
    if (!whole) throw new Error("a chunk has not the columns that it says");
    const unpacked: Unpacked = { positions, tets };
    if (shape.regions && chunk.regions.length > 0) unpacked.groups = chunk.regions;
    if (shape.labels > 0 && chunk.regions.length > 0) unpacked.groups = new Uint16Array(aligned(chunk.regions));
    if (chunk.fields.length > 0) unpacked.fields = chunk.fields.slice();
    if (shape.faceLabels > 0) {
      unpacked.faceLabels = new Uint16Array(aligned(chunk.faceLabels));
      unpacked.faces = facesByNumber(chunk, tets, one.firstTet);
    }
    return unpacked;
  }
}

/** Faces of a plain chunk as packed ones have them. */
function facesByNumber(chunk: MeshChunk, tets: Uint32Array, firstTet: number): Uint32Array {
  const corners = new Uint32Array(aligned(chunk.faces)), owners = new Uint32Array(aligned(chunk.faceTets));
  return owners.map((owner, i) => {
    const tet = owner - firstTet;
    for (let k = 0; k < 4; ++k) {
      const corner = tets[tet * 4 + k];
      if (corner !== corners[i * 3] && corner !== corners[i * 3 + 1] && corner !== corners[i * 3 + 2]) return tet * 4 + k;
    }
    throw new Error("a chunk has a face of no tet");
  });
}

function bytesOf(chunk: MeshChunk): number {
  return chunk.packed.length + chunk.positions.length + chunk.tets.length + chunk.regions.length + chunk.fields.length +
    chunk.faces.length + chunk.faceTets.length + chunk.faceLabels.length;
}
