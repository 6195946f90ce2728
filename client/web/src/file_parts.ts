// A file as it is made: its parts go to the browser's blobs, which may lie on disk, before they are many.
const kMostHeld = 4 << 20;

export class FileParts {
  private parts: BlobPart[] = [];
  private readonly whole: Blob[] = [];
  private held = 0;

  text(text: string): void {
    this.put(text, text.length);
  }

  bytes(bytes: ArrayBufferView): void {
    this.put(bytes as unknown as BlobPart, bytes.byteLength);
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

  blob(): Blob {
    this.flush();
    return new Blob(this.whole, { type: "application/octet-stream" });
  }

  private put(part: BlobPart, bytes: number): void {
    this.parts.push(part);
    if ((this.held += bytes) > kMostHeld) this.flush();
  }

  private flush(): void {
    this.whole.push(new Blob(this.parts));
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
