// A mesh in the worker: chunks in, surfaces to draw out. It is held as it came, packed; the rest is made when asked for.
import type { MeshChunk, MeshHeader } from "../generated/tetstream/v1/meshes_pb";
import { ChunkStore, kFaceCorners, type Columns } from "./chunk_store";
import { paintsOf, surfaceOf, wholeRows, type Surface } from "./drawing";
import { FaceSet } from "./face_set";
import { NumberList } from "./number_list";
import { Tally } from "./tally";
import { centroidOf, levelOf, smallestAngle, volumeOf } from "./tet_shape";

export interface Cut {
  axis: number;
  at: number;
}

export interface WorstTet {
  tet: number;
  angle: number;
  at: [number, number, number];
}

const kWorst = 10;

export class TetMesh {
  readonly tally = new Tally();
  readonly store: ChunkStore;
  readonly keepsTets: boolean;
  private readonly faces = new FaceSet(this.tally);
  /** Numbers of the faces that are outside, rising; once the mesh is whole. */
  private outside?: Uint32Array;
  private arrived = 0;  // vertices; chunks come in order
  tetsSoFar = 0;
  chunks = 0;

  /** Of more tets than `mostTets` the surface alone is kept. */
  constructor(readonly header: MeshHeader, mostTets: number) {
    this.keepsTets = Number(header.tetCount) <= mostTets;
    this.store = new ChunkStore(header, !this.keepsTets, this.tally);
  }

  add(chunk: MeshChunk): void {
    const columns = this.store.add(chunk);
    const { tets, firstTet, count } = columns;
    for (let t = 0; t < count; ++t) {
      for (let f = 0; f < 4; ++f) {
        const [i, j, k] = kFaceCorners[f]!;
        this.faces.toggle(tets[t * 4 + i]!, tets[t * 4 + j]!, tets[t * 4 + k]!, (firstTet + t) * 4 + f);
      }
    }
    this.arrived = columns.firstVertex + columns.vertices;
    this.tetsSoFar += count;
    ++this.chunks;
  }

  /** No more chunks come: what was needed for them is dropped. */
  finish(): void {
    if (!this.keepsTets || this.outside) return;
    const outside = new Uint32Array(this.faces.count);
    let next = 0;
    this.faces.forEach((p, q, r, face) => {
      if (this.isThere(p, q, r)) outside[next++] = face;
    });
    this.outside = outside.subarray(0, next).sort();
    this.tally.add(outside.byteLength);
    this.faces.free();
  }

  /** Chunks that are on their way have the other vertices. */
  private isThere(p: number, q: number, r: number): boolean {
    return p < this.arrived && q < this.arrived && r < this.arrived;
  }

  get surfaceTriangles(): number {
    return this.outside?.length ?? this.faces.count;
  }

  /** Numbers of the faces that one tet alone has, rising; once the mesh is whole. */
  get outsideFaces(): Uint32Array {
    return this.outside ?? new Uint32Array();
  }

  /** Three vertices of each face that one tet alone has, of those that have come. */
  openCorners(): Uint32Array {
    const corners = new Uint32Array(this.faces.count * 3);
    let next = 0;
    this.faces.forEach((p, q, r) => {
      corners[next++] = p;
      corners[next++] = q;
      corners[next++] = r;
    });
    return corners;
  }

  /** Calls `use` with each of some faces, whose numbers rise, and its chunk; `i` is its place. */
  forFaces(faces: Uint32Array, use: (i: number, columns: Columns, tet: number, corner: number) => void): void {
    let next = 0;
    for (let c = 0; c < this.store.count && next < faces.length; ++c) {
      const columns = this.store.columns(c);
      const end = (columns.firstTet + columns.count) * 4;
      for (; next < faces.length && faces[next]! < end; ++next) {
        use(next, columns, (faces[next]! >>> 2) - columns.firstTet, faces[next]! & 3);
      }
    }
  }

  /** Three vertices a face, in whole rows. */
  private cornersOf(faces: Uint32Array): Uint32Array {
    const corners = new Uint32Array(wholeRows(faces.length * 3));
    this.tally.add(corners.byteLength);
    this.forFaces(faces, (i, { tets }, tet, corner) => {
      for (let k = 0; k < 3; ++k) corners[i * 3 + k] = tets[tet * 4 + kFaceCorners[corner]![k]!]!;
    });
    return corners;
  }

  /**
   * The surface of all tets, or of those whose centroids lie below the cut, whole. While chunks come it has neither cut
   * nor colour. The tally counts it until it is told otherwise.
   */
  surface(colourBy: string, cut?: Cut): Surface {
    if (!this.outside) return this.surfaceSoFar();
    const faces = cut ? this.cutFaces(cut) : this.outside;
    const values = this.valuesOf(colourBy, faces);
    const paints = paintsOf(values, faces.length);
    this.tally.add(paints.byteLength);
    this.tally.drop(values?.byteLength ?? 0);
    const corners = this.cornersOf(faces);
    if (cut) this.tally.drop(faces.byteLength);
    return surfaceOf(this.store, corners, faces.length, paints, this.tally);
  }

  private surfaceSoFar(): Surface {
    const corners = new Uint32Array(wholeRows(this.faces.count * 3));
    this.tally.add(corners.byteLength);
    let triangles = 0;
    this.faces.forEach((p, q, r) => {
      if (!this.isThere(p, q, r)) return;
      corners[triangles * 3] = p;
      corners[triangles * 3 + 1] = q;
      corners[triangles * 3 + 2] = r;
      ++triangles;
    });
    const paints = paintsOf(undefined, triangles);
    this.tally.add(paints.byteLength);
    return surfaceOf(this.store, corners, triangles, paints, this.tally);
  }

  /** Faces of the tets below the cut that no other of them has. */
  private cutFaces(cut: Cut): Uint32Array {
    const found = new NumberList(this.tally), band = new NumberList(this.tally), gone = new FaceSet(this.tally);
    const along = new Float32Array(this.store.vertices);
    this.tally.during(along, () => {
      this.store.forEachPositions((first, positions) => {
        for (let v = 0; v * 3 < positions.length; ++v) along[first + v] = positions[v * 3 + cut.axis]!;
      });
      this.split(cut.at, along, found, band, gone);
    });
    for (let i = 0; i < band.length; i += 5) {
      for (let f = 0; f < 4; ++f) {
        const [a, b, c] = kFaceCorners[f]!;
        if (gone.toggle(band.at(i + a), band.at(i + b), band.at(i + c), 0) === 1) found.push(band.at(i + 4) * 4 + f);
      }
    }
    gone.free();
    band.free();
    const faces = found.view().slice().sort();
    this.tally.add(faces.byteLength);
    found.free();
    return faces;
  }

  /**
   * Finds the outside faces of what is kept. Of the tets near the plane those that are kept go into `band`, and the faces
   * of the others into `gone`: a kept one that touches another lies within three of its extents.
   */
  private split(at: number, along: Float32Array, found: NumberList, band: NumberList, gone: FaceSet): void {
    const outside = this.outside!;
    let next = 0;
    this.store.forEach(({ tets, firstTet, count }) => {
      for (let t = 0; t < count; ++t) {
        const a = tets[t * 4]!, b = tets[t * 4 + 1]!, c = tets[t * 4 + 2]!, d = tets[t * 4 + 3]!;
        const x = along[a]!, y = along[b]!, z = along[c]!, w = along[d]!;
        const keep = x + y + z + w <= 4 * at;
        const number = firstTet + t;
        for (; next < outside.length && outside[next]! >>> 2 === number; ++next) if (keep) found.push(outside[next]!);
        const low = Math.min(x, y, z, w), high = Math.max(x, y, z, w), reach = 3 * (high - low);
        if (low - reach > at || high + reach < at) continue;
        if (keep) {
          band.push(a); band.push(b); band.push(c); band.push(d); band.push(number);
        } else {
          gone.toggle(b, c, d, 1); gone.toggle(a, d, c, 1); gone.toggle(a, b, d, 1); gone.toggle(a, c, b, 1);
        }
      }
    });
  }

  /** A number for each face that is painted; the tally counts them. */
  private valuesOf(by: string, faces: Uint32Array): Float32Array | undefined {
    const fill = (value: (columns: Columns, tet: number, corner: number) => number): Float32Array => {
      const values = new Float32Array(faces.length);
      this.tally.add(values.byteLength);
      this.forFaces(faces, (i, columns, tet, corner) => (values[i] = value(columns, tet, corner)));
      return values;
    };
    const shape = this.shapeOf(by);
    if (shape) {
      return this.tally.during(this.store.allPositions(), (p) => fill(({ tets }, tet) => shape(p, tets, tet * 4)));
    }
    if (by === "region" && (this.header.hasRegions || this.header.labels.length > 0)) {
      return fill(({ groups }, tet) => groups?.[tet] ?? 0);
    }
    if (by === "region" && this.header.parts.length > 0) {
      return fill(({ firstTet }, tet) => this.header.parts.findLastIndex((part) => firstTet + tet >= Number(part.firstTet)));
    }
    if (by === "field" && this.header.fields.length > 0) {
      return this.tally.during(this.firstField(), (field) => fill(({ tets }, tet, corner) =>
        kFaceCorners[corner]!.reduce((sum, k) => sum + field[tets[tet * 4 + k]!]!, 0) / 3));
    }
    return undefined;
  }

  private shapeOf(by: string): ((p: Float32Array | Float64Array, tets: Uint32Array, at: number) => number) | undefined {
    if (by === "size") return (p, tets, at) => Math.cbrt(volumeOf(p, tets, at));
    if (by === "angle") return smallestAngle;
    if (by === "level") return (p, tets, at) => levelOf(p, tets, at, this.header.spacing);
    return undefined;
  }

  private firstField(): Float32Array {
    const floats = this.header.fields.reduce((sum, field) => sum + field.components, 0);
    const all = new Float32Array(this.store.vertices);
    this.store.forEach(({ firstVertex, fields, vertices }) => {
      for (let v = 0; v < vertices; ++v) all[firstVertex + v] = fields?.[v * floats] ?? 0;
    });
    return all;
  }

  /** Looks for the tets with the smallest angles; once all are there. */
  findWorst(): WorstTet[] {
    if (!this.keepsTets) return [];
    const worst: WorstTet[] = [];
    this.tally.during(this.store.allPositions(), (p) => this.store.forEach(({ tets, firstTet, count }) => {
      for (let t = 0; t < count; ++t) {
        const angle = smallestAngle(p, tets, t * 4);
        if (worst.length === kWorst && angle >= worst[kWorst - 1]!.angle) continue;
        worst.push({ tet: firstTet + t, angle, at: centroidOf(p, tets, t * 4) });
        worst.sort((a, b) => a.angle - b.angle);
        worst.length = Math.min(worst.length, kWorst);
      }
    }));
    return worst;
  }

  /** Edges of the surface that have not two triangles: pairs of ends, 6 numbers each. */
  seams(): Float32Array {
    const vertices = this.store.vertices;
    const corners = this.cornersOf(this.outsideFaces);
    const edges = new Float64Array(this.outsideFaces.length * 3);
    const ends: number[] = [];
    this.tally.during(edges, () => this.tally.during(this.store.allPositions(), (p) => {
      for (let i = 0; i < edges.length; ++i) {
        const a = corners[i]!, b = corners[i % 3 === 2 ? i - 2 : i + 1]!;
        edges[i] = Math.min(a, b) * vertices + Math.max(a, b);
      }
      edges.sort();
      for (let i = 0, end = 0; i < edges.length; i = end) {
        while (end < edges.length && edges[end] === edges[i]) ++end;
        if (end - i === 2) continue;
        for (const v of [Math.floor(edges[i]! / vertices), edges[i]! % vertices]) {
          ends.push(p[v * 3]!, p[v * 3 + 1]!, p[v * 3 + 2]!);
        }
      }
    }));
    this.tally.drop(corners.byteLength);
    return Float32Array.from(ends);
  }
}
