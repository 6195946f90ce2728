// HDF5 files in the layout of its first versions, which every reader knows: a superblock of version 0, groups as symbol
// tables, and datasets in one piece each. What is small comes first, the columns behind it.
import type { FileParts } from "./file_parts";

/** As the file has its numbers. */
export type Hdf5Type = "u8" | "i32" | "i64" | "f32" | "f64";

const kBytes: Record<Hdf5Type, number> = { u8: 1, i32: 4, i64: 8, f32: 4, f64: 8 };
const kNowhere = 0xffff_ffff_ffff_ffffn;
const kSuperblockBytes = 96, kHeadBytes = 16, kMessageHead = 8;
const kNamesHead = 32, kTableHead = 8, kEntryBytes = 40;
// A node of a tree has room for so many children, and a key before each and behind the last. One is used.
const kChildren = 32, kTreeBytes = 24 + kChildren * 8 + (kChildren + 1) * 8;
const kMessages = { space: 0x01, type: 0x03, fill: 0x05, layout: 0x08, attribute: 0x0c, table: 0x11 };

function toEight(bytes: number): number {
  return Math.ceil(bytes / 8) * 8;
}

/** Little-endian numbers, one behind the other. */
class Bytes {
  private readonly all: number[] = [];

  put(value: number | bigint, bytes: number): this {
    for (let left = BigInt(value), i = 0; i < bytes; ++i, left >>= 8n) this.all.push(Number(left & 255n));
    return this;
  }

  text(text: string): this {
    this.all.push(...new TextEncoder().encode(text));
    return this;
  }

  /** Zeros up to a size, or to the next multiple of eight. */
  upTo(size = toEight(this.all.length)): this {
    while (this.all.length < size) this.all.push(0);
    return this;
  }

  add(bytes: Uint8Array): this {
    for (const byte of bytes) this.all.push(byte);
    return this;
  }

  done(): Uint8Array {
    return Uint8Array.from(this.all);
  }
}

function typeMessage(type: Hdf5Type): Uint8Array {
  const size = kBytes[type], bits = size * 8, version = 0x10;
  if (type === "f32" || type === "f64") {
    const [mantissa, exponent] = type === "f32" ? [23, 8] : [52, 11];
    // Its highest digit is not stored; where the sign is; then its parts, and what the exponent is above.
    return new Bytes().put(version | 1, 1).put(0x20, 1).put(bits - 1, 1).put(0, 1).put(size, 4).put(0, 2).put(bits, 2)
      .put(mantissa, 1).put(exponent, 1).put(0, 1).put(mantissa, 1).put(2 ** (exponent - 1) - 1, 4).done();
  }
  return new Bytes().put(version, 1).put(type === "u8" ? 0 : 0x08, 1).put(0, 2).put(size, 4).put(0, 2).put(bits, 2).done();
}

function textType(bytes: number): Uint8Array {
  return new Bytes().put(0x13, 1).put(0, 3).put(bytes, 4).done();
}

function spaceMessage(shape: number[]): Uint8Array {
  const bytes = new Bytes().put(1, 1).put(shape.length, 1).put(0, 6);
  for (const size of shape) bytes.put(size, 8);
  return bytes.done();
}

function message(kind: number, content: Uint8Array): Uint8Array {
  return new Bytes().put(kind, 2).put(toEight(content.length), 2).put(0, 4).add(content).upTo().done();
}

function header(messages: Uint8Array[]): Uint8Array {
  const size = messages.reduce((sum, { length }) => sum + length, 0);
  const bytes = new Bytes().put(1, 1).put(0, 1).put(messages.length, 2).put(1, 4).put(size, 4).put(0, 4);
  for (const one of messages) bytes.add(one);
  return bytes.done();
}

class Dataset {
  place = 0;  // of its header
  column = 0;  // of its numbers

  constructor(private readonly type: Hdf5Type, private readonly shape: number[], readonly write: (file: FileParts) => void) {}

  get bytes(): number {
    return this.shape.reduce((product, size) => product * size, kBytes[this.type]);
  }

  /** As long wherever the column lies. */
  header(): Uint8Array {
    return header([
      message(kMessages.space, spaceMessage(this.shape)),
      message(kMessages.type, typeMessage(this.type)),
      // Room is made at once, and filled by nobody else.
      message(kMessages.fill, new Bytes().put(2, 1).put(1, 1).put(1, 1).put(0, 1).done()),
      message(kMessages.layout, new Bytes().put(3, 1).put(1, 1).put(this.column, 8).put(this.bytes, 8).done())]);
  }
}

export class Hdf5Group {
  place = 0;
  private readonly attributes: Uint8Array[] = [];
  private readonly members = new Map<string, Hdf5Group | Dataset>();

  text(name: string, value: string): void {
    this.attribute(name, textType(value.length), spaceMessage([]), new Bytes().text(value).done());
  }

  integers(name: string, values: number[]): void {
    const bytes = new Bytes();
    for (const value of values) bytes.put(value, 8);
    this.attribute(name, typeMessage("i64"), spaceMessage([values.length]), bytes.done());
  }

  group(name: string): Hdf5Group {
    const made = new Hdf5Group();
    this.members.set(name, made);
    return made;
  }

  /** `write` is called once, and writes all of it. */
  column(name: string, type: Hdf5Type, shape: number[], write: (file: FileParts) => void): void {
    this.members.set(name, new Dataset(type, shape, write));
  }

  number(name: string, value: number): void {
    this.column(name, "i64", [1], (file) => file.bytes(BigInt64Array.of(BigInt(value))));
  }

  private attribute(name: string, type: Uint8Array, space: Uint8Array, value: Uint8Array): void {
    const bytes = new Bytes().put(1, 1).put(0, 1).put(new TextEncoder().encode(name).length + 1, 2)
      .put(type.length, 2).put(space.length, 2).text(name).put(0, 1).upTo().add(type).upTo().add(space).upTo().add(value);
    this.attributes.push(message(kMessages.attribute, bytes.done()));
  }

  /** Members by name, as tables have them: sorted by their bytes. */
  private sorted(): [Uint8Array, Hdf5Group | Dataset][] {
    const less = (a: Uint8Array, b: Uint8Array): number => {
      const at = a.findIndex((byte, i) => byte !== b[i]);
      return at < 0 ? a.length - b.length : a[at]! - (b[at] ?? -1);
    };
    return [...this.members].map(([name, member]) => [new TextEncoder().encode(name), member] as [Uint8Array, typeof member])
      .sort(([a], [b]) => less(a, b));
  }

  get largest(): number {
    return Math.max(this.members.size,
      ...[...this.members.values()].map((member) => (member instanceof Hdf5Group ? member.largest : 0)));
  }

  /** Where its tree is, and the names of its members. */
  get table(): { tree: number; names: number } {
    const tree = this.place + kHeadBytes + kMessageHead + 16 + this.attributes.reduce((sum, { length }) => sum + length, 0);
    return { tree, names: tree + kTreeBytes };
  }

  /** Where each name begins: the empty one is the first. */
  private names(): { places: number[]; bytes: Uint8Array } {
    const all = new Bytes().put(0, 8), places: number[] = [];
    let next = 8;
    for (const [name] of this.sorted()) {
      places.push(next);
      all.add(name).put(0, 1).upTo();
      next += toEight(name.length + 1);
    }
    return { places, bytes: all.done() };
  }

  /** Gives all of it a place from `next` on; returns where it ends. */
  lay(next: number, room: number): number {
    this.place = next;
    next = this.table.names + kNamesHead + this.names().bytes.length + kTableHead + room * kEntryBytes;
    for (const [, member] of this.sorted()) {
      if (member instanceof Hdf5Group) next = member.lay(next, room);
      else {
        member.place = next;
        next += member.header().length;
      }
    }
    return next;
  }

  /** Gives columns their places, in the order in which they were added. */
  layColumns(next: number): number {
    for (const member of this.members.values()) {
      if (member instanceof Hdf5Group) next = member.layColumns(next);
      else {
        member.column = next;
        next = toEight(next + member.bytes);
      }
    }
    return next;
  }

  writeOutline(file: FileParts, room: number): void {
    const { tree, names } = this.table, { places, bytes } = this.names(), members = this.sorted();
    const entries = names + kNamesHead + bytes.length;
    file.bytes(header([message(kMessages.table, new Bytes().put(tree, 8).put(names, 8).done()), ...this.attributes]));
    file.bytes(new Bytes().text("TREE").put(0, 2).put(1, 2).put(kNowhere, 8).put(kNowhere, 8)
      .put(0, 8).put(entries, 8).put(places.at(-1)!, 8).upTo(kTreeBytes).done());
    const noRoomLeft = 1;
    file.bytes(new Bytes().text("HEAP").put(0, 4).put(bytes.length, 8).put(noRoomLeft, 8).put(names + kNamesHead, 8).done());
    file.bytes(bytes);
    const table = new Bytes().text("SNOD").put(1, 2).put(members.length, 2);
    members.forEach(([, member], i) => table.put(places[i]!, 8).put(member.place, 8).put(0, 24));
    file.bytes(table.upTo(kTableHead + room * kEntryBytes).done());
    for (const [, member] of members) {
      if (member instanceof Hdf5Group) member.writeOutline(file, room);
      else file.bytes(member.header());
    }
  }

  writeColumns(file: FileParts): void {
    for (const member of this.members.values()) {
      if (member instanceof Hdf5Group) member.writeColumns(file);
      else {
        member.write(file);
        file.pad(8);
      }
    }
  }
}

/** Writes the whole file, into one that is empty yet. No group may be. */
export function writeHdf5(file: FileParts, root: Hdf5Group): void {
  // Half of what a table has room for: one table takes the largest group.
  const half = Math.max(4, Math.ceil(root.largest / 2)), room = 2 * half;
  const outline = root.lay(kSuperblockBytes, room), end = root.layColumns(toEight(outline));
  const { tree, names } = root.table;
  file.bytes(new Bytes().put(0x89, 1).text("HDF\r\n").put(0x1a, 1).text("\n")
    .put(0, 5).put(8, 1).put(8, 1).put(0, 1)  // versions; bytes of a place and of a length
    .put(half, 2).put(kChildren / 2, 2).put(0, 4)
    .put(0, 8).put(kNowhere, 8).put(end, 8).put(kNowhere, 8)
    .put(0, 8).put(root.place, 8).put(1, 4).put(0, 4).put(tree, 8).put(names, 8).done());
  root.writeOutline(file, room);
  file.pad(8);
  root.writeColumns(file);
  if (file.size !== end) throw new Error(`an HDF5 file has ${file.size} bytes, and not ${end}`);
}
