// Several files in one: a .zip whose files are stored as they are.
import { Crc32 } from "./crc32";
import { FileParts } from "./file_parts";

const kLocal = 0x04034b50, kCentral = 0x02014b50, kEnd = 0x06054b50;
const kVersion = 20, kUtf8 = 0x0800;
// No time is told, so that the same mesh is the same bytes: midnight of the first day that there is.
const kFirstDay = 0x21;
// Readers take larger ones in a variant that not all of them know.
const kMostBytes = 0xffffffff;

interface Entry {
  name: Uint8Array;
  sum: number;
  bytes: number;
  place: number;
}

/** Numbers one after the other: two bytes or four each. */
function record(...numbers: [value: number, bytes: 2 | 4][]): Uint8Array {
  const view = new DataView(new ArrayBuffer(numbers.reduce((sum, [, bytes]) => sum + bytes, 0)));
  let at = 0;
  for (const [value, bytes] of numbers) {
    if (bytes === 2) view.setUint16(at, value, true);
    else view.setUint32(at, value, true);
    at += bytes;
  }
  return new Uint8Array(view.buffer);
}

export class ZipFile {
  private readonly entries: Entry[] = [];

  constructor(private readonly file: FileParts) {}

  /** Adds what `write` writes. */
  add(name: string, write: (file: FileParts) => void): void {
    const sum = new Crc32(), content = new FileParts(sum);
    write(content);
    const entry = { name: new TextEncoder().encode(name), sum: sum.value, bytes: content.size, place: this.file.size };
    if (entry.place + entry.bytes > kMostBytes) throw new Error("the files are more than a .zip holds: the command line saves them");
    this.file.bytes(record([kLocal, 4], [kVersion, 2], ...this.common(entry), [0, 2]));
    this.file.bytes(entry.name);
    this.file.append(content.blob());
    this.entries.push(entry);
  }

  /** Adds the list of all files; nothing comes behind it. */
  end(): void {
    const begin = this.file.size;
    for (const entry of this.entries) {
      this.file.bytes(record([kCentral, 4], [kVersion, 2], [kVersion, 2], ...this.common(entry), [0, 2],
        [0, 2], [0, 2], [0, 2], [0, 4], [entry.place, 4]));
      this.file.bytes(entry.name);
    }
    const count = this.entries.length;
    this.file.bytes(record([kEnd, 4], [0, 2], [0, 2], [count, 2], [count, 2], [this.file.size - begin, 4], [begin, 4], [0, 2]));
  }

  /** What both places say of a file: that it is stored, when, its sum, its sizes, and the length of its name. */
  private common({ name, sum, bytes }: Entry): [number, 2 | 4][] {
    return [[kUtf8, 2], [0, 2], [0, 2], [kFirstDay, 2], [sum, 4], [bytes, 4], [bytes, 4], [name.length, 2]];
  }
}
