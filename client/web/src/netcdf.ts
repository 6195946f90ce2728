// Classic netCDF files, as core/files/netcdf_header.h writes them: a header that says where everything lies, and plain
// columns of big-endian numbers behind it.
import { FileParts } from "./file_parts";

export type NetcdfType = "char" | "int" | "float" | "double";

const kCodes: Record<NetcdfType, number> = { char: 2, int: 4, float: 5, double: 6 };
const kBytes: Record<NetcdfType, number> = { char: 1, int: 4, float: 4, double: 8 };
const kDimensions = 0x0a, kVariables = 0x0b, kAttributes = 0x0c;
// One variable that takes so much wants sizes of 64 bits.
const kMostNarrow = 2 ** 31;

interface Attribute {
  name: string;
  type: NetcdfType;
  count: number;
  bytes: Uint8Array;
}

interface Variable {
  name: string;
  type: NetcdfType;
  dimensions: number[];
  attributes: Attribute[];
  write: (file: FileParts) => void;
  bytes: number;
  place: number;
}

/** The same numbers, their bytes turned around in place. */
export function bigEndian<T extends Int32Array | Float32Array | Float64Array>(numbers: T): T {
  const words = new Uint32Array(numbers.buffer, numbers.byteOffset, numbers.byteLength / 4);
  for (let i = 0; i < words.length; ++i) {
    const word = words[i]!;
    words[i] = (word << 24) | ((word & 0xff00) << 8) | ((word >>> 8) & 0xff00) | (word >>> 24);
  }
  if (numbers.BYTES_PER_ELEMENT === 8) {
    for (let i = 0; i < words.length; i += 2) [words[i], words[i + 1]] = [words[i + 1]!, words[i]!];
  }
  return numbers;
}

export function textAttribute(name: string, text: string): Attribute {
  const bytes = new TextEncoder().encode(text);
  return { name, type: "char", count: bytes.length, bytes };
}

export function intAttribute(name: string, value: number): Attribute {
  return { name, type: "int", count: 1, bytes: new Uint8Array(bigEndian(Int32Array.of(value)).buffer) };
}

export function floatAttribute(name: string, value: number): Attribute {
  return { name, type: "float", count: 1, bytes: new Uint8Array(bigEndian(Float32Array.of(value)).buffer) };
}

/** A file with at most one record. */
export class NetcdfFile {
  private readonly dimensions: { name: string; size: number }[] = [];
  private readonly attributes: Attribute[] = [];
  private readonly variables: Variable[] = [];
  private steps = 0;
  private stepsDimension = -1;

  dimension(name: string, size: number): number {
    return this.dimensions.push({ name, size }) - 1;
  }

  /** The one along which there is a record for each step, of 0 or 1. Its variables come after all others. */
  stepDimension(name: string, steps: number): number {
    this.steps = steps;
    return (this.stepsDimension = this.dimension(name, 0));  // so is it told from the others
  }

  attribute(attribute: Attribute): void {
    this.attributes.push(attribute);
  }

  /** `write` is called once, and writes all of it. */
  variable(name: string, type: NetcdfType, dimensions: number[], write: (file: FileParts) => void,
    attributes: Attribute[] = []): void {
    const bytes = dimensions.reduce(
      (product, one) => product * (one === this.stepsDimension ? 1 : this.dimensions[one]!.size), kBytes[type]);
    this.variables.push({ name, type, dimensions, attributes, write, bytes: Math.ceil(bytes / 4) * 4, place: 0 });
  }

  /** Writes the whole file, into one that is empty yet. */
  write(file: FileParts): void {
    const wide = this.variables.some(({ bytes }) => bytes >= kMostNarrow);
    const hasSteps = ({ dimensions }: Variable): boolean => dimensions[0] === this.stepsDimension;
    const ordered = [...this.variables.filter((one) => !hasSteps(one)), ...this.variables.filter(hasSteps)];
    let place = this.header(wide).size;  // places take the same room whatever they are
    for (const variable of ordered) {
      variable.place = place;
      place += hasSteps(variable) ? this.steps * variable.bytes : variable.bytes;
    }
    file.append(this.header(wide).blob());
    for (const variable of ordered) {
      if (hasSteps(variable) && this.steps === 0) continue;
      variable.write(file);
      file.pad(4);
      if (file.size !== variable.place + variable.bytes) throw new Error(`${variable.name} of a netCDF file is not whole`);
    }
  }

  private header(wide: boolean): FileParts {
    const file = new FileParts();
    const word = (value: number): void => file.bytes(bigEndian(Int32Array.of(value)));
    const long = (value: number): void => {
      word(Math.floor(value / 2 ** 32));
      word(value % 2 ** 32);
    };
    const count = wide ? long : word;
    const name = (text: string): void => {
      const bytes = new TextEncoder().encode(text);
      count(bytes.length);
      file.bytes(bytes);
      file.pad(4);
    };
    const list = <T>(tag: number, all: T[], put: (one: T) => void): void => {
      word(all.length > 0 ? tag : 0);
      count(all.length);
      all.forEach(put);
    };
    const attributes = (all: Attribute[]): void => list(kAttributes, all, (one) => {
      name(one.name);
      word(kCodes[one.type]);
      count(one.count);
      file.bytes(one.bytes);
      file.pad(4);
    });
    file.text(wide ? "CDF\x05" : "CDF\x02");
    count(this.steps);
    list(kDimensions, this.dimensions, (one) => {
      name(one.name);
      count(one.size);
    });
    attributes(this.attributes);
    list(kVariables, this.variables, (one) => {
      name(one.name);
      count(one.dimensions.length);
      one.dimensions.forEach(count);
      attributes(one.attributes);
      word(kCodes[one.type]);
      count(one.bytes);
      long(one.place);
    });
    return file;
  }
}
