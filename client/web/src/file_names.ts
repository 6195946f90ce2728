// Names as formats take them: letters, digits and `_` alone, a letter first, no two alike.

interface NameRule {
  mostBytes?: number;
  ignoresCase?: boolean;
}

export function namesInFile(names: string[], { mostBytes = 80, ignoresCase = false }: NameRule = {}): string[] {
  const taken = new Set<string>();
  const take = (name: string): boolean => {
    const key = ignoresCase ? name.toLowerCase() : name;
    return !taken.has(key) && Boolean(taken.add(key));
  };
  return names.map((name) => {
    let plain = [...name].map((c) => (/[A-Za-z0-9_]/.test(c) ? c : "_")).join("");
    if (!/^[A-Za-z]/.test(plain)) plain = `n${plain}`;
    plain = plain.slice(0, mostBytes);
    let free = plain;
    for (let number = 2; !take(free); ++number) {
      const ending = `_${number}`;
      free = plain.slice(0, mostBytes - ending.length) + ending;
    }
    return free;
  });
}

/** A name as a comment has it, on one line. */
export function inComment(name: string): string {
  return name.replace(/\p{C}/gu, "?");
}

export function xml(text: string): string {
  return text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;").replace(/"/g, "&quot;");
}
