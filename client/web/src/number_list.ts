// Numbers whose count nobody knows before.
import type { Tally } from "./tally";

export class NumberList {
  private numbers = new Uint32Array(1024);
  length = 0;

  constructor(private readonly tally: Tally) {
    tally.add(this.numbers.byteLength);
  }

  push(number: number): void {
    if (this.length === this.numbers.length) {
      const old = this.numbers;
      this.numbers = new Uint32Array(Math.ceil(old.length * 1.5));
      this.tally.add(this.numbers.byteLength);
      this.numbers.set(old);
      this.tally.drop(old.byteLength);
    }
    this.numbers[this.length++] = number;
  }

  at(i: number): number {
    return this.numbers[i]!;
  }

  /** Those that are there; good until the next is added. */
  view(): Uint32Array {
    return this.numbers.subarray(0, this.length);
  }

  free(): void {
    this.tally.drop(this.numbers.byteLength);
    this.numbers = new Uint32Array();
    this.length = 0;
  }
}
