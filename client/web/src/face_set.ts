// Faces that only one tet has, while tets come: the surface of what is there so far.

/** A hash of faces, open addressing. A face that comes a second time leaves. */
export class FaceSet {
  private slots = 1 << 16;
  private count_ = 0;
  /** Sorted ids, then the corners as they are wound, then the tet: 7 a slot; the tet is 0 for none. */
  private table = new Uint32Array(this.slots * 7);

  get count(): number {
    return this.count_;
  }

  private slotOf(a: number, b: number, c: number): number {
    let hash = Math.imul(a, 0x9e3779b1) ^ Math.imul(b, 0x85ebca77) ^ Math.imul(c, 0xc2b2ae3d);
    hash = Math.imul(hash ^ (hash >>> 15), 0x2c1b3c6d);
    return ((hash ^ (hash >>> 13)) >>> 0) & (this.slots - 1);
  }

  /** Adds the face p, q, r of a tet, or removes it where another tet has it. */
  toggle(p: number, q: number, r: number, tet: number): void {
    let a = p, b = q, c = r, t;
    if (a > b) { t = a; a = b; b = t; }
    if (b > c) { t = b; b = c; c = t; }
    if (a > b) { t = a; a = b; b = t; }
    const table = this.table, mask = this.slots - 1;
    let slot = this.slotOf(a, b, c);
    for (;; slot = (slot + 1) & mask) {
      const at = slot * 7;
      if (table[at + 6] === 0) break;
      if (table[at] === a && table[at + 1] === b && table[at + 2] === c) return this.remove(slot);
    }
    const at = slot * 7;
    table[at] = a; table[at + 1] = b; table[at + 2] = c;
    table[at + 3] = p; table[at + 4] = q; table[at + 5] = r;
    table[at + 6] = tet + 1;
    if (++this.count_ * 2 > this.slots) this.grow();
  }

  /** Calls `use` with each face's corners and tet. */
  forEach(use: (p: number, q: number, r: number, tet: number) => void): void {
    const table = this.table;
    for (let at = 0; at < table.length; at += 7) {
      if (table[at + 6] !== 0) use(table[at + 3]!, table[at + 4]!, table[at + 5]!, table[at + 6]! - 1);
    }
  }

  has(p: number, q: number, r: number): boolean {
    let a = Math.min(p, q, r);
    const c = Math.max(p, q, r);
    const b = p + q + r - a - c;
    const mask = this.slots - 1;
    for (let slot = this.slotOf(a, b, c); this.table[slot * 7 + 6] !== 0; slot = (slot + 1) & mask) {
      const at = slot * 7;
      if (this.table[at] === a && this.table[at + 1] === b && this.table[at + 2] === c) return true;
    }
    return false;
  }

  // What follows moves up, unless it lies where it belongs.
  private remove(slot: number): void {
    const table = this.table, mask = this.slots - 1;
    let hole = slot;
    for (let next = (hole + 1) & mask; table[next * 7 + 6] !== 0; next = (next + 1) & mask) {
      const at = next * 7;
      const home = this.slotOf(table[at]!, table[at + 1]!, table[at + 2]!);
      if (((next - home) & mask) < ((next - hole) & mask)) continue;
      table.copyWithin(hole * 7, at, at + 7);
      hole = next;
    }
    table[hole * 7 + 6] = 0;
    --this.count_;
  }

  private grow(): void {
    const old = this.table;
    this.slots *= 2;
    this.table = new Uint32Array(this.slots * 7);
    const mask = this.slots - 1;
    for (let at = 0; at < old.length; at += 7) {
      if (old[at + 6] === 0) continue;
      let slot = this.slotOf(old[at]!, old[at + 1]!, old[at + 2]!);
      while (this.table[slot * 7 + 6] !== 0) slot = (slot + 1) & mask;
      this.table.set(old.subarray(at, at + 7), slot * 7);
    }
  }
}
