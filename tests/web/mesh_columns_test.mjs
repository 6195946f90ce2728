// What the page's worker makes of chunks, without a browser: a cube of known volume, its surface, cuts and files.
//   PAGE_MODULES=$PWD/build/release/client/web/npm/ node tests/web/mesh_columns_test.mjs
import assert from "node:assert/strict";
import { File } from "node:buffer";
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, afterEach, before, beforeEach, describe, it, mock } from "node:test";
import { pathToFileURL } from "node:url";

const modules = process.env.PAGE_MODULES;
const here = import.meta.dirname ?? new URL(".", import.meta.url).pathname;
const folder = mkdtempSync(join(tmpdir(), "tetstream-columns-"));
let page;
let build;

before(async () => {
  ({ build } = createRequire(join(modules, "package.json"))("esbuild"));
  const outfile = join(folder, "page.mjs");
  await build({
    stdin: { resolveDir: join(modules, "src"), loader: "ts", contents: `
      export { create, toBinary } from "@bufbuild/protobuf";
      export * from "../generated/tetstream/v1/meshes_pb";
      export { TetMesh } from "./tet_mesh";
      export { twinsOf } from "./twins";
      export { upload } from "./upload";
      export { GroupedTets, tetGroups } from "./tet_groups";
      export * from "../generated/tetstream/v1/grids_pb";
      export { levelOf } from "./tet_shape";
      export { FaceSet } from "./face_set";
      export { Tally } from "./tally";
      export { fileOf } from "./save";
      export { fileNameOf, kFormats } from "./formats";
      export { FileParts } from "./file_parts";
      export { Hdf5Group, writeHdf5 } from "./hdf5";
      export { NetcdfFile } from "./netcdf";
      export { shortFloat32, textOf } from "./file_parts";
      export { columnNames, namesInFile, shortNames } from "./file_names";
      export { bytesOf } from "./drawing";` },
    bundle: true, platform: "node", format: "esm", outfile, logLevel: "error" });
  globalThis.location = { protocol: "https:", hostname: "farm.example" };  // where the page came from
  page = await import(pathToFileURL(outfile));
});
after(() => rmSync(folder, { recursive: true }));

const kSide = 10;
const bytes = (array) => new Uint8Array(array.buffer);

/** Positions of a cube's grid and six tets a cell, and which half each tet is in: 1 or 2. */
function cube() {
  const n = kSide, points = [], tets = [], halves = [];
  const id = ([i, j, k]) => (k * (n + 1) + j) * (n + 1) + i;
  for (let k = 0; k <= n; ++k) for (let j = 0; j <= n; ++j) for (let i = 0; i <= n; ++i) points.push(i / n, j / n, k / n);
  for (let cell = 0; cell < n ** 3; ++cell) {
    const from = [cell % n, Math.floor(cell / n) % n, Math.floor(cell / n ** 2)];
    for (const [x, order] of [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]].entries()) {
      const at = [...from], corners = [id(at)];
      for (const axis of order) {
        ++at[axis];
        corners.push(id(at));
      }
      if (x >= 3) [corners[2], corners[3]] = [corners[3], corners[2]];  // positive
      tets.push(...corners);
      halves.push(from[0] < n / 2 ? 1 : 2);
    }
  }
  return { points, tets, halves };
}

const kChunks = 4;

/**
 * The cube as a header and some chunks: of one side, of both, with labels, or of two grids. `names` are put in place of the
 * header's own.
 */
function messagesOf(kind, names = {}) {
  const { points, tets, halves } = cube();
  const vertices = points.length / 3, count = tets.length / 4;
  const header = page.create(page.MeshHeaderSchema, {
    vertexCount: BigInt(vertices), tetCount: BigInt(count), chunkCount: BigInt(kChunks),
    coordinateType: page.CoordinateType.FLOAT32, indexType: page.IndexType.UINT32,
    origin: { x: 10, y: 0, z: 0 }, spacing: 1 / kSide,
    bounds: { min: { x: 10, y: 0, z: 0 }, max: { x: 11, y: 1, z: 1 } }, hasRegions: kind === "regions",
    labels: kind === "labels" ? [{ value: 4n, name: "bone" }, { value: 7n, name: "" }] : [],
    parts: kind !== "parts" ? [] : ["low", "high"].map((name, i) =>
      ({ name, firstTet: BigInt((count / 2) * i), tetCount: BigInt(count / 2) })),
    fields: [{ name: "heat", components: 1 }, { name: "flow", components: 3 }], ...names });
  const chunks = Array.from({ length: kChunks }, (_, c) => {
    const [v, nextV] = [c, c + 1].map((i) => Math.floor((vertices * i) / kChunks));
    const [t, nextT] = [c, c + 1].map((i) => Math.floor((count * i) / kChunks));
    const labels = halves.slice(t, nextT);
    const fields = Float32Array.from({ length: (nextV - v) * 4 }, (_, i) => v + i / 4);
    return page.create(page.MeshChunkSchema, {
      index: BigInt(c), firstVertex: BigInt(v), vertexCount: BigInt(nextV - v), firstTet: BigInt(t), tetCount: BigInt(nextT - t),
      positions: bytes(Float32Array.from(points.slice(3 * v, 3 * nextV))), fields: bytes(fields),
      tets: bytes(Uint32Array.from(tets.slice(4 * t, 4 * nextT))),
      regions: kind === "regions" ? Uint8Array.from(labels)
        : kind === "labels" ? bytes(Uint16Array.from(labels, (half) => half - 1)) : new Uint8Array() });
  });
  return { header, chunks };
}

/** The cube as a mesh; `each` is called after every chunk. */
function meshOf(kind, each = () => {}, names = {}) {
  const { header, chunks } = messagesOf(kind, names);
  const mesh = new page.TetMesh(header, Infinity);
  for (const chunk of chunks) {
    mesh.add(chunk);
    each(mesh);
  }
  mesh.finish();
  return mesh;
}

function areaOf({ corners, places, triangles }) {
  let area = 0;
  for (let t = 0; t < triangles; ++t) {
    const [a, b, c] = [0, 1, 2].map((k) => [0, 1, 2].map((axis) => places[corners[3 * t + k] * 3 + axis]));
    const u = b.map((x, axis) => x - a[axis]), v = c.map((x, axis) => x - a[axis]);
    area += Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
  }
  return area;
}

function about(value, wanted) {
  assert.ok(Math.abs(value - wanted) < 1e-5, `${value} is not ${wanted}`);
}

describe("a mesh in the worker", () => {
  it("draws what is there while chunks come, and its surface when it is whole", () => {
    const sofar = [];
    const mesh = meshOf("plain", (growing) => {
      const surface = growing.surface("size", { axis: 0, at: 0.5 });  // neither yet
      growing.tally.drop(page.bytesOf(surface));
      sofar.push(surface.triangles);
    });
    assert.ok(sofar.every((triangles) => triangles > 0), String(sofar));
    const surface = mesh.surface("none");
    assert.equal(surface.triangles, 6 * 2 * kSide ** 2);
    about(areaOf(surface), 6);
    assert.equal(mesh.seams().length, 0);
    assert.equal(mesh.findWorst().length, 10);
    assert.equal(mesh.findWorst()[0].angle.toFixed(3), "45.000");
  });

  it("cuts between whole tets, in every colour", () => {
    const mesh = meshOf("regions");
    for (const colour of ["none", "size", "angle", "region", "level", "field"]) {
      const surface = mesh.surface(colour, { axis: 0, at: 0.52 });
      about(areaOf(surface), 2 + 4 * 0.5);
      mesh.tally.drop(page.bytesOf(surface));
    }
    const whole = mesh.surface("region");
    assert.deepEqual(new Set(whole.paints.subarray(0, whole.triangles)), new Set([0, 254]));
    assert.equal(mesh.surface("none", { axis: 1, at: -1 }).triangles, 0);
  });

  it("counts every byte that it holds, and gives back what a drawing took", () => {
    const mesh = meshOf("labels");
    const own = mesh.tally.now;
    for (const colour of ["none", "size", "angle", "region", "level", "field"]) {
      for (const cut of [undefined, { axis: 2, at: 0.3 }]) {
        const surface = mesh.surface(colour, cut);
        assert.equal(mesh.tally.now, own + page.bytesOf(surface));
        mesh.tally.drop(page.bytesOf(surface));
      }
    }
    mesh.findWorst();
    mesh.seams();
    assert.equal(mesh.tally.now, own);
    // Chunks as they came, and four bytes a face outside.
    let came = 0;
    mesh.store.forEach((c) => (came += c.positions.byteLength + c.tets.byteLength + c.groups.byteLength + c.fields.byteLength));
    assert.equal(own, came + 4 * mesh.surfaceTriangles);
  });

  it("tells the octree's level of a tet", () => {
    const lattice = [0, 0, 0, 1, 0, 0, 0.5, 0.5, 0.5, 0.5, 0.5, -0.5];  // between two centres
    const pyramid = [0, 0, 0, 1, 0, 0, 1, 1, 0, 0.5, 0.5, 0.5];  // half of one
    for (const tet of [lattice, pyramid]) {
      for (const level of [0, 1, 5]) {
        const grown = Float32Array.from(tet, (x) => x * 0.3 * 2 ** level);
        assert.equal(page.levelOf(grown, [0, 1, 2, 3], 0, 0.3), level);
      }
    }
  });

  it("saves files that others read, of every kind", async () => {
    const kinds = ["plain", "regions", "labels", "parts"];
    for (const kind of kinds) {
      const mesh = meshOf(kind);
      for (const format of page.kFormats) {
        const blob = page.fileOf(mesh, format.ending);
        const name = page.fileNameOf(format).replace("mesh", kind);
        writeFileSync(join(folder, name), Buffer.from(await blob.arrayBuffer()));
      }
    }
    // All at once: the readers take a second to load.
    execFileSync("/usr/bin/python3", [join(here, "saved_cube.py"), folder, ...kinds], { stdio: ["ignore", "ignore", "inherit"] });
  });
});

describe("a file of columns", () => {
  const bytesOfFile = async (write) => {
    const file = new page.FileParts();
    write(file);
    return Buffer.from(await file.blob().arrayBuffer());
  };

  it("of HDF5 has as many members and groups as there are", async () => {
    const root = new page.Hdf5Group(), many = root.group("many"), deep = many.group("a group").group("in it");
    for (let i = 0; i < 300; ++i) many.number(`größe ${i}`, i);
    deep.integers("numbers", [-1, 2 ** 40]);
    deep.text("text", "of a length");
    for (const [type, array] of [["u8", Uint8Array], ["i32", Int32Array], ["f32", Float32Array], ["f64", Float64Array]]) {
      deep.column(type, type, [3, 1], (file) => file.bytes(array.of(1, 2, 250)));
    }
    const path = join(folder, "many.h5");
    writeFileSync(path, await bytesOfFile((file) => page.writeHdf5(file, root)));
    execFileSync("/usr/bin/python3", ["-c", `
import h5py, sys
with h5py.File(sys.argv[1]) as file:
    many = file["many"]
    assert sorted(many) == sorted(["a group"] + [f"größe {i}" for i in range(300)])
    assert all(many[f"größe {i}"][0] == i for i in range(300))
    deep = many["a group/in it"]
    assert list(deep.attrs["numbers"]) == [-1, 2**40] and deep.attrs["text"] == b"of a length"
    for name, dtype in (("u8", "<u1"), ("i32", "<i4"), ("f32", "<f4"), ("f64", "<f8")):
        assert deep[name].dtype == dtype and deep[name][()].tolist() == [[1], [2], [250]]
`, path], { stdio: ["ignore", "ignore", "inherit"] });
  });

  it("of netCDF has room for columns beyond two gigabytes, and is refused where it is not whole", async () => {
    const fileOf = (numbers, write) => bytesOfFile((file) => {
      const made = new page.NetcdfFile();
      made.variable("x", "double", [made.dimension("n", numbers)], write);
      made.write(file);
    });
    await assert.rejects(fileOf(2, (file) => file.bytes(new Float64Array(1))), /x of a netCDF file is not whole/);
    const small = await fileOf(1, (file) => file.bytes(new Float64Array(1)));
    assert.equal(small.toString("latin1", 0, 4), "CDF\x02");
    assert.equal(Number(small.readBigUInt64BE(small.length - 16)), small.length - 8);
    // Its numbers are counted, not made.
    const large = await fileOf(2 ** 29, (file) => (file.size += 2 ** 32));
    assert.equal(large.toString("latin1", 0, 4), "CDF\x05");
    assert.deepEqual([16, 8].map((back) => Number(large.readBigUInt64BE(large.length - back))), [2 ** 32, large.length]);
  });
});

describe("a set of faces", () => {
  it("has those that came once, whichever way they were wound", () => {
    const tally = new page.Tally();
    const faces = new page.FaceSet(tally), there = new Map();
    let seed = 1;
    const random = (end) => (seed = (Math.imul(seed, 1103515245) + 12345) >>> 0, (seed >>> 8) % end);
    for (let i = 0; i < 300_000; ++i) {
      const face = [random(90), 90 + random(90), 180 + random(50)];
      const key = String(face);
      const turned = random(2) ? face : [face[0], face[2], face[1]];
      for (let turn = random(3); turn > 0; --turn) turned.push(turned.shift());
      assert.equal(faces.toggle(...turned, i), there.get(key) ?? -1);
      if (!there.delete(key)) there.set(key, i);
    }
    assert.equal(faces.count, there.size);
    const seen = new Map();
    faces.forEach((a, b, c, number) => seen.set(String([a, b, c].sort((x, y) => x - y)), number));
    assert.deepEqual(seen, there);
    // Tables that grow one by one, and are four fifths full then.
    assert.ok(tally.most < 30 * faces.count, `${tally.most} bytes for ${faces.count} faces`);
    faces.free();
    assert.equal(tally.now, 0);
  });

  it("takes none once it is freed, and does not look for a place for it for ever", () => {
    const faces = new page.FaceSet(new page.Tally());
    faces.toggle(1, 2, 3, 0);
    faces.free();
    assert.throws(() => faces.toggle(1, 2, 3, 0), /a face came after the set of faces was freed/);
    assert.equal(faces.count, 0);
  });
});

describe("the worker", () => {
  let told, answers;

  before(async () => {
    const outfile = join(folder, "worker.mjs");
    await build({ entryPoints: [join(modules, "src/mesh_worker.ts")], bundle: true, platform: "node", format: "esm", outfile,
      logLevel: "error" });
    globalThis.self = { postMessage: (message) => told.push(message) };
    globalThis.fetch = async (_url, { signal }) => new Response(new ReadableStream({
      start: (answer) => {
        answers.push(answer);
        signal.addEventListener("abort", () => answer.error(signal.reason));
      } }));
    await import(pathToFileURL(outfile));
  });
  beforeEach(() => ((told = []), (answers = [])));

  // What has come is drawn a quarter of a second after the last time: by a clock that stands still, never, and
  // otherwise when the machine is slow.
  let clock;
  before(() => (clock = mock.method(performance, "now", () => 0)));
  after(() => clock.mock.restore());

  const order = (run, kind, more = {}) => self.onmessage({ data: { run, kind, ...more } });
  const start = (run) => order(run, "start", { method: "MeshService/StreamMesh", request: new Uint8Array(), token: "", mostTets: 1e9 });

  const kGenerousMs = 900_000;

  /** Waits until something is so, and returns it. */
  async function comes(what, look) {
    for (const end = Date.now() + kGenerousMs; ;) {
      const found = look();
      if (found) return found;
      assert.ok(Date.now() < end, `${what} never came; told: ${told.map(({ run, kind }) => `${run} ${kind}`)}`);
      await new Promise((done) => setImmediate(done));
    }
  }

  /** Waits until the worker has told something of a run. */
  const says = (run, kind) => comes(`${kind} of ${run}`, () => told.find((one) => one.run === run && one.kind === kind));

  /** Waits until the worker has an answer's stream, and gives it events. */
  async function send(number, ...events) {
    await comes(`call ${number}`, () => answers.length > number);
    for (const event of events) {
      const message = page.toBinary(page.MeshEventSchema, page.create(page.MeshEventSchema, { event }));
      const frame = Buffer.alloc(5 + message.length);
      frame.writeUInt32BE(message.length, 1);
      frame.set(message, 5);
      answers[number].enqueue(new Uint8Array(frame));
    }
    await comes("the last event's reader", () => answers[number].desiredSize === 1);
  }

  const events = () => {
    const { header, chunks } = messagesOf("plain");
    return { header: { case: "header", value: header }, chunks: chunks.map((value) => ({ case: "chunk", value })),
      trailer: { case: "trailer", value: page.create(page.MeshTrailerSchema) } };
  };

  it("takes a trailer for its own mesh's, and not for the next one's that has begun meanwhile", async () => {
    const { header, chunks, trailer } = events();
    start(1);
    await send(0, header, ...chunks, trailer);
    await says(1, "surface");  // which is not drawn: the trailer waits
    start(2);
    await send(1, header, chunks[0]);
    order(1, "drawn");
    await says(2, "surface");
    order(2, "drawn");
    await send(1, ...chunks.slice(1), trailer);
    assert.equal((await says(2, "trailer")).worst.length, 10);
    assert.ok(!told.some((message) => message.run === 1 && message.kind === "trailer"));
    assert.equal(told.filter((message) => message.kind === "surface").at(-1).surface.triangles, 6 * 2 * kSide ** 2);
    order(2, "drawn");
  });

  it("says that a mesh has failed before it makes what takes memory", async () => {
    const { header, chunks } = events();
    start(3);
    await send(0, header, chunks[0]);
    await says(3, "surface");
    order(3, "drawn");
    const Whole = Uint32Array;
    globalThis.Uint32Array = new Proxy(Whole, { construct() { throw new RangeError("no room for it"); } });
    try {
      answers[0].error(new Error("gone"));
      assert.equal((await says(3, "failed")).message, "the connection broke");
      order(3, "draw", { colour: "none" });
    } finally {
      globalThis.Uint32Array = Whole;
    }
  });

  it("says why it cannot draw, and keeps the mesh", async () => {
    const { header, chunks, trailer } = events();
    start(4);
    await send(0, header, ...chunks);
    await says(4, "surface");
    order(4, "drawn");
    await send(0, trailer);
    await says(4, "trailer");
    order(4, "drawn");
    const Whole = Uint8Array;
    globalThis.Uint8Array = new Proxy(Whole, { construct() { throw new RangeError("no room for it"); } });
    try {
      order(4, "draw", { colour: "none" });
    } finally {
      globalThis.Uint8Array = Whole;
    }
    assert.equal((await says(4, "unable")).message, "no room for it");
    const before = told.length;
    order(4, "draw", { colour: "none" });
    assert.equal(told[before].surface.triangles, 6 * 2 * kSide ** 2);
    order(3, "draw", { colour: "none" });  // of an earlier run
    assert.equal(told.length, before + 1);
  });
});

describe("text in files", () => {
  it("is the shortest that reads as the same number", () => {
    for (const [x, text] of [[0.1, "0.1"], [1 / 3, "0.33333334"], [16777216, "16777216"], [1e-7, "1e-7"], [0, "0"]]) {
      assert.equal(page.shortFloat32(Math.fround(x)), text);
    }
    assert.equal(page.textOf(-1.2345678901234567e-8, true).length, 20);
  });

  it("has names of letters, digits and underscores, no two alike", () => {
    assert.deepEqual(page.namesInFile(["a/b", "a b", "1x", "A_B"], { ignoresCase: true }), ["a_b", "a_b_2", "n1x", "A_B_3"]);
    assert.deepEqual(page.namesInFile(["a", "A", "é"]), ["a", "A", "n_"]);
    assert.deepEqual(page.namesInFile(["nALL", "nall_2", "all"], { ignoresCase: true, taken: ["Nall"] }),
      ["nALL_2", "nall_2_2", "all"]);
  });

  it("has names that are cut where a character ends, no two alike", () => {
    const long = "é".repeat(70);  // 140 bytes
    assert.deepEqual(page.shortNames(["b", long, long, "b", "b_2", `x${long}`, `${long}\u{1f600}`], 120),
      ["b", "é".repeat(60), `${"é".repeat(59)}_2`, "b_2", "b_2_2", `x${"é".repeat(59)}`, `${"é".repeat(59)}_3`]);
    assert.deepEqual(page.shortNames(["\ufeffa\u{1f600}", "a\u{1f600}"], 7), ["\ufeffa", "a\u{1f600}"]);
  });

  it("has columns of fields no two of which are alike, once they tell components", () => {
    const fields = (...list) => list.map(([name, components]) => ({ name, components }));
    assert.deepEqual(page.columnNames(fields(["v", 3], ["v_x", 1], ["x", 1], ["v", 3]), { taken: ["x"] }),
      [["v_x", "v_y", "v_z"], ["v_x_2"], ["x_2"], ["v_2_x", "v_2_y", "v_2_z"]]);
    assert.deepEqual(page.columnNames(fields(["v_y", 1], ["v", 3])), [["v_y"], ["v_2_x", "v_2_y", "v_2_z"]]);
    assert.deepEqual(page.columnNames(fields(["abcdef", 1], ["abcdeg", 1]), { mostBytes: 5 }), [["abcde"], ["abc_2"]]);
  });

  it("has names in files that the formats do not have for themselves", async () => {
    const long = "ü".repeat(100), mesh = meshOf("labels", undefined, {
      labels: [{ value: 1n, name: "NALL" }, { value: 2n, name: `a"\n${long}` }],
      fields: [{ name: "v", components: 3 }, { name: "v_x", components: 1 }] });
    const textOf = async (ending) => Buffer.from(await page.fileOf(mesh, ending).arrayBuffer()).toString("utf8");
    const inp = await textOf("inp");
    assert.match(inp, /^\*ELEMENT, TYPE=C3D4, ELSET=NALL_2$/m);
    assert.match(inp, /^\*\* ELSET NALL_2: NALL$/m);
    const properties = [...(await textOf("ply")).matchAll(/^property float (.*)$/gm)].map(([, name]) => name);
    assert.deepEqual(properties, ["x", "y", "z", "v_x", "v_y", "v_z", "v_x_2"]);
    assert.match(await textOf("exo"), /v_x\0+v_y\0+v_z\0+v_x_2\0/);
    const groupsOf = (msh) => [...msh.matchAll(/^([23]) \d+ "(.*)"$/gm)].map(([, dimension, name]) => dimension + name);
    const cut = `a''${"ü".repeat(58)}`;
    assert.deepEqual(groupsOf(await textOf("msh")),
      ["2NALL_surface", `2NALL_a''${"ü".repeat(56)}`, `2${cut}`, "3NALL", `3${cut}`]);
    mesh.header.labels = [{ value: 1n, name: "bone" }, { value: 2n, name: "bone" }];
    assert.deepEqual([...(await textOf("vtu")).matchAll(/Name="(\w+)" NumberOfTuples="1" format="ascii">(\d)</g)].map((one) => one.slice(1)),
      [["bone_1", "1"], ["bone_2", "2"]]);
    mesh.header.labels = [];
    mesh.header.parts = [{ name: "", firstTet: 0n }, { name: "n", firstTet: 3000n }];
    assert.deepEqual(groupsOf(await textOf("msh")), ["2_surface", "2n_surface", "3n", "3n_2"]);
    mesh.header.parts = [".", "a/b", "", "_"].map((name) => ({ name, firstTet: 0n }));
    const path = join(folder, "names.vtkhdf");
    writeFileSync(path, Buffer.from(await page.fileOf(mesh, "vtkhdf").arrayBuffer()));
    execFileSync("/usr/bin/python3", ["-c", `
import h5py, sys
with h5py.File(sys.argv[1]) as file:
    names = {name: int(number[0]) for name, number in file["VTKHDF/FieldData"].items()}
assert names == {"_": 1, "a_b": 2, "n": 3, "__2": 4}, names
`, path], { stdio: ["ignore", "ignore", "inherit"] });
  });
});

describe("what the page shows to copy", () => {
  const twins = (place, more = {}) => page.twinsOf(
    page.create(page.MeshRequestSchema, { name: "grids/0", gridName: "it's", spacing: 0.1, levels: 2,
      preset: page.Preset.BOTH_SIDES }), { file: "a scan.vdb", ending: "msh", place, hasToken: false, ...more });

  it("has the server's own address, and the page's name of one that listens everywhere", () => {
    const { command, python } = twins({ host: "", port: 7447, tls: false });
    assert.equal(command, "tetstream mesh 'a scan.vdb' -o mesh.msh --grid 'it'\\''s' --spacing 0.1 --levels 2 " +
      "--preset both-sides --server farm.example:7447");
    assert.equal(python, 'import tetstream as ts\nclient = ts.Client("farm.example:7447")\nclient.mesh(' +
      'client.upload_file("a scan.vdb", "it\'s"), spacing=0.1, levels=2, preset="both_sides").write("mesh.msh")');
    assert.match(twins({ host: "[::1]", port: 1, tls: false }).command, / --server \[::1\]:1$/);
    assert.match(twins({ address: "unix:/run/mesher", tls: false }).command, / --server unix:\/run\/mesher$/);
  });

  it("speaks TLS and names a token where the server wants them", () => {
    const { command, python } = twins({ host: "mesher", port: 7447, tls: true }, { hasToken: true });
    assert.match(command, / --server mesher:7447 --tls --token-file token$/);
    assert.match(python, /Client\("mesher:7447", tls=True, token=open\("token"\)\.read\(\)\.strip\(\)\)/);
  });
});

describe("files of many labels", () => {
  it("unpack each chunk as often as it has labels, and not for those that it has not", () => {
    const kLabels = 2000, kOfLabel = 3;
    const store = { count: kLabels, unpacked: 0, columns(c) {
      ++this.unpacked;
      return { count: kOfLabel, groups: new Uint16Array(kOfLabel).fill(c) };
    } };
    const labels = Array.from({ length: kLabels }, (_, i) => ({ value: BigInt(i + 1), name: i % 2 ? "odd" : "" }));
    const groups = page.tetGroups({ labels });
    assert.deepEqual(groups.names.slice(0, 4), ["label_1", "odd_2", "label_3", "odd_4"]);
    const tets = new page.GroupedTets(groups, store);
    assert.deepEqual([...new Set(tets.counts)], [kOfLabel]);
    let seen = 0;
    for (const group of tets.there) tets.forEach(group, (_, own) => (seen += own.length));
    assert.deepEqual([seen, store.unpacked], [kLabels * kOfLabel, 2 * kLabels]);
  });
});

describe("what is uploaded", () => {
  const file = new File(["a volume"], "scan.vdb");
  const put = [];
  afterEach(() => mock.restoreAll());

  /** Answers as a server that has so many bytes, and then with what is `said` of each part. */
  function serve(status, ...said) {
    put.length = 0;
    mock.method(globalThis, "fetch", async (url, { headers }) => {
      if (url.startsWith("/v1/grids/")) {
        put.push(headers["Content-Range"]);
        return new Response(JSON.stringify(said.shift()));
      }
      const message = page.toBinary(page.UploadStatusSchema, page.create(page.UploadStatusSchema, status));
      const frame = (flag, bytes) => Buffer.concat([Buffer.from([flag, 0, 0, 0, bytes.length]), bytes]);
      return new Response(Buffer.concat([frame(0, message), frame(0x80, Buffer.from("grpc-status:0\r\n"))]));
    });
  }
  const upload = (sent = file) => page.upload(sent, () => {});

  it("is what the server has not, and the last byte where it has all and keeps none yet", async () => {
    serve({ committedSize: 3n }, { committedSize: "8", complete: true });
    assert.match(await upload(), /^grids\/[0-9a-f]{64}$/);
    assert.deepEqual(put, ["bytes 3-7/8"]);
    serve({ committedSize: 8n }, { complete: true, committedSize: "8" });
    await upload();
    assert.deepEqual(put, ["bytes 7-7/8"]);
    serve({ committedSize: 8n, complete: true });
    await upload();
    assert.deepEqual(put, []);
  });

  it("is not called stored where the server has not said so", async () => {
    serve({ committedSize: 0n }, {});
    await assert.rejects(upload(), /keeps 0 of 8 bytes of scan.vdb and takes no more: try again/);
    serve({ committedSize: 0n }, { committedSize: "8" }, { committedSize: "8" });
    await assert.rejects(upload(), /keeps 8 of 8 bytes/);
    assert.deepEqual(put, ["bytes 0-7/8", "bytes 7-7/8"]);
    await assert.rejects(upload(new File([], "none.vdb")), /none.vdb is empty/);
  });
});
