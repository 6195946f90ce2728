// The page as people use it, in a real browser against a real server.
//   TETSTREAM_BIN=build/release/bin PAGE_MODULES=$PWD/build/release/client/web/npm/ node tests/web/page_test.mjs [PART...]
// With PAGE_SCREENSHOTS=FOLDER the documents' pictures go there, and those to compare with are taken anew.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { it } from "node:test";
import { axeSource, binary, difference, drawn, HeldWire, kGenerousEnd, makeFixture, meshIs, until } from "./browser_case.mjs";
import { chooseBall, isDrawing, listInstead, makeBunny, mesh, meshIsDone, part, setSpacing, stage, stl, triangles } from "./page_steps.mjs";

part("Meshes", () => {
  const held = stage();

  it("draws a dropped file's mesh while it comes, and nothing leaves the host", async () => {
    const wire = await new HeldWire().start(held.server);
    const page = await held.browser.open(wire.url);
    const bytes = readFileSync(held.ball).toString("base64");
    const data = await page.evaluateHandle((text) => {
      const transfer = new DataTransfer();
      const content = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
      transfer.items.add(new File([content], "ball.vdb"));
      return transfer;
    }, bytes);
    await page.dispatchEvent("#drop", "drop", { dataTransfer: data });
    await until(page, () => /tets/.test(document.getElementById("estimate").textContent));
    const stored = await page.inputValue("#stored");
    assert.equal(stored, "grids/" + createHash("sha256").update(readFileSync(held.ball)).digest("hex"));
    assert.match(await page.textContent("#info"), /level set, [\d,]+ voxels of 0\.04/);
    await setSpacing(page, -0.5);
    const estimated = (await page.textContent("#estimate")).match(/^[\d,]+ tets/)[0];
    wire.hold(2 ** 19);  // of 1.6 MB
    await page.click("#go");
    await isDrawing(page);
    wire.release();
    await meshIsDone(page);
    assert.ok((await page.textContent("#status")).startsWith(estimated));
    const port = held.server.lines().find((line) => line.event === "serving").address.split(":").pop();
    assert.match(await page.inputValue("#command"), new RegExp(`--server 127\\.0\\.0\\.1:${port}$`));
    const early = await page.evaluate(() => Number(document.getElementById("canvas").dataset.progressive));
    assert.ok(early > 0, "no triangles were drawn before the trailer");
    assert.match(await page.textContent("#quality"), /Angles .* promised 11\.\d+° to 154\.\d+°/);
    const outside = Number((await page.textContent("#quality")).match(/([\d,]+) triangles outside/)[1].replace(/,/g, ""));
    assert.equal(await triangles(page), outside);
    assert.equal(await page.locator("#worst button").count(), 10);
    assert.equal(await page.locator("#histogram line").count(), 2);
    assert.match(await page.inputValue("#command"), /^tetstream mesh ball\.vdb -o mesh\.vtu --grid \S+ --spacing 0\.02/);
    for (const url of page.requested) assert.ok(url.startsWith(wire.url) || url.startsWith("blob:"), url);
    assert.deepEqual(page.errors, []);
    wire.close();
  });

  it("makes a solid of a dropped surface, or says why not", async () => {
    const page = await held.browser.open(held.server.url);
    const block = stl([4, 2, 1]), drop = (name, buffer) =>
      page.setInputFiles("#file", { name, mimeType: "model/stl", buffer });
    await drop("open.stl", stl([1, 1, 1], 2));
    await until(page, () => /the surface is not closed/.test(document.body.textContent));
    await drop("block.STL", block);
    await until(page, () => /of a surface: 8 vertices, 12 triangles/.test(document.getElementById("info").textContent));
    await setSpacing(page, 1);
    await mesh(page);
    assert.ok((await triangles(page)) > 1000);
    assert.match(await page.inputValue("#command"), /^tetstream mesh block\.STL -o mesh\.vtu --spacing/);
  });

  it("meshes a scene, and has it all again after a reload", async () => {
    const page = await held.browser.open(held.server.url);
    await chooseBall(page, held);
    await page.reload();
    await until(page, () => document.querySelectorAll("#stored option").length > 1);
    await page.selectOption("#scene", "a bored block");
    await setSpacing(page, 1);
    await mesh(page);
    assert.ok((await triangles(page)) > 1000);
  });

  it("cancels, and the server stops", async () => {
    const wire = await new HeldWire().start(held.server);
    const page = await held.browser.open(wire.url);
    await chooseBall(page, held);
    await setSpacing(page, -2);
    wire.hold(2 ** 22);  // of 36 MB, of which what lies between server and tab has room for half
    await page.click("#go");
    await isDrawing(page);
    await page.click("#stop", { force: true });
    await meshIs(page, "cancelled", "done", "failed");
    assert.equal(await page.evaluate(() => document.body.dataset.mesh), "cancelled");
    await held.server.says("call", (line) => line.method === "StreamMesh" && line.status === "CANCELLED");
    wire.release();
    await setSpacing(page, 0);
    await mesh(page);  // and it can go on
    wire.close();
  });
});

part("Cuts", () => {
  const held = stage();

  it("shows whole tets at a cut, and colours them", async () => {
    const page = await held.browser.open(held.server.url);
    await chooseBall(page, held);
    await mesh(page);
    const whole = await triangles(page);
    await page.selectOption("#cut-axis", "x");
    await until(page, (n) => Number(document.getElementById("canvas").dataset.triangles) !== n, whole);
    const half = await triangles(page);
    // Half of the surface, and the section, whose tets are larger.
    assert.ok(half > whole / 2 && half < whole * 1.5, `${half} of ${whole}`);
    await page.locator("#cut-at").fill("0");
    await until(page, () => Number(document.getElementById("canvas").dataset.triangles) === 0);
    await page.selectOption("#cut-axis", "");
    await until(page, (n) => Number(document.getElementById("canvas").dataset.triangles) === n, whole);
    for (const colour of ["level", "region", "angle"]) await page.selectOption("#colour", colour);
    await page.locator("#canvas").focus();
    await page.keyboard.press("ArrowLeft");
    // What the browser has a use for is its own.
    const isTaken = (key, more) => page.evaluate(([key, more]) => !document.getElementById("canvas").dispatchEvent(
      new KeyboardEvent("keydown", { key, cancelable: true, ...more })), [key, more]);
    assert.ok(await isTaken("+", {}));
    for (const modifier of ["ctrlKey", "metaKey", "altKey"]) {
      for (const key of ["+", "-", "ArrowLeft"]) assert.ok(!(await isTaken(key, { [modifier]: true })), `${modifier} ${key}`);
    }
    await page.locator("#worst button").first().click();
    assert.deepEqual(page.errors, []);
  });
});

part("Marks", () => {
  const held = stage();

  it("marks where the surface is no manifold", async () => {
    const rough = makeFixture(held.folder, "random-signs", 0.1);
    const wire = await new HeldWire().start(held.server);
    const page = await held.browser.open(wire.url);
    await page.setInputFiles("#file", rough);
    await until(page, () => /tets/.test(document.getElementById("estimate").textContent));
    await setSpacing(page, 1);
    await mesh(page);
    assert.match(await page.textContent("#quality"), /non-manifold spots/);
    await until(page, () => Number(document.getElementById("canvas").dataset.marks) > 0);
    // Of the surface, and of what marks it, which goes with the mesh.
    await until(page, () => Number(document.getElementById("canvas").dataset.geometries) > 1);
    wire.hold(0);
    await page.click("#go");
    await until(page, () => Number(document.getElementById("canvas").dataset.geometries) === 1);
    wire.release();
    await meshIsDone(page);
    await until(page, () => Number(document.getElementById("canvas").dataset.geometries) > 1);
    assert.deepEqual(page.errors, []);
    wire.close();
  });
});

part("Pictures", () => {
  const held = stage();

  // Another renderer may round otherwise; a change that anybody sees is ten times as much.
  const kMostDifference = 12;
  const pictures = join(import.meta.dirname ?? new URL(".", import.meta.url).pathname, "pictures");

  it("draws what it drew when the pictures were kept", async () => {
    const page = await held.browser.open(held.server.url, { deviceScaleFactor: 1 });
    await chooseBall(page, held);
    await mesh(page);
    const taken = {};
    const look = async (name) => {
      await drawn(page);
      taken[name] = await page.locator("#canvas").screenshot();
      if (process.env.PAGE_SCREENSHOTS) writeFileSync(join(pictures, `${name}.png`), taken[name]);
    };
    await look("whole");
    const whole = await triangles(page);
    await page.selectOption("#colour", "size");
    await page.selectOption("#cut-axis", "x");
    await until(page, (n) => Number(document.getElementById("canvas").dataset.triangles) !== n, whole);
    await look("cut");
    for (const [name, picture] of Object.entries(taken)) {
      const apart = await difference(page, picture, readFileSync(join(pictures, `${name}.png`)));
      assert.ok(apart <= kMostDifference, `${name} is ${apart} away from what is kept in ${pictures}`);
    }
    assert.ok(await difference(page, taken.whole, taken.cut) > 2 * kMostDifference, "this would notice nothing");
  });
});

part("Bunny", () => {
  const held = stage();

  it("draws a scan of three quarters of a million tets, and cuts it", async () => {
    const bunny = join(held.folder, "bunny.vdb");
    makeBunny(bunny);
    const page = await held.browser.open(held.server.url);
    await page.setInputFiles("#file", bunny);
    await page.locator("#levels").fill("24");
    await until(page, () => /tets/.test(document.getElementById("estimate").textContent));
    await mesh(page);
    const tets = Number((await page.textContent("#status")).match(/^[\d,]+/)[0].replace(/,/g, ""));
    const told = execFileSync(binary("tetstream"), ["estimate", bunny, "--levels", "24"], { encoding: "utf8" });
    assert.equal(tets, Number(told.match(/(\d+) tets/)[1]));
    assert.ok(tets > 700_000, `${tets} tets`);
    const whole = await triangles(page);
    await page.selectOption("#colour", "size");
    await page.selectOption("#cut-axis", "z");
    await until(page, (n) => Number(document.getElementById("canvas").dataset.triangles) !== n, whole);
    await drawn(page);
    const data = await page.evaluate(() => ({ ...document.getElementById("canvas").dataset }));
    console.log(`# ${tets} tets; first triangles after ${data.first} s, all after ${data.seconds} s; ` +
      `${data.drawn} triangles in ${data.calls} call(s), ${data.drawMs} ms of the page's thread; ` +
      `${data.received} bytes came, ${data.heldMost} held at most`);
    const begun = performance.now();
    execFileSync("/bin/sh", ["-c", await page.inputValue("#command")], { cwd: held.folder, stdio: "ignore",
      env: { ...process.env, PATH: `${process.env.TETSTREAM_BIN}:${process.env.PATH}` } });
    console.log(`# the command line takes ${((performance.now() - begun) / 1e3).toFixed(2)} s, and writes a file`);
    assert.equal(data.calls, "1");
    assert.deepEqual(page.errors, []);
    if (process.env.PAGE_SCREENSHOTS) {
      writeFileSync(join(process.env.PAGE_SCREENSHOTS, "page_bunny.png"), await page.screenshot());
    }
  });
});

part("Lives", () => {
  const held = stage();

  it("follows a job from its queue to its mesh", async () => {
    const page = await held.browser.open(held.server.url);
    await chooseBall(page, held);
    await page.click("#submit");
    const row = page.locator("#job-rows tr").first();
    await page.waitForSelector('#job-rows tr[data-state="succeeded"]');
    await row.getByRole("button", { name: /^Look/ }).click();
    await meshIs(page, "done");
    assert.ok((await triangles(page)) > 0);
    await page.click('nav a[href="#jobs"]');
    const [download] = await Promise.all([
      page.waitForEvent("download"), row.getByRole("button", { name: /^Fetch/ }).click()]);
    assert.ok(readFileSync(await download.path(), "latin1").startsWith("<?xml"));
    await page.click('nav a[href="#jobs"]');
    await page.locator("#job-label").fill("no=such");
    await until(page, () => document.querySelectorAll("#job-rows tr").length === 0);
    await page.locator("#job-label").fill("");
    await row.getByRole("button", { name: /^Delete/ }).click();
    await until(page, () => document.querySelectorAll("#job-rows tr").length === 0);
  });

  it("names the workers, and the shards that they have leased", async () => {
    // Counted for longer than the table takes to be drawn anew.
    const grid = readFileSync(makeFixture(held.folder, "random-signs", 1));
    const sha256 = createHash("sha256").update(grid).digest("hex");
    const ask = async (path, options) => {
      const answer = await fetch(`${held.server.url}v1/${path}`,
        { headers: { "Content-Type": "application/json" }, ...options });
      assert.ok(answer.ok, await answer.clone().text());
      return answer.json();
    };
    await ask(`grids/${sha256}`, { method: "PUT", body: grid, headers: {} });
    const job = await ask("jobs", { method: "POST",
      body: JSON.stringify({ job: { mesh: { name: `grids/${sha256}`, spacing: 0.075 } } }) });
    const page = await held.browser.open(held.server.url + "#server");
    await until(page, () => document.querySelector("#workers details"));
    await page.locator("#workers summary").focus();
    await page.keyboard.press("Enter");
    await page.evaluate(() => new Promise((told) =>
      new MutationObserver(told).observe(document.getElementById("workers"), { childList: true, subtree: true })));
    assert.ok(await page.evaluate(() => document.activeElement.matches("#workers details[open] summary")), "it stays open and has the focus");
    const line = await page.textContent("#workers tr");
    // Whether it counts by itself or in blocks is the server's affair.
    assert.match(line, new RegExp(`:${held.server.process.pid}\\d+works\\d+ s ago(\\d), of your jobs \\1\\s*` +
      `${job.name.slice(5)}: (its count|\\d+ to \\d+)`));
    await ask(`${job.name}:cancel`, { method: "POST" });
    await until(page, () => !document.querySelector("#workers details"));
    assert.deepEqual(page.errors, []);
  });

  it("shows a job's shards as a bar: done, with a worker, waiting, and dropped once it is cancelled", async () => {
    const page = await held.browser.open(held.server.url);
    await chooseBall(page, held);
    await page.click('nav a[href="#jobs"]');
    const name = await page.inputValue("#stored");
    // Hundreds of millions of tets: it is far from its end when the first shards are.
    const answer = await fetch(`${held.server.url}v1/jobs`, { method: "POST", headers: { "Content-Type": "application/json" },
      body: JSON.stringify({ job: { displayName: "long", mesh: { name, spacing: 0.006, levels: 0 } } }) });
    const job = await answer.json();
    assert.ok(answer.ok, JSON.stringify(job));
    const row = page.locator(`#job-rows tr[data-job="${job.name}"]`);
    const kinds = () => row.locator(".shards > span").evaluateAll((parts) =>
      Object.fromEntries(parts.map((part) => [part.className, Number(part.dataset.shards)])));
    await until(page, (job) => {
      const bar = document.querySelector(`#job-rows tr[data-job="${job}"] .shards`);
      return bar?.querySelector(".done") && bar.querySelector(".waiting") && !/counting/.test(bar.parentElement.textContent);
    }, job.name);
    // The row is told anew meanwhile, and its button stays: neither a press nor the focus is lost.
    await row.getByRole("button", { name: /^Cancel/ }).focus();
    await until(page, ([job, before]) => document.querySelector(`#job-rows tr[data-job="${job}"]`).textContent !== before,
      [job.name, await row.textContent()]);
    await page.keyboard.press("Enter");
    await page.waitForSelector(`#job-rows tr[data-job="${job.name}"][data-state="cancelled"]`);
    const told = await (await fetch(`${held.server.url}v1/${job.name}`)).json();
    await until(page, (job) => document.querySelector(`#job-rows tr[data-job="${job}"] .shards > .dropped`), job.name);
    const shown = await kinds();
    assert.equal(shown.done, Number(told.progress.doneShards));
    assert.equal(Object.values(shown).reduce((sum, shards) => sum + shards, 0), Number(told.progress.shardCount));
    const bar = row.locator(".shards");
    assert.match(await bar.getAttribute("aria-label"), /^Shards of long: [\d,]+ done, .*[\d,]+ dropped$/);
    const widths = await bar.locator("span").evaluateAll((parts) => parts.map((part) => part.getBoundingClientRect().width));
    assert.ok(widths.every((width) => width > 0) && widths.at(-1) > widths[0], `${widths}`);
    await row.getByRole("button", { name: /^Delete/ }).click();
    await page.waitForSelector(`#job-rows tr[data-job="${job.name}"]`, { state: "detached" });
    assert.deepEqual(page.errors, []);
  });

  it("plots the hour before anybody looked, as the server kept it", async () => {
    const page = await held.browser.open(held.server.url);
    const minutes = async () => Number(await page.getAttribute("#plots", "data-minutes"));
    // What this server says of itself, as if it had said so for an hour.
    let families;
    await page.route("**/metrics/history**", async (route) => {
      families = new URL(route.request().url()).searchParams.get("names");
      const history = await (await route.fetch()).json();
      assert.ok(history.seconds_ago.length > 0 && Object.keys(history.samples).length > 0, JSON.stringify(history));
      const often = Array.from({ length: 240 }, (_, i) => i);
      history.seconds_ago = often.map((i) => (240 - i) * 15);
      for (const [name, values] of Object.entries(history.samples)) {
        history.samples[name] = often.map((i) => name === "tetstream_sent_tets_total" ? i * 1500 : values.at(-1));
      }
      await route.fulfill({ json: history });
    });
    await page.click('nav a[href="#server"]');
    await until(page, () => /Calls so far/.test(document.getElementById("server-info").textContent));
    assert.equal(await minutes(), 60);
    assert.match(families, /(^|,)tetstream_job_shards(,|$)/);
    assert.equal(await page.locator("#plots .uplot").count(), 9);
    // Another view, and back: it is asked for anew, and nothing is there twice.
    await page.unroute("**/metrics/history**");
    await page.click('nav a[href="#jobs"]');
    await page.click('nav a[href="#server"]');
    await until(page, () => Number(document.getElementById("plots").dataset.minutes) < 60);
    assert.deepEqual(page.errors, []);
  });

  it("draws its plots in the colours of the moment, and as wide as there is room", async () => {
    const page = await held.browser.open(held.server.url + "#server", { deviceScaleFactor: 1 });
    await until(page, () => /Calls so far/.test(document.getElementById("server-info").textContent));
    /** How bright the numbers beside a plot's axes are: they are grey, and less transparent than the axes' lines. */
    const brightness = () => page.evaluate(() => {
      const canvas = document.querySelector("#plots canvas");
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      let sum = 0, weight = 0;
      for (let i = 0; i < data.length; i += 4) {
        const [red, green, blue, opacity] = data.subarray(i, i + 4);
        if (opacity < 120 || Math.max(red, green, blue) - Math.min(red, green, blue) > 40) continue;
        sum += red;
        ++weight;
      }
      return weight > 0 ? sum / weight : -1;
    });
    const reaches = async (isSo) => {
      const end = Date.now() + kGenerousEnd;
      while (!isSo(await brightness())) assert.ok(Date.now() < end, `${await brightness()}`);
    };
    await reaches((now) => now > 180);
    await page.emulateMedia({ colorScheme: "light" });
    await reaches((now) => now >= 0 && now < 80);
    assert.equal(await page.locator("#plots .uplot").count(), 9);
    for (const width of [390, 1000]) {
      await page.setViewportSize({ width, height: 844 });
      await until(page, () => [...document.querySelectorAll("#plots .plot")].every((box) =>
        Math.abs(box.clientWidth - 16 - box.querySelector(".uplot").clientWidth) <= 1));
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${width}`);
    }
    assert.deepEqual(page.errors, []);
  });

  it("lists all stored grids", async () => {
    // Pages of one: the page asks for a thousand, and the number is as many bytes as it was.
    const page = await held.browser.open("about:blank");
    await page.route("**/tetstream.v1.GridService/ListGrids", (route) => {
      const body = route.request().postDataBuffer();
      const at = body.indexOf(Buffer.from([0x08, 0xe8, 0x07]));  // page_size = 1000
      assert.ok(at > 0, body.toString("hex"));
      body.set([0x81, 0x00], at + 1);  // 1
      return route.continue({ postData: body });
    });
    const put = async (bytes) => {
      const sha256 = createHash("sha256").update(bytes).digest("hex");
      const answer = await fetch(`${held.server.url}v1/grids/${sha256}`, { method: "PUT", body: bytes });
      assert.ok(answer.ok, await answer.text());
      return `grids/${sha256}`;
    };
    const grids = await Promise.all([stl([1, 1, 1]), stl([1, 1, 2]), stl([1, 1, 3])].map(put));
    await page.goto(held.server.url);
    await until(page, (names) => names.every((name) => document.querySelector(`#stored option[value="${name}"]`)), grids);
    assert.deepEqual(page.errors, []);
  });

  it("lists 200 jobs and workers, however few an answer has, and older jobs when they are asked for", async () => {
    const page = await held.browser.open("about:blank");
    const names = (count) => Array.from({ length: count }, (_, i) => `jobs/${String(900 - i).padStart(24, "0")}`);
    const rows = (table, count) => until(page, ([table, count]) =>
      document.querySelectorAll(`#${table} tr`).length === count, [table, count]);
    await page.route("**/tetstream.v1.JobService/WatchJobs", () => {});  // nothing happens
    await listInstead(page, "JobService/ListJobs", 2, names(405), 90);
    await page.goto(held.server.url + "#jobs");
    for (const count of [200, 400]) {
      await rows("job-rows", count);
      assert.match(await page.textContent("#older"), new RegExp(`${count} jobs are listed, and there are older ones`));
      await page.click("#older-jobs");
    }
    await rows("job-rows", 405);
    await until(page, () => document.getElementById("older").hidden);
    const shown = await page.locator("#job-rows tr").evaluateAll((lines) => lines.map((line) => line.dataset.job));
    assert.deepEqual(shown, names(405));

    await listInstead(page, "JobService/ListWorkers", 1, ["one", "two"], 1);
    await page.click('nav a[href="#server"]');
    await until(page, () => document.querySelectorAll("#workers tr").length > 0);
    await rows("workers", 2);
    await listInstead(page, "JobService/ListWorkers", 1, names(201), 150);
    await rows("workers", 201);
    assert.match(await page.locator("#workers tr").last().textContent(), /^and more than these 200/);
    assert.deepEqual(page.errors, []);
  });

  it("finds a server again that was killed", async () => {
    const wire = await new HeldWire().start(held.server);
    const meshing = await held.browser.open(wire.url);
    await chooseBall(meshing, held);
    const page = await held.browser.open(wire.url + "#jobs");
    await until(page, () => document.getElementById("watch-state").textContent === "live");
    await held.server.kill();
    await until(page, () => /cannot be reached|broke/.test(document.getElementById("watch-state").textContent));
    await meshing.locator("#spacing").fill("1");
    await until(meshing, () => /cannot be reached/.test(document.getElementById("estimate").textContent));
    await held.server.start();
    await mesh(meshing);  // which needs nothing but the button
    await until(page, () => document.getElementById("watch-state").textContent === "live");
    await page.click('nav a[href="#server"]');
    await until(page, () => /Calls so far/.test(document.getElementById("server-info").textContent));
    assert.equal(await page.locator("#plots .uplot").count(), 9);
    wire.close();
  });
});

part("Refusals", () => {
  let token;
  const held = stage((folder) => {
    const entry = join(folder, "tokens.toml");
    const made = execFileSync("sh", ["-c", `umask 077; "$0" --new-token alice 2>&1 >"$1"`, binary("tetstreamd"), entry],
      { encoding: "utf8" });
    token = made.trim().split("\n").pop();
    return ["--tokens", entry];
  });

  it("asks for a token, says that one is wrong, and takes the right one", async () => {
    const page = await held.browser.open(held.server.url);
    await until(page, () => /token into the field/.test(document.getElementById("alert").textContent));
    await page.fill("#token", "wrong");
    await page.keyboard.press("Enter");
    await until(page, () => /not known/.test(document.getElementById("alert").textContent));
    await page.fill("#token", token);
    await page.keyboard.press("Enter");
    await until(page, () => document.body.dataset.server && !document.getElementById("alert").textContent);
    await chooseBall(page, held);
    await setSpacing(page, 1);
    await mesh(page);
    await page.click('nav a[href="#server"]');
    await until(page, () => /needs the scope workers\.read/.test(document.getElementById("workers").textContent));
    assert.equal((await page.context().cookies()).length, 0);
    assert.equal(await page.evaluate(() => localStorage.length + sessionStorage.length), 0);
  });
});

part("Looks", () => {
  const held = stage();

  for (const [name, options] of [
    ["dark", { colorScheme: "dark" }],
    ["light", { colorScheme: "light" }],
    ["phone", { colorScheme: "dark", viewport: { width: 390, height: 844 } }]]) {
    it(`is accessible and in place: ${name}`, async () => {
      const page = await held.browser.open(held.server.url, options);
      await chooseBall(page, held);
      if (!process.env.PAGE_SCREENSHOTS) await setSpacing(page, 1);
      await mesh(page);
      await page.selectOption("#colour", "size");
      for (const view of ["mesh", "jobs", "server"]) {
        await page.click(`nav a[href="#${view}"]`);
        await page.waitForSelector(`#${view}:not([hidden])`);
        const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
        assert.ok(wide <= 0, `${view} is ${wide} pixels too wide`);
        await page.evaluate(axeSource);
        const found = await page.evaluate(() => axe.run({ resultTypes: ["violations"] }));
        assert.deepEqual(found.violations.map((v) => [v.id, v.nodes.map((n) => n.html)]), [], view);
      }
      await page.click('nav a[href="#mesh"]');
      if (process.env.PAGE_SCREENSHOTS) {
        mkdirSync(process.env.PAGE_SCREENSHOTS, { recursive: true });
        writeFileSync(join(process.env.PAGE_SCREENSHOTS, `page_${name}.png`), await page.screenshot());
      }
    });
  }
});
