// Reads packed chunks, as docs/wire_format.md tells it.
class Reader {
  at = 0;
  private readonly view: DataView;

  constructor(private readonly bytes: Uint8Array) {
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  }
  byte(): number {
    if (this.at >= this.bytes.length) throw new Error("a packed chunk ends early");
    return this.bytes[this.at++]!;
  }
  u16(): number {
    this.at += 2;
    return this.view.getUint16(this.at - 2, true);
  }
  u32(): number {
    this.at += 4;
    return this.view.getUint32(this.at - 4, true);
  }
  varint(): number {
    let value = 0, factor = 1;
    for (;;) {
      const byte = this.byte();
      value += (byte & 127) * factor;
      if (byte < 128) return value;
      factor *= 128;
      if (factor > 2 ** 56) throw new Error("a packed chunk has a number that does not end");
    }
  }
  take(size: number): Uint8Array {
    if (this.at + size > this.bytes.length) throw new Error("a packed chunk ends early");
    this.at += size;
    return this.bytes.subarray(this.at - size, this.at);
  }
}

export interface Unpacked {
  positions: Float32Array | Float64Array;
  tets: Uint32Array;
  /** Of each tet: 1 inside and 2 outside, or its place among the header's labels. */
  groups?: Uint8Array | Uint16Array;
  fields?: Uint8Array;
  /** 4 times a tet's number in the chunk, and the corner that the face is opposite of. */
  faces?: Uint32Array;
  faceLabels?: Uint16Array;
}

/** What the header and the chunk say of its columns. */
export interface Shape {
  firstVertex: number;
  vertices: number;
  tets: number;
  wide: boolean;
  regions: boolean;
  labels: number;
  fieldFloats: number;
  faces: number;
  faceLabels: number;
}

function readPatterns(reader: Reader): Uint16Array {
  const count = reader.varint();
  if (count > 256) throw new Error("a packed chunk has too many patterns");
  return Uint16Array.from({ length: count }, () => reader.u16());
}

/** Memory that one chunk after the other is unpacked into: what is wanted of the last is copied before the next. */
class Scratch {
  private buffer = new ArrayBuffer(0);

  bytes(size: number): ArrayBuffer {
    if (this.buffer.byteLength < size) this.buffer = new ArrayBuffer(Math.ceil(size * 1.25 / 8) * 8);
    return this.buffer;
  }
}

const forPositions = new Scratch(), forTets = new Scratch();

function readFloats(reader: Reader, count: number): Float32Array {
  const patterns = readPatterns(reader);
  const which = reader.take(count);
  const buffer = forPositions.bytes(count * 12);
  const bits = new Uint32Array(buffer, 0, count * 3);
  for (let v = 0; v < count; ++v) {
    let pattern = patterns[which[v]!]!;
    for (let axis = 0; axis < 3; ++axis, pattern >>= 3) {
      const at = v * 3 + axis;
      const last = v > 0 ? bits[at - 3]! : 0;
      const kind = pattern & 7;
      if (kind < 4) bits[at] = v > kind ? bits[at - 3 * (kind + 1)]! : 0;
      else if (kind === 4) bits[at] = reader.u16() << 16;
      else if (kind === 5) bits[at] = last + reader.u16() - 0x8000;
      else if (kind === 6) {
        bits[at] = (last & 0xff000000) | reader.u16() | (reader.byte() << 16);
      } else bits[at] = reader.u32();
    }
  }
  return new Float32Array(buffer, 0, count * 3);
}

function readDoubles(reader: Reader, count: number): Float64Array {
  const patterns = readPatterns(reader);
  const which = reader.take(count);
  const buffer = forPositions.bytes(count * 24);
  const bits = new BigUint64Array(buffer, 0, count * 3);
  const wide = (): bigint => BigInt(reader.u32()) | (BigInt(reader.u32()) << 32n);
  for (let v = 0; v < count; ++v) {
    let pattern = patterns[which[v]!]!;
    for (let axis = 0; axis < 3; ++axis, pattern >>= 3) {
      const at = v * 3 + axis;
      const before = (back: number): bigint => (v >= back ? bits[at - 3 * back]! : 0n);
      const kind = pattern & 7;
      if (kind < 4) bits[at] = before(kind + 1);
      else if (kind === 4) bits[at] = BigInt(reader.u32()) << 32n;
      else if (kind === 5) bits[at] = before(1) + BigInt(reader.u32()) - 0x80000000n;
      else if (kind === 6) {
        bits[at] = (before(1) & 0xffff000000000000n) | BigInt(reader.u32()) | (BigInt(reader.u16()) << 32n);
      } else bits[at] = wide();
    }
  }
  return new Float64Array(buffer, 0, count * 3);
}

function readTets(reader: Reader, count: number, first: number, own: number, others: number[]): Uint32Array {
  const patterns = readPatterns(reader);
  const which = reader.take(count);
  const tets = new Uint32Array(forTets.bytes(count * 16), 0, count * 4);
  const before = [0, 0, 0, 0], jumped = [0, 0, 0, 0];
  for (let t = 0; t < count; ++t) {
    let pattern = patterns[which[t]!]!;
    for (let corner = 0; corner < 4; ++corner) {
      const kind = pattern % 6;
      pattern = Math.floor(pattern / 6);
      const old = before[corner]!;
      let now: number;
      if (kind < 3) now = old + kind;
      else if (kind === 3) now = old + reader.byte() - 128;
      else if (kind === 4) now = jumped[corner]! + reader.byte() - 128;
      else now = old + reader.u16();
      now &= 0xffff;
      // What a jump leaves is where the corner was.
      if (kind > 3) jumped[corner] = old;
      before[corner] = now;
      if (now >= own + others.length) throw new Error("a packed chunk has a corner beyond its vertices");
      tets[t * 4 + corner] = now < own ? first + now : others[now - own]!;
    }
  }
  return tets;
}

/** Runs of numbers below `end`, until all `count` have one. */
function readRuns(reader: Reader, count: number, end: number): Uint16Array {
  const all = new Uint16Array(count);
  for (let at = 0; at < count;) {
    const number = reader.varint(), run = reader.varint();
    if (number >= end || run === 0 || run > count - at) throw new Error("a packed chunk has labels that do not exist");
    all.fill(number, at, at + run);
    at += run;
  }
  return all;
}

function readFaces(reader: Reader, count: number, tets: number): Uint32Array {
  const faces = new Uint32Array(count);
  for (let i = 0, next = 0; i < count; ++i) {
    faces[i] = next + reader.varint();
    if (faces[i]! >= 4 * tets) throw new Error("a packed chunk has faces of no tet");
    next = faces[i]! + 1;
  }
  return faces;
}

function readRegions(reader: Reader, tets: number): Uint8Array {
  const bits = reader.take(Math.ceil(tets / 8));
  const regions = new Uint8Array(tets);
  for (let t = 0; t < tets; ++t) regions[t] = 1 + ((bits[t >> 3]! >> (t & 7)) & 1);
  return regions;
}

function readOthers(reader: Reader): number[] {
  const others: number[] = [];
  for (let left = reader.varint(), id = 0; left > 0; --left) others.push((id += reader.varint()));
  return others;
}

/** The positions alone, which come first. They are good until the next chunk is unpacked. */
export function unpackPositions(bytes: Uint8Array, shape: Shape): Float32Array | Float64Array {
  const reader = new Reader(bytes);
  readOthers(reader);
  return shape.wide ? readDoubles(reader, shape.vertices) : readFloats(reader, shape.vertices);
}

/** All columns. Positions and tets are good until the next chunk is unpacked. */
export function unpack(bytes: Uint8Array, shape: Shape): Unpacked {
  const reader = new Reader(bytes);
  const others = readOthers(reader);
  const positions = shape.wide ? readDoubles(reader, shape.vertices) : readFloats(reader, shape.vertices);
  const tets = readTets(reader, shape.tets, shape.firstVertex, shape.vertices, others);
  const unpacked: Unpacked = { positions, tets };
  if (shape.regions) unpacked.groups = readRegions(reader, shape.tets);
  if (shape.labels > 0) unpacked.groups = readRuns(reader, shape.tets, shape.labels);
  if (shape.fieldFloats > 0) unpacked.fields = reader.take(shape.vertices * shape.fieldFloats * 4).slice();
  if (shape.faceLabels > 0) {
    unpacked.faces = readFaces(reader, shape.faces, shape.tets);
    unpacked.faceLabels = readRuns(reader, shape.faces, shape.faceLabels);
  }
  return unpacked;
}
