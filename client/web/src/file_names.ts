// Names as formats take them: short, of few characters, no two alike.

interface NameRule {
  mostBytes?: number;
  ignoresCase?: boolean;
  /** Names that the file has for itself. */
  taken?: string[];
}

/** Letters, digits and `_` alone, a letter first. */
function plainName(name: string, mostBytes: number): string {
  const plain = [...name].map((c) => (/[A-Za-z0-9_]/.test(c) ? c : "_")).join("");
  return (/^[A-Za-z]/.test(plain) ? plain : `n${plain}`).slice(0, mostBytes);
}

/** The longest beginning of a text that takes no more bytes in UTF-8, and ends where a character does. */
function cutTo(text: string, mostBytes: number): string {
  const utf8 = new TextEncoder();
  let kept = "", left = mostBytes;
  for (const character of text) {
    left -= utf8.encode(character).length;
    if (left < 0) break;
    kept += character;
  }
  return kept;
}

/** The first of `wanted`, `wanted_2`, `wanted_3`, ... that is free, cut so that its ending has room. */
function firstFree(wanted: string, mostBytes: number, isFree: (name: string) => boolean): string {
  let name = wanted;
  for (let number = 2; !isFree(name); ++number) {
    const ending = `_${number}`;
    name = cutTo(wanted, mostBytes - ending.length) + ending;
  }
  return name;
}

/** Names of letters, digits and `_`, where `_` stands for each other character; no two alike. */
export function namesInFile(names: string[], { mostBytes = 80, ignoresCase = false, taken = [] }: NameRule = {}): string[] {
  const keyOf = (name: string): string => (ignoresCase ? name.toLowerCase() : name);
  const used = new Set(taken.map(keyOf));
  return names.map((name) => {
    const free = firstFree(plainName(name, mostBytes), mostBytes, (one) => !used.has(keyOf(one)));
    used.add(keyOf(free));
    return free;
  });
}

/** Names that keep their characters and are cut to so many bytes of UTF-8; no two alike. */
export function shortNames(names: string[], mostBytes: number): string[] {
  const used = new Set<string>();
  return names.map((name) => {
    const free = firstFree(cutTo(name, mostBytes), mostBytes, (one) => !used.has(one));
    used.add(free);
    return free;
  });
}

/** The names of a field's columns: a scalar's is its own, and a vector's tell their components. */
function columnsOf(name: string, components: number): string[] {
  return components === 1 ? [name] : ["_x", "_y", "_z"].map((end) => name + end);
}

/** The names of the columns of each field, no two alike; `mostBytes` leaves room for what tells components. */
export function columnNames(fields: { name: string; components: number }[],
    { mostBytes = 80, taken = [] }: NameRule = {}): string[][] {
  const used = new Set(taken);
  return fields.map(({ name, components }) => {
    const areFree = (one: string): boolean => columnsOf(one, components).every((column) => !used.has(column));
    const columns = columnsOf(firstFree(plainName(name, mostBytes), mostBytes, areFree), components);
    columns.forEach((column) => used.add(column));
    return columns;
  });
}

/** A name as a comment has it, on one line. */
export function inComment(name: string): string {
  return name.replace(/\p{C}/gu, "?");
}

export function xml(text: string): string {
  return text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;").replace(/"/g, "&quot;");
}
