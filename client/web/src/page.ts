// What the views share: elements, the token, alerts, numbers as text.
import { RpcError, kUnauthenticated, type CallOptions } from "./rpc";

export function element<T extends HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`no element ${id}`);
  return found as T;
}

export function made<K extends keyof HTMLElementTagNameMap>(tag: K, text = "", parent?: Element):
    HTMLElementTagNameMap[K] {
  const node = document.createElement(tag);
  node.textContent = text;
  parent?.append(node);
  return node;
}

// In memory alone: whoever comes to this machine later finds none.
let token = "";

export function setToken(text: string): void {
  token = text.trim();
}

export function options(more: Partial<CallOptions> = {}): CallOptions {
  return { token, ...more };
}

// What is wrong for as long as the page is open.
let standing = "";

/** Says what is wrong now, or with no text that nothing is. */
export function alertOf(text: string): void {
  element("alert").textContent = [standing, text].filter(Boolean).join("\n");
}

/** Says what stays wrong, whatever is said later. */
export function standingAlert(text: string): void {
  standing = text;
  alertOf("");
}

/** Says what went wrong and what to do. */
export function explain(error: unknown): string {
  if (!(error instanceof RpcError)) return error instanceof Error ? error.message : String(error);
  const request = error.requestId ? ` (request ${error.requestId})` : "";
  if (error.code === kUnauthenticated) return `${error.message}. Put your token into the field above.${request}`;
  return `${error.message}${error.reason ? ` [${error.reason}]` : ""}${request}`;
}

/** A line of a table. */
export function row(table: Element, ...cells: (string | Element)[]): void {
  const line = made("tr", "", table);
  for (const cell of cells) made("td", "", line).append(cell);
}

/**
 * One row of the table for each key, in this order. Rows that are there stay what they are and do not move without need:
 * a row that is drawn anew under the mouse loses the click, and one under the keyboard loses the focus.
 */
export function keptRows(table: Element, keys: string[]): HTMLTableRowElement[] {
  const before = new Map([...table.children].map((line) => [(line as HTMLTableRowElement).dataset["key"], line as HTMLTableRowElement]));
  const lines = keys.map((key) => {
    const line = before.get(key) ?? made("tr");
    line.dataset["key"] = key;
    return line;
  });
  for (const line of [...table.children].filter((line) => !lines.includes(line as HTMLTableRowElement))) line.remove();
  lines.forEach((line, i) => {
    if (table.children[i] !== line) table.insertBefore(line, table.children[i] ?? null);
  });
  return lines;
}

/** Says in each cell of a row what it is to say now; what is undefined stays as it is. */
export function fillRow(line: HTMLTableRowElement, ...cells: (string | (string | Element)[] | undefined)[]): void {
  cells.forEach((content, i) => {
    const cell = line.children[i] ?? made("td", "", line);
    if (typeof content === "string") cell.textContent = content;
    else if (content) cell.replaceChildren(...content);
  });
}

export function count(n: number | bigint): string {
  return Number(n).toLocaleString("en-US");
}

export function sizeOf(bytes: number): string {
  const units = ["B", "kB", "MB", "GB", "TB"];
  let unit = 0;
  while (bytes >= 1000 && unit < units.length - 1) {
    bytes /= 1000;
    ++unit;
  }
  return `${bytes < 10 && unit > 0 ? bytes.toFixed(1) : Math.round(bytes)} ${units[unit]}`;
}

export function short(n: number): string {
  return Number(n.toPrecision(4)).toString();
}
