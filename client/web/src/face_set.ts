// Faces that only one tet has, while tets come: the surface of what is there so far.
import type { Tally } from "./tally";

const kTables = 256;
// Of its slots a table uses at most this much, and grows by this much: little is held twice, as tables grow one by one.
const kFullest = 0.85, kGrowth = 1.15;

/** One table: open addressing, four numbers a slot. */
class Table {
  private slots = 64;
  count = 0;
  /** Corners as they are wound, the smallest first, then the face's number and one; 0 for none. */
  private rows = new Uint32Array(this.slots * 4);

  constructor(private readonly tally: Tally) {
    tally.add(this.rows.byteLength);
  }

  /** Adds the face, or removes the one with the same corners wound the other way, and returns its number. */
  toggle(a: number, b: number, c: number, hash: number, face: number): number {
    const rows = this.rows, slots = this.slots;
    let slot = home(hash, slots);
    for (; rows[slot * 4 + 3] !== 0; slot = slot + 1 === slots ? 0 : slot + 1) {
      const at = slot * 4;
      if (rows[at] !== a) continue;
      if ((rows[at + 1] === c && rows[at + 2] === b) || (rows[at + 1] === b && rows[at + 2] === c)) {
        const other = rows[at + 3]! - 1;
        this.remove(slot);
        return other;
      }
    }
    this.put(slot, a, b, c, face + 1);
    if (++this.count > this.slots * kFullest) this.grow();
    return -1;
  }

  forEach(use: (p: number, q: number, r: number, face: number) => void): void {
    const rows = this.rows;
    for (let at = 0; at < rows.length; at += 4) {
      if (rows[at + 3] !== 0) use(rows[at]!, rows[at + 1]!, rows[at + 2]!, rows[at + 3]! - 1);
    }
  }

  /** The table must not be used any more. */
  free(): void {
    this.tally.drop(this.rows.byteLength);
  }

  private put(slot: number, a: number, b: number, c: number, mark: number): void {
    const at = slot * 4;
    this.rows[at] = a;
    this.rows[at + 1] = b;
    this.rows[at + 2] = c;
    this.rows[at + 3] = mark;
  }

  // What follows moves up, unless it lies where it belongs.
  private remove(slot: number): void {
    const rows = this.rows, slots = this.slots;
    let hole = slot;
    for (let next = (hole + 1) % slots; rows[next * 4 + 3] !== 0; next = (next + 1) % slots) {
      const at = next * 4;
      const belongs = home(hashOf(rows[at]!, rows[at + 1]!, rows[at + 2]!), slots);
      if ((next - belongs + slots) % slots < (next - hole + slots) % slots) continue;
      rows.copyWithin(hole * 4, at, at + 4);
      hole = next;
    }
    rows[hole * 4 + 3] = 0;
    --this.count;
  }

  private grow(): void {
    const old = this.rows;
    this.slots = Math.ceil(this.slots * kGrowth);
    this.rows = new Uint32Array(this.slots * 4);
    this.tally.add(this.rows.byteLength);
    for (let at = 0; at < old.length; at += 4) {
      if (old[at + 3] === 0) continue;
      let slot = home(hashOf(old[at]!, old[at + 1]!, old[at + 2]!), this.slots);
      while (this.rows[slot * 4 + 3] !== 0) slot = slot + 1 === this.slots ? 0 : slot + 1;
      this.put(slot, old[at]!, old[at + 1]!, old[at + 2]!, old[at + 3]!);
    }
    this.tally.drop(old.byteLength);
  }
}

/** The same whichever way a face is wound. `a` is the smallest corner. */
function hashOf(a: number, b: number, c: number): number {
  let hash = Math.imul(a, 0x9e3779b1) ^ Math.imul(b + c, 0x85ebca77) ^ Math.imul(b ^ c, 0xc2b2ae3d);
  hash = Math.imul(hash ^ (hash >>> 15), 0x2c1b3c6d);
  hash = Math.imul(hash ^ (hash >>> 12), 0x297a2d39);
  return (hash ^ (hash >>> 15)) >>> 0;
}

// The lowest bits choose the table, all of them the slot.
function home(hash: number, slots: number): number {
  return Math.floor((hash / 0x1_0000_0000) * slots);
}

export class FaceSet {
  private tables: Table[];

  constructor(tally: Tally) {
    this.tables = Array.from({ length: kTables }, () => new Table(tally));
  }

  get count(): number {
    return this.tables.reduce((sum, table) => sum + table.count, 0);
  }

  /**
   * Adds the face p, q, r with its number; or, where its neighbour has been added, removes that and returns its number.
   * Else the answer is -1.
   */
  toggle(p: number, q: number, r: number, face: number): number {
    let a = p, b = q, c = r;
    if (q < p && q < r) { a = q; b = r; c = p; }
    else if (r < p && r < q) { a = r; b = p; c = q; }
    const hash = hashOf(a, b, c);
    const table = this.tables[hash & (kTables - 1)];
    if (!table) throw new Error("a face came after the set of faces was freed");
    return table.toggle(a, b, c, hash, face);
  }

  /** Calls `use` with each face's corners and its number. */
  forEach(use: (p: number, q: number, r: number, face: number) => void): void {
    for (const table of this.tables) table.forEach(use);
  }

  /** Forgets all faces, and takes no more. */
  free(): void {
    for (const table of this.tables) table.free();
    this.tables = [];
  }
}
