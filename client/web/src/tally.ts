// Counts the bytes of arrays that are held: what a garbage collector may know, a test cannot.

/** Told by whoever makes or drops an array of a size that grows with the mesh. */
export class Tally {
  /** Bytes now, and the most that they ever were. */
  now = 0;
  most = 0;

  add(bytes: number): void {
    this.now += bytes;
    this.most = Math.max(this.most, this.now);
  }

  drop(bytes: number): void {
    this.now -= bytes;
  }

  /** Counts what `make` returns while `use` has it. */
  during<T extends ArrayBufferView, R>(made: T, use: (made: T) => R): R {
    this.add(made.byteLength);
    try {
      return use(made);
    } finally {
      this.drop(made.byteLength);
    }
  }
}
