// What every test of the page stands on: real servers, and Debian's Chromium on its software renderer.
import { spawn, execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, openSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { connect, createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";

const require = createRequire(join(process.env.PAGE_MODULES, "package.json"));
export const { chromium } = require("playwright-core");
export const axeSource = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

const kBrowser = "/usr/bin/chromium";
// How long what has to come is waited for; no claim about speed. Of two dozen busy processes a server's jobs,
// which give way to all others, get a four-hundredth.
export const kGenerousEnd = 900_000;

export function binary(name) {
  return join(process.env.TETSTREAM_BIN, name);
}

export function skipWithoutBrowser() {
  if (existsSync(kBrowser)) return;
  console.log("skipped: there is no chromium (scripts/install_packages test)");
  process.exit(77);
}

export function scratchFolder() {
  return mkdtempSync(join(tmpdir(), "tetstream-page-"));
}

export function makeFixture(folder, kind, voxel) {
  const path = join(folder, `${kind}-${voxel}.vdb`);
  execFileSync(binary("make_fixture"), [kind, String(voxel), path]);
  return path;
}

/**
 * A tetstreamd with a page; `url` is where, which is elsewhere once it is started again: a HeldWire stays where it is. What a
 * test does not take for long is not given up: the browser may not be run meanwhile.
 */
export class RunningServer {
  constructor(folder, options = []) {
    this.folder = folder;
    this.options = options;
  }

  async start() {
    this.log = join(this.folder, "server.log");
    const log = openSync(this.log, "w");
    this.process = spawn(binary("tetstreamd"),
      ["--listen", "127.0.0.1:0", "--http-listen", "127.0.0.1:0", "--store", join(this.folder, "store"), "--threads", "2",
       "--stall-seconds", "3600", ...this.options], { stdio: ["ignore", "ignore", log] });
    const { http } = await this.says("serving");
    this.port = Number(http.split(":").pop());
    this.url = `http://127.0.0.1:${this.port}/`;
    return this;
  }

  lines() {
    return readFileSync(this.log, "utf8").split("\n").filter(Boolean).map((line) => {
      try {
        return JSON.parse(line);
      } catch {
        return {};  // one that is being written
      }
    });
  }

  async says(event, more = () => true) {
    const end = Date.now() + kGenerousEnd;
    for (;;) {
      const found = this.lines().find((line) => line.event === event && more(line));
      if (found) return found;
      if (this.process.exitCode !== null) throw new Error(`tetstreamd ended: ${readFileSync(this.log, "utf8")}`);
      if (Date.now() > end) throw new Error(`the server never said ${event}`);
      await new Promise((done) => setTimeout(done, 20));
    }
  }

  async kill() {
    if (this.process.exitCode !== null || this.process.signalCode !== null) return;
    const ended = new Promise((done) => this.process.once("exit", done));
    this.process.kill("SIGKILL");
    await ended;
    this.port = undefined;  // which anybody's server may have from now on
  }
}

/** A way to a server that stops, while it is held, after so many bytes of each connection's answers; `url` is where it begins. */
export class HeldWire {
  answers = new Set();
  left = Infinity;

  async start(server) {
    this.listener = createServer((asked) =>
      server.port ? this.join(asked, connect(server.port, "127.0.0.1")) : asked.destroy());
    await new Promise((done) => this.listener.listen(0, "127.0.0.1", done));
    this.url = `http://127.0.0.1:${this.listener.address().port}/`;
    return this;
  }

  join(asked, answer) {
    this.answers.add(answer);
    answer.left = this.left;
    asked.pipe(answer);
    answer.on("data", (bytes) => {
      answer.left -= bytes.length;
      if (!asked.write(bytes) || answer.left < 0) answer.pause();
    });
    asked.on("drain", () => answer.left >= 0 && answer.resume());
    answer.on("end", () => asked.end());
    for (const [one, other] of [[asked, answer], [answer, asked]]) {
      one.on("error", () => one.destroy());
      one.on("close", () => other.destroy());
    }
    answer.on("close", () => this.answers.delete(answer));
  }

  /** From now on each connection's answers stop after so many bytes. */
  hold(bytes) {
    this.left = bytes;
    for (const answer of this.answers) answer.left = bytes;
  }

  release() {
    this.hold(Infinity);
    for (const answer of this.answers) answer.resume();
  }

  close() {
    this.listener.close();
  }
}

function residentOf(process) {
  try {
    return Number(readFileSync(`/proc/${process}/status`, "utf8").match(/VmRSS:\s*(\d+)/)[1]) * 1024;
  } catch {
    return 0;  // it has ended
  }
}

// Pixels are drawn by software: the page is laid out as anybody sees it, on a screen of few pixels where nobody looks.
const kScale = process.env.PAGE_SCREENSHOTS ? 1 : 0.5;

/** A browser whose every request is noted: none may leave for another host. */
export class Browser {
  contexts = [];

  async start() {
    this.browser = await chromium.launch({
      executablePath: kBrowser,
      timeout: kGenerousEnd,
      args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist",
        "--disable-dev-shm-usage",
        // The canvas alone takes the software renderer: what is around it is put together for half as much without.
        "--disable-gpu-compositing"],
    });
    return this;
  }

  /** Opens a page; `before` runs in it before anything of its own does. */
  async open(url, { before, ...options } = {}) {
    const context = await this.browser.newContext({
      viewport: { width: 1280, height: 900 }, deviceScaleFactor: kScale, colorScheme: "dark", ...options });
    this.contexts.push(context);
    context.setDefaultTimeout(kGenerousEnd);
    const page = await context.newPage();
    page.requested = [];
    page.errors = [];
    if (before) await page.addInitScript(before);
    page.on("request", (request) => page.requested.push(request.url()));
    page.on("pageerror", (error) => page.errors.push(String(error)));
    page.on("console", (message) => {
      if (message.type() === "error") page.errors.push(message.text());
    });
    await page.goto(url);
    return page;
  }

  /** What the processes of its tabs have in memory. */
  async residentBytes() {
    const session = await this.browser.newBrowserCDPSession();
    const { processInfo } = await session.send("SystemInfo.getProcessInfo");
    await session.detach();
    return processInfo.filter((one) => one.type === "renderer").reduce((sum, one) => sum + residentOf(one.id), 0);
  }

  /** What a test has opened draws and asks the server for as long as it is open. */
  async closePages() {
    await Promise.all(this.contexts.splice(0).map((context) => context.close()));
  }

  async close() {
    await this.browser.close();
  }
}

/** Waits until the page says so. Playwright's own way would have the page evaluate text, which its policy forbids. */
export async function until(page, said, argument) {
  const end = Date.now() + kGenerousEnd;
  // Each look takes milliseconds of three processes: what takes long is looked at less often.
  for (let wait = 20; !(await page.evaluate(said, argument)); wait = Math.min(wait * 1.2, 250)) {
    if (Date.now() > end) {
      throw new Error(`waited in vain: ${said}; alert: ${await page.textContent("#alert")}; ` +
        `status: ${await page.textContent("#status")}; errors: ${page.errors}`);
    }
    await new Promise((done) => setTimeout(done, wait));
  }
}

/** Waits until what the page says of its mesh is one of these. */
export function meshIs(page, ...states) {
  return until(page, (wanted) => wanted.includes(document.body.dataset.mesh), states);
}

/**
 * Holds the calls of a method in a page. `next()` waits for the next of them, which goes on when its route says so, and
 * whose `over` is kept once it has ended in whatever way.
 */
export async function holdCalls(page, method) {
  const held = [], waiting = [], ends = new Map();
  for (const event of ["requestfinished", "requestfailed"]) page.on(event, (request) => ends.get(request)?.());
  await page.route(`**/tetstream.v1.${method}`, (route) => {
    const over = new Promise((done) => ends.set(route.request(), done));
    const call = { route, over };
    if (waiting.length > 0) waiting.shift()(call);
    else held.push(call);
  });
  return {
    next: () => held.length > 0 ? held.shift() : new Promise((done) => waiting.push(done)),
    letGo: () => page.unroute(`**/tetstream.v1.${method}`),
  };
}

/** Waits until what the worker made last is on the canvas. */
export function drawn(page) {
  return until(page, () => {
    const { drawn, triangles } = document.getElementById("canvas").dataset;
    return drawn !== undefined && drawn === triangles;
  });
}

/** How far two pictures are apart, from 0 to 255: their means over squares of a twentieth of their width. */
export function difference(page, one, other) {
  return page.evaluate(async (texts) => {
    const cells = 20;
    const small = await Promise.all(texts.map(async (text) => {
      const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
      const image = await createImageBitmap(new Blob([bytes], { type: "image/png" }),
        { resizeWidth: cells, resizeHeight: cells, resizeQuality: "high" });
      const context = new OffscreenCanvas(cells, cells).getContext("2d");
      context.drawImage(image, 0, 0);
      return context.getImageData(0, 0, cells, cells).data;
    }));
    let most = 0;
    small[0].forEach((value, i) => (most = Math.max(most, Math.abs(value - small[1][i]))));
    return most;
  }, [one.toString("base64"), other.toString("base64")]);
}

export function remove(folder) {
  rmSync(folder, { recursive: true, force: true });
}
