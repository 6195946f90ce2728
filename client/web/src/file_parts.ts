// A file as it is made: its parts go to the browser's blobs, which may lie on disk, before they are many.
import { Crc32 } from "./crc32";

const kMostHeld = 4 << 20;
const kText = new TextEncoder();

export class FileParts {
  private parts: BlobPart[] = [];
  private readonly flushed: Blob[] = [];
  private held = 0;
  /** Bytes so far. */
  size = 0;

  /** `sum` is kept of all bytes where somebody wants it. */
  constructor(private readonly sum?: Crc32) {}

  text(text: string): void {
    this.bytes(kText.encode(text));
  }

  /** They are not to be changed afterwards. */
  bytes(bytes: ArrayBufferView): void {
    this.sum?.add(new Uint8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength));
    this.parts.push(bytes as unknown as BlobPart);
    this.size += bytes.byteLength;
    if ((this.held += bytes.byteLength) > kMostHeld) this.flush();
  }

  /** What was made before, of which no sum is kept here. */
  append(blob: Blob): void {
    this.parts.push(blob);
    this.size += blob.size;
  }

  /** Zero bytes up to a multiple of `unit`. */
  pad(unit: number): void {
    if (this.size % unit > 0) this.bytes(new Uint8Array(unit - (this.size % unit)));
  }

  /** A line for each of `count` rows. */
  lines(count: number, line: (i: number) => string): void {
    const kAtOnce = 8192;
    for (let first = 0; first < count; first += kAtOnce) {
      let text = "";
      for (let i = first; i < Math.min(first + kAtOnce, count); ++i) text += line(i);
      this.text(text);
    }
  }

  /** All of it. */
  blob(): Blob {
    this.flush();
    return new Blob(this.flushed, { type: "application/octet-stream" });
  }

  private flush(): void {
    this.flushed.push(new Blob(this.parts));
    this.parts = [];
    this.held = 0;
  }
}

/** The shortest text that reads as the same float32. */
export function shortFloat32(x: number): string {
  for (let digits = 6; digits < 9; ++digits) {
    const text = x.toPrecision(digits);
    if (Math.fround(Number(text)) === x) return String(Number(text));
  }
  return String(Number(x.toPrecision(9)));
}

/** The same, of float32 or float64, in at most 20 characters: the last digits go where they must. */
export function textOf(x: number, wide: boolean): string {
  let text = wide ? String(x) : shortFloat32(x);
  for (let digits = 17; text.length > 20; --digits) text = String(Number(x.toPrecision(digits)));
  return text;
}
