// Meshes away from the page's own thread: reads the stream, keeps the mesh, makes what is drawn.
/// <reference lib="webworker" />
import { fromBinary } from "@bufbuild/protobuf";
import { MeshEventSchema, type MeshTrailer } from "../generated/tetstream/v1/meshes_pb";
import { bytesOf, type Surface } from "./drawing";
import { RpcError, streamBytes } from "./rpc";
import { fileOf, type SavedFormat } from "./save";
import { TetMesh, type Cut, type WorstTet } from "./tet_mesh";

/** Each start is another run, whose number is in all that is said of its mesh: what is said of an earlier one comes too late. */
interface OfRun {
  run: number;
}

export type Order =
  | { kind: "start"; method: string; request: Uint8Array; token: string; mostTets: number }
  | { kind: "draw"; colour: string; cut?: Cut }
  | { kind: "drawn" }
  | { kind: "cancel" }
  | { kind: "save"; format: SavedFormat };

export type ToWorker = OfRun & Order;

/** What a mesh takes: bytes of arrays now and at most, and those of its chunks as they came. */
export interface Holding {
  now: number;
  most: number;
  received: number;
}

type Told =
  | { kind: "progress"; done: number; total: number }
  | { kind: "header"; event: Uint8Array; keepsTets: boolean }
  | { kind: "surface"; surface: Surface; chunks: number; tets: number; seconds: number; holding: Holding }
  | { kind: "trailer"; event: Uint8Array; seams: Float32Array; worst: WorstTet[]; seconds: number; holding: Holding }
  | { kind: "saved"; format: SavedFormat; blob: Blob }
  | { kind: "unable"; message: string }
  | { kind: "failed"; code: number; message: string; reason: string; requestId: string };

export type FromWorker = OfRun & Told;

// How often what has come is drawn; and drawing may take this share of the time at most.
const kDrawMs = 250, kDrawShare = 0.25;
// Beyond this share of the tets the next surface is that of the whole mesh, which takes less.
const kLastSoFar = 0.8;

const scope = self as unknown as DedicatedWorkerGlobalScope;
let run = 0;
let mesh: TetMesh | undefined;
let colour = "none";
let cut: Cut | undefined;
let abort: AbortController | undefined;
let bytes = 0, start = 0, nextDraw = 0;
// Of the surface that the page has and has not drawn. The next waits for it, so that two are never held.
let underWay: { of: TetMesh; bytes: number } | undefined;
let again = false;

function tell(message: Told, transfer: Transferable[] = []): void {
  const numbered: FromWorker = { ...message, run };
  scope.postMessage(numbered, transfer);
}

function holding(): Holding {
  return { now: mesh!.tally.now, most: mesh!.tally.most, received: bytes };
}

function draw(): void {
  if (!mesh) return;
  again = underWay !== undefined;
  if (again) return;
  const begun = performance.now();
  const surface = mesh.surface(colour, cut);
  underWay = { of: mesh, bytes: bytesOf(surface) };
  const now = performance.now();
  nextDraw = now + Math.max(kDrawMs, (now - begun) / kDrawShare);
  tell({ kind: "surface", surface, chunks: mesh.chunks, tets: mesh.tetsSoFar, seconds: (now - start) / 1e3,
    holding: holding() }, [surface.corners.buffer, surface.places.buffer, surface.paints.buffer]);
}

/** The page's own copy is gone: the canvas has it. */
function drawn(): void {
  if (underWay) underWay.of.tally.drop(underWay.bytes);
  underWay = undefined;
  if (again) draw();
}

/** Returns once nothing of a mesh is under way, or the mesh is another. */
async function quiet(of: TetMesh): Promise<void> {
  while (underWay && mesh === of) await new Promise((done) => setTimeout(done));
}

function isNearlyWhole(of: TetMesh): boolean {
  return of.tetsSoFar > kLastSoFar * Number(of.header.tetCount);
}

async function take(event: Uint8Array, mostTets: number): Promise<void> {
  const message = fromBinary(MeshEventSchema, event).event;
  switch (message.case) {
    case "progress":
      return tell({ kind: "progress", done: Number(message.value.doneBricks), total: Number(message.value.totalBricks) });
    case "header":
      mesh = new TetMesh(message.value, mostTets);
      return tell({ kind: "header", event, keepsTets: mesh.keepsTets });
    case "chunk":
      mesh!.add(message.value);
      // One that waited for the last surface to be drawn might come when the mesh is nearly whole.
      if (mesh!.chunks === 1 || (performance.now() > nextDraw && !underWay && !isNearlyWhole(mesh!))) draw();
      return;
    case "trailer": {
      const whole = mesh!;
      await quiet(whole);
      // Another run may have begun meanwhile, or this one been cancelled.
      if (mesh === whole && !abort!.signal.aborted) takeTrailer(whole, event, message.value);
    }
  }
}

function takeTrailer(whole: TetMesh, event: Uint8Array, trailer: MeshTrailer): void {
  again = false;
  whole.finish();
  const worst = whole.findWorst();
  const seams = hasSeams(whole, trailer) ? whole.seams() : new Float32Array();
  draw();
  tell({ kind: "trailer", event, worst, seams, seconds: (performance.now() - start) / 1e3, holding: holding() });
}

// Beyond these the search would take the worker's memory.
const kMostTriangles = 2_000_000;

function hasSeams(whole: TetMesh, trailer: MeshTrailer): boolean {
  return (trailer.boundary?.nonManifoldEdges ?? 0n) > 0n && whole.surfaceTriangles <= kMostTriangles;
}

/** What has come stays, and can be cut and painted; but where there is no room for that it goes. */
function finishEarly(): void {
  try {
    mesh?.finish();
    draw();
  } catch {
    mesh = undefined;
  }
}

/** Begins a run. What the page still does with the surface of the one before is nobody's affair any more. */
function begin(order: ToWorker & { kind: "start" }): AbortController {
  abort?.abort();
  run = order.run;
  mesh = underWay = undefined;
  again = false;
  bytes = nextDraw = 0;
  start = performance.now();
  return (abort = new AbortController());
}

async function stream(order: ToWorker & { kind: "start" }): Promise<void> {
  const mine = begin(order);
  try {
    for await (const event of streamBytes(order.method, order.request, { token: order.token, signal: mine.signal })) {
      if (mine.signal.aborted) return;
      bytes += event.length;
      await take(event, order.mostTets);
    }
  } catch (error) {
    if (mine.signal.aborted) return;
    const known = error instanceof RpcError ? error : new RpcError(2, String((error as Error).message ?? error));
    // Told first: what follows takes memory, of which there may be none.
    tell({ kind: "failed", code: known.code, message: known.message, reason: known.reason, requestId: known.requestId });
    finishEarly();
  }
}

function save(format: SavedFormat): void {
  if (mesh) tell({ kind: "saved", format, blob: fileOf(mesh, format) });
}

/** Does what was asked for, or says why not: the mesh stays as it is. */
function attempt(act: () => void): void {
  try {
    act();
  } catch (error) {
    tell({ kind: "unable", message: String((error as Error).message ?? error) });
  }
}

scope.onmessage = ({ data }: MessageEvent<ToWorker>) => {
  if (data.kind !== "start" && data.run !== run) return;
  switch (data.kind) {
    case "start":
      void stream(data);
      break;
    case "cancel":
      abort?.abort();
      finishEarly();
      break;
    case "drawn":
      attempt(drawn);
      break;
    case "draw":
      colour = data.colour;
      cut = data.cut;
      attempt(draw);
      break;
    case "save":
      attempt(() => save(data.format));
      break;
  }
};
