// Files that the page saves, and meshes that are large, in a real browser against a real server.
//   TETSTREAM_BIN=build/release/bin PAGE_MODULES=$PWD/build/release/client/web/npm/ node tests/web/page_files_test.mjs [PART...]
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, rmSync } from "node:fs";
import { join } from "node:path";
import { it } from "node:test";
import { drawn, until } from "./browser_case.mjs";
import { chooseBall, makeBunny, mesh, part, setSpacing, stage, triangles } from "./page_steps.mjs";

part("Saves", () => {
  const held = stage();
  // Formats of several files come as one.
  const kZipped = new Set(["xdmf", "polyMesh"]);
  const here = import.meta.dirname ?? new URL(".", import.meta.url).pathname;

  /** Runs the command line that the page shows, as who copies it would. */
  async function runShown(page) {
    const command = await page.inputValue("#command");
    execFileSync("/bin/sh", ["-c", command], { cwd: held.folder, stdio: "pipe",
      env: { ...process.env, PATH: `${process.env.TETSTREAM_BIN}:${process.env.PATH}` } });
  }

  /** And the Python. */
  async function runShownPython(page) {
    execFileSync("/usr/bin/python3", ["-c", await page.inputValue("#python")], { cwd: held.folder, stdio: "pipe",
      env: { ...process.env, PYTHONPATH: process.env.PAGE_PYTHON } });
  }

  /** Both write the same bytes. */
  async function expectTwins(page, ending) {
    await page.selectOption("#format", ending);
    const mesh = join(held.folder, `mesh.${ending}`);
    await runShown(page);
    const written = readFileSync(mesh);
    rmSync(mesh);
    await runShownPython(page);
    assert.ok(written.equals(readFileSync(mesh)), ending);
  }

  for (const both of [false, true]) {
    it(`saves what the copied command line saves, in every format${both ? ", with both sides" : ""}`, async () => {
      const page = await held.browser.open(held.server.url);
      await chooseBall(page, held);
      await setSpacing(page, 2);  // enough for all there is to tell: readers of text take long
      if (both) await page.locator("#both").check();
      await mesh(page);
      const pairs = [];
      for (const ending of await page.locator("#format option").evaluateAll((all) => all.map(({ value }) => value))) {
        await page.selectOption("#format", ending);
        const [download] = await Promise.all([page.waitForEvent("download"), page.click("#save")]);
        const name = kZipped.has(ending) ? `mesh.${ending}.zip` : `mesh.${ending}`;
        assert.equal(download.suggestedFilename(), name);
        assert.equal(await page.textContent("#save-note") !== "", kZipped.has(ending));
        const saved = join(held.folder, name.replace("mesh", "saved"));
        await download.saveAs(saved);
        await runShown(page);
        pairs.push(saved, join(held.folder, `mesh.${ending}`));
      }
      assert.equal(pairs.length, 2 * 12);
      const told = execFileSync("/usr/bin/python3", [join(here, "compare_saved.py"), ...pairs], { encoding: "utf8" });
      for (const line of told.split("\n").filter(Boolean)) console.log(`# ${line}`);
      await expectTwins(page, "msh");
      assert.deepEqual(page.errors, []);
    });
  }

  it("shows the command line and the Python of a scene, which take nothing else", async () => {
    const page = await held.browser.open(held.server.url);
    await page.selectOption("#scene", "a bored block");
    await setSpacing(page, 1);
    await expectTwins(page, "vtu");
  });
});

part("Large", () => {
  const held = stage();
  // The worker counts the bytes of its arrays and of what the page has not given to the canvas yet.
  const kMostHeld = 2.5;

  const bytes = (page) => page.evaluate(() => {
    const { held, heldMost, received } = document.getElementById("canvas").dataset;
    return { held: Number(held), heldMost: Number(heldMost), received: Number(received) };
  });

  it("holds at most two and a half times what came of five million tets", async () => {
    const bunny = join(held.folder, "bunny.vdb");
    makeBunny(bunny);
    const page = await held.browser.open(held.server.url);
    const before = await held.browser.residentBytes();
    await page.setInputFiles("#file", bunny);
    await until(page, () => /tets/.test(document.getElementById("estimate").textContent));
    await setSpacing(page, -1.05);
    await mesh(page);
    const tets = Number((await page.textContent("#status")).match(/^[\d,]+/)[0].replace(/,/g, ""));
    assert.ok(tets > 5_000_000, `${tets} tets`);
    await drawn(page);
    const whole = await triangles(page), came = await bytes(page);
    await page.selectOption("#colour", "size");
    await page.selectOption("#cut-axis", "z");
    await until(page, (n) => Number(document.getElementById("canvas").dataset.triangles) !== n, whole);
    await drawn(page);
    const cut = await bytes(page);
    const turns = [];
    await page.locator("#canvas").focus();
    for (let i = 0; i < 3; ++i) {
      const frame = await page.evaluate(() => document.getElementById("canvas").dataset.frames);
      await page.keyboard.press("ArrowLeft");
      await until(page, (last) => document.getElementById("canvas").dataset.frames !== last, frame);
      turns.push(Number(await page.evaluate(() => document.getElementById("canvas").dataset.drawMs)));
    }
    const { calls, seconds, first } = await page.evaluate(() => ({ ...document.getElementById("canvas").dataset }));
    const grown = await held.browser.residentBytes() - before;
    console.log(`# ${tets} tets, ${whole} triangles outside, ${await triangles(page)} cut, in ${calls} call(s); ` +
      `first after ${first} s, all after ${seconds} s; turns take the page ` +
      `${Math.max(...turns)} ms at most; ${came.received} bytes came, ${came.held} are held, ` +
      `${came.heldMost} at most, ${cut.heldMost} with a cut: ${(cut.heldMost / cut.received).toFixed(2)}; ` +
      `the tab's process grew by ${grown}`);
    assert.equal(calls, "1");
    assert.ok(cut.heldMost <= kMostHeld * cut.received, `${cut.heldMost} of ${cut.received}`);
    assert.deepEqual(page.errors, []);
  });

  it("draws the surface alone of what is more than it may hold, and says so", async () => {
    const page = await held.browser.open(held.server.url + "?most_tets=1000");
    await chooseBall(page, held);
    await mesh(page);
    assert.match(await page.textContent("#alert"), /its surface alone is drawn/);
    const outside = Number((await page.textContent("#quality")).match(/([\d,]+) triangles outside/)[1].replace(/,/g, ""));
    assert.equal(await triangles(page), outside);
    assert.ok(await page.isDisabled("#cut-axis"));
    assert.ok(await page.isDisabled("#save"));
    await page.selectOption("#format", "stl");
    const [download] = await Promise.all([page.waitForEvent("download"), page.click("#save")]);
    assert.equal(readFileSync(await download.path()).readUInt32LE(80), outside);
  });
});
