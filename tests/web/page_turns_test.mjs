// What somebody does in the page before it is done with what was asked for last, and what the page does without.
//   TETSTREAM_BIN=build/release/bin PAGE_MODULES=$PWD/build/release/client/web/npm/ node tests/web/page_turns_test.mjs [PART...]
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { it } from "node:test";
import { HeldWire, holdCalls, kGenerousEnd, meshIs, until } from "./browser_case.mjs";
import { chooseBall, mesh, meshIsDone, part, setSpacing, stage, stl, triangles } from "./page_steps.mjs";

const areDisabled = (page) => page.evaluate(() => ["go", "submit"].map((id) => document.getElementById(id).disabled));
const outsideOf = async (page) =>
  Number((await page.textContent("#quality")).match(/([\d,]+) triangles outside/)[1].replace(/,/g, ""));

/**
 * In the page: keeps what the worker makes to be drawn, and notes the kinds of all that it tells. `isKept` says
 * whether there is any. `deliverOne` gives the page the first that is kept, and `deliver` all others and what comes from then on.
 */
function gateSurfaces() {
  const kept = [];
  let isGated = true;
  window.heard = [];
  window.Worker = class extends Worker {
    set onmessage(take) {
      super.onmessage = (event) => {
        window.heard.push(event.data.kind);
        if (isGated && event.data.kind === "surface") kept.push(() => take(event));
        else take(event);
      };
    }
  };
  window.isKept = () => kept.length > 0;
  window.deliverOne = () => kept.shift()();
  window.deliver = () => {
    isGated = false;
    for (const give of kept.splice(0)) give();
  };
}

/** Waits until the worker has all of the answer to a method. */
async function hasCome(page, method) {
  const isThere = (name) => performance.getEntriesByType("resource").some((entry) => entry.name.endsWith(name));
  for (const end = Date.now() + kGenerousEnd; !(await page.workers()[0].evaluate(isThere, method));) {
    assert.ok(Date.now() < end, `${method} has not come`);
    await new Promise((done) => setTimeout(done, 20));
  }
}

part("Turns", () => {
  const held = stage();

  it("draws the second of two meshes, although the first was whole and not yet drawn", async () => {
    const wire = await new HeldWire().start(held.server);
    const page = await held.browser.open(wire.url, { before: gateSurfaces });
    await chooseBall(page, held);
    await page.click("#go");
    await hasCome(page, "StreamMesh");  // its trailer waits in the worker until its first surface is drawn
    await until(page, () => window.isKept());  // the worker's next run begins by dropping what it had not made
    await setSpacing(page, -0.5);
    const estimated = (await page.textContent("#estimate")).match(/^[\d,]+ tets/)[0];
    wire.hold(2 ** 12);  // the header, and not all
    await page.click("#go");
    await until(page, () => window.heard.filter((kind) => kind === "header").length === 2);
    assert.ok(await page.evaluate(() => {
      window.deliverOne();
      return document.getElementById("canvas").dataset.triangles === undefined;
    }), "the first mesh's surface was drawn as the second's");
    await page.evaluate(() => window.deliver());
    wire.release();
    await meshIsDone(page);
    assert.ok((await page.textContent("#status")).startsWith(estimated), await page.textContent("#status"));
    assert.equal(await triangles(page), await outsideOf(page));
    assert.equal(await page.evaluate(() => window.heard.filter((kind) => kind === "trailer").length), 1);
    assert.deepEqual(page.errors, []);
    wire.close();
  });

  it("says why where the worker fails, and meshes with another", async () => {
    const page = await held.browser.open("about:blank");
    await page.route("**/assets/mesh_worker*", (route) => route.fulfill({
      contentType: "text/javascript", body: 'onmessage = () => { throw new Error("no room for it"); };' }));
    await page.goto(held.server.url);
    await page.selectOption("#scene", "a ball");
    await setSpacing(page, 1);
    await page.click("#go");
    await meshIs(page, "failed");
    assert.match(await page.textContent("#alert"), /What meshes in this page has failed: .*no room for it/);
    assert.ok(await page.isDisabled("#stop"));
    await page.unroute("**/assets/mesh_worker*");
    await mesh(page);
    assert.equal(await page.textContent("#alert"), "");
  });

  it("has the grids of what was chosen last, whichever answer comes first", async () => {
    const page = await held.browser.open(held.server.url);
    await chooseBall(page, held);
    const ball = await page.inputValue("#stored");
    await page.setInputFiles("#file", { name: "block.stl", mimeType: "model/stl", buffer: stl([4, 2, 1]) });
    await until(page, () => /of a surface/.test(document.getElementById("info").textContent) &&
      /tets/.test(document.getElementById("estimate").textContent));
    const block = await page.inputValue("#stored"), info = await page.textContent("#info");
    const command = await page.inputValue("#command");
    const calls = await holdCalls(page, "GridService/GetGridInfo");
    await page.selectOption("#stored", ball);
    const first = await calls.next();
    assert.deepEqual(await areDisabled(page), [true, true]);
    assert.equal(await page.locator("#grid option").count(), 0);
    await page.selectOption("#stored", block);
    const second = await calls.next();
    await second.route.continue();
    await until(page, () => /tets/.test(document.getElementById("estimate").textContent));
    await first.route.continue();
    await first.over;
    assert.equal(await page.textContent("#info"), info);
    assert.equal(await page.inputValue("#stored"), block);
    assert.match(await page.inputValue("#command"), new RegExp(command.match(/--spacing \S+/)[0]));
    assert.deepEqual(await areDisabled(page), [false, false]);
    // An answer that does not come leaves nothing of the choice before.
    await page.selectOption("#stored", ball);
    await (await calls.next()).route.abort();
    await until(page, () => /cannot be reached/.test(document.getElementById("alert").textContent));
    assert.deepEqual(await areDisabled(page), [true, true]);
    assert.equal(await page.locator("#grid option").count(), 0);
    assert.equal(await page.textContent("#info"), "");
    // And the same grid can be chosen again.
    assert.equal(await page.inputValue("#stored"), "");
    await calls.letGo();
    await page.selectOption("#stored", ball);
    await until(page, () => /tets/.test(document.getElementById("estimate").textContent));
    await mesh(page);
  });

  it("leaves the form as it is when a file is stored that nobody waits for any more", async () => {
    const page = await held.browser.open(held.server.url);
    const calls = await holdCalls(page, "GridService/GetUploadStatus");
    await page.setInputFiles("#file", held.ball);
    const { route } = await calls.next();
    await page.selectOption("#scene", "a ball");
    await until(page, () => /tets/.test(document.getElementById("estimate").textContent));
    await route.continue();
    await until(page, () => /is stored/.test(document.getElementById("uploads").textContent) &&
      document.querySelectorAll("#stored option").length > 1);
    const name = createHash("sha256").update(readFileSync(held.ball)).digest("hex");
    await until(page, (start) => document.getElementById("uploads").textContent.includes(
      `.vdb is stored. It is ${start}… of the stored grids`), name.slice(0, 12));
    assert.equal(await page.inputValue("#scene"), "a ball");
    assert.equal(await page.inputValue("#stored"), "");
    assert.ok(await page.locator(`#stored option[value="grids/${name}"]`).count() > 0);
    assert.deepEqual(page.errors, []);
  });

  it("makes one job of two clicks, and of a second try whose first got no answer", async () => {
    const page = await held.browser.open(held.server.url);
    const jobs = async () => (await (await fetch(`${held.server.url}v1/jobs`)).json()).jobs ?? [];
    await chooseBall(page, held);
    let asked = 0;
    page.on("request", (request) => (asked += Number(request.url().endsWith("JobService/CreateJob"))));
    const calls = await holdCalls(page, "JobService/CreateJob");
    await page.dblclick("#submit");
    const first = await calls.next();
    assert.equal(await page.isDisabled("#submit"), true);
    assert.equal(asked, 1);
    await first.route.fetch();  // the server has it, and nobody is told
    await first.route.abort();
    await until(page, () => /cannot be reached/.test(document.getElementById("alert").textContent));
    await page.click("#submit");
    await (await calls.next()).route.continue();
    await page.waitForSelector('#job-rows tr[data-state="succeeded"]');
    assert.equal((await jobs()).length, 1);
    // Whoever asks after an answer wants another.
    await page.click('nav a[href="#mesh"]');
    await page.click("#submit");
    await (await calls.next()).route.continue();
    await until(page, () => document.querySelectorAll('#job-rows tr').length === 2);
    assert.equal((await jobs()).length, 2);
  });
});

part("Waiting", () => {
  const held = stage(() => ["--job-workers", "0"]);

  it("asks for another job where that of a first try has ended in vain before the second", async () => {
    const page = await held.browser.open(held.server.url);
    const ask = async (path, method) => {
      const answer = await fetch(`${held.server.url}v1/${path}`, { method, headers: { "Content-Type": "application/json" } });
      assert.ok(answer.ok, await answer.clone().text());
      return answer.json();
    };
    const states = async () => (await ask("jobs", "GET")).jobs.map(({ state }) => state);
    await chooseBall(page, held);
    const calls = await holdCalls(page, "JobService/CreateJob");
    await page.click("#submit");
    const first = await calls.next();
    await first.route.fetch();  // the server has it, and nobody is told
    await first.route.abort();
    await until(page, () => /cannot be reached/.test(document.getElementById("alert").textContent));
    await ask(`${(await ask("jobs", "GET")).jobs[0].name}:cancel`, "POST");
    await page.click("#submit");
    await (await calls.next()).route.continue();
    await calls.letGo();
    await until(page, () => /^jobs.*: /.test(document.getElementById("status").textContent));
    assert.match(await page.textContent("#status"), /: queued$/);
    assert.deepEqual(await states(), ["JOB_STATE_QUEUED", "JOB_STATE_CANCELLED"]);
  });
});

/** In the page: a browser that draws with no graphics. */
function hideWebGl() {
  const other = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
    return /webgl/.test(kind) ? null : other.call(this, kind, ...more);
  };
}

part("Blind", () => {
  const held = stage();

  it("meshes, saves and lists without a picture where there is no WebGL 2, and says so", async () => {
    const page = await held.browser.open(held.server.url, { before: hideWebGl });
    await until(page, () => document.body.dataset.server);
    assert.match(await page.textContent("#alert"), /not shown: this browser has no WebGL 2/);
    await chooseBall(page, held);
    await mesh(page);
    assert.equal(await triangles(page), await outsideOf(page));
    await page.selectOption("#format", "stl");
    const [download] = await Promise.all([page.waitForEvent("download"), page.click("#save")]);
    assert.equal(readFileSync(await download.path()).readUInt32LE(80), await outsideOf(page));
    await page.click("#submit");
    await page.waitForSelector('#job-rows tr[data-state="succeeded"]');
    await page.click('nav a[href="#server"]');
    await until(page, () => /Calls so far/.test(document.getElementById("server-info").textContent));
    assert.match(await page.textContent("#alert"), /no WebGL 2/);
  });
});
