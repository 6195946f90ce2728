// What tests do in the page, one step each, and where they do it. Node.js runs the parts that are named, or all of a file.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { after, afterEach, before, describe } from "node:test";
import { binary, Browser, kGenerousEnd, makeFixture, meshIs, remove, RunningServer, scratchFolder, skipWithoutBrowser,
  until } from "./browser_case.mjs";

skipWithoutBrowser();
const wanted = process.argv.slice(2);
export const part = (name, body) => (wanted.length === 0 || wanted.includes(name)) && describe(name, body);

// One for all parts: it takes as much to start as a short test.
let browser;
after(() => browser?.close());

/** A server for all tests of a part, and a browser. */
export function stage(options = () => []) {
  const held = {};
  before(async () => {
    held.folder = scratchFolder();
    held.ball = makeFixture(held.folder, "sphere", 0.04);
    held.server = await new RunningServer(held.folder, options(held.folder)).start();
    held.browser = browser ??= await new Browser().start();
  }, { timeout: kGenerousEnd });
  afterEach(() => held.browser?.closePages());
  after(async () => {
    await held.server?.kill();
    remove(held.folder);
  });
  return held;
}

export async function chooseBall(page, held) {
  await page.setInputFiles("#file", held.ball);
  await until(page, () => /tets/.test(document.getElementById("estimate").textContent));
}

/** Asks for tets of the voxel's size times two to this power. */
export async function setSpacing(page, power) {
  await page.locator("#spacing").fill(String(power));
  await until(page, () => /tets/.test(document.getElementById("estimate").textContent));
}

export async function mesh(page) {
  await page.click("#go");
  await meshIsDone(page);
}

export async function meshIsDone(page) {
  await meshIs(page, "done", "failed");
  assert.equal(await page.evaluate(() => document.body.dataset.mesh), "done",
    await page.textContent("#alert"));
}

/** Waits until some of a mesh that comes is drawn, or none does any more. */
export const isDrawing = (page) => until(page, () =>
  Number(document.getElementById("canvas").dataset.triangles) > 0 || document.body.dataset.mesh !== "running");

export const triangles = (page) => page.evaluate(() => Number(document.getElementById("canvas").dataset.triangles));

/** The fields of a message that has numbers and texts alone. */
function fieldsOf(message) {
  const fields = {};
  let at = 0;
  const number = () => {
    for (let value = 0, shift = 0; ; shift += 7) {
      const byte = message[at++];
      value |= (byte & 127) << shift;
      if (byte < 128) return value;
    }
  };
  while (at < message.length) {
    const tag = number(), value = number();
    fields[tag >> 3] = tag & 7 ? message.toString("utf8", at, (at += value)) : value;
  }
  return fields;
}

const numberOf = (value) => (value < 128 ? [value] : [(value & 127) | 128, ...numberOf(value >> 7)]);
const textField = (field, text) => Buffer.concat([Buffer.from([(field << 3) | 2, ...numberOf(text.length)]), text]);

/**
 * Answers a method in the server's place: what is listed has these names and nothing else, and comes at most so many at a
 * time. `sizeField` is the number of the request's `page_size`, behind which its `page_token` comes.
 */
export function listInstead(page, method, sizeField, names, most) {
  const frame = (flag, content) => {
    const head = Buffer.from([flag, 0, 0, 0, 0]);
    head.writeUInt32BE(content.length, 1);
    return Buffer.concat([head, content]);
  };
  return page.route(`**/tetstream.v1.${method}`, (route) => {
    const asked = fieldsOf(route.request().postDataBuffer().subarray(5));
    const first = Number(asked[sizeField + 1] ?? 0), end = first + Math.min(asked[sizeField], most);
    const listed = names.slice(first, end).map((name) => textField(1, textField(1, Buffer.from(name))));
    const token = end < names.length ? [textField(2, Buffer.from(String(end)))] : [];
    return route.fulfill({ contentType: "application/grpc-web+proto",
      body: Buffer.concat([frame(0, Buffer.concat([...listed, ...token])), frame(0x80, Buffer.from("grpc-status: 0\r\n"))]) });
  });
}

export function makeBunny(path) {
  execFileSync(binary("tetstream"), ["convert", "/usr/share/glmark2/models/bunny.obj", path, "--voxel", "0.02"],
    { stdio: "ignore" });
}

/** A box from the origin to `high` as binary STL, without its first triangles. */
export function stl(high, missing = 0) {
  const corners = [...Array(8).keys()].map((i) => [i & 4 ? high[0] : 0, i & 2 ? high[1] : 0, i & 1 ? high[2] : 0]);
  const quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
  const triangles = quads.flatMap(([a, b, c, d]) => [[a, b, c], [a, c, d]]).slice(missing);
  const file = Buffer.alloc(84 + 50 * triangles.length);
  file.writeUInt32LE(triangles.length, 80);
  triangles.forEach((triangle, i) => triangle.flatMap((corner) => corners[corner]).forEach((value, j) =>
    file.writeFloatLE(value, 84 + 50 * i + 12 + 4 * j)));
  return file;
}
