// Meshes away from the page's own thread: reads the stream, keeps the mesh, makes what is drawn.
/// <reference lib="webworker" />
import { fromBinary } from "@bufbuild/protobuf";
import { MeshEventSchema, type MeshTrailer } from "../generated/tetstream/v1/meshes_pb";
import { RpcError, streamBytes } from "./rpc";
import { stlOf, vtuOf } from "./save";
import { TetMesh, type Cut } from "./tet_mesh";

export type ToWorker =
  | { kind: "start"; method: string; request: Uint8Array; token: string }
  | { kind: "draw"; colour: string; cut?: Cut }
  | { kind: "cancel" }
  | { kind: "save"; format: "vtu" | "stl" };

export type FromWorker =
  | { kind: "progress"; done: number; total: number }
  | { kind: "header"; event: Uint8Array; keepsTets: boolean }
  | { kind: "surface"; positions: Float32Array; colours: Uint8Array; triangles: number; chunks: number;
      tets: number; bytes: number; seconds: number }
  | { kind: "trailer"; event: Uint8Array; seams: Float32Array; worst: { tet: number; angle: number; at: [number, number, number] }[] }
  | { kind: "saved"; format: string; blob: Blob }
  | { kind: "failed"; code: number; message: string; reason: string; requestId: string };

// How often what has come is drawn.
const kDrawMs = 250;

const scope = self as unknown as DedicatedWorkerGlobalScope;
let mesh: TetMesh | undefined;
let colour = "none";
let cut: Cut | undefined;
let abort: AbortController | undefined;
let bytes = 0, start = 0, drawn = 0;

function tell(message: FromWorker, transfer: Transferable[] = []): void {
  scope.postMessage(message, transfer);
}

function draw(): void {
  if (!mesh) return;
  const surface = mesh.surface(colour, cut);
  drawn = performance.now();
  tell({ kind: "surface", ...surface, chunks: mesh.chunks, tets: mesh.tetsSoFar, bytes,
    seconds: (drawn - start) / 1e3 }, [surface.positions.buffer, surface.colours.buffer]);
}

function take(event: Uint8Array): void {
  const message = fromBinary(MeshEventSchema, event).event;
  switch (message.case) {
    case "progress":
      return tell({ kind: "progress", done: Number(message.value.doneBricks), total: Number(message.value.totalBricks) });
    case "header":
      mesh = new TetMesh(message.value);
      return tell({ kind: "header", event, keepsTets: mesh.keepsTets });
    case "chunk":
      mesh!.add(message.value);
      if (mesh!.chunks === 1 || performance.now() - drawn > kDrawMs) draw();
      return;
    case "trailer":
      draw();
      return tell({ kind: "trailer", event, worst: mesh!.findWorst(),
        seams: hasSeams(message.value) ? mesh!.seams() : new Float32Array() });
  }
}

// Beyond these the search would take the worker's memory.
const kMostTriangles = 2_000_000;

function hasSeams(trailer: MeshTrailer): boolean {
  return (trailer.boundary?.nonManifoldEdges ?? 0n) > 0n && mesh!.surfaceTriangles <= kMostTriangles;
}

async function run(order: { method: string; request: Uint8Array; token: string }): Promise<void> {
  abort?.abort();
  const mine = (abort = new AbortController());
  mesh = undefined;
  bytes = drawn = 0;
  start = performance.now();
  try {
    for await (const event of streamBytes(order.method, order.request, { token: order.token, signal: mine.signal })) {
      if (mine.signal.aborted) return;
      bytes += event.length;
      take(event);
    }
  } catch (error) {
    if (mine.signal.aborted) return;
    const known = error instanceof RpcError ? error : new RpcError(2, String((error as Error).message ?? error));
    tell({ kind: "failed", code: known.code, message: known.message, reason: known.reason, requestId: known.requestId });
  }
}

scope.onmessage = ({ data }: MessageEvent<ToWorker>) => {
  switch (data.kind) {
    case "start":
      void run(data);
      break;
    case "cancel":
      abort?.abort();
      break;
    case "draw":
      colour = data.colour;
      cut = data.cut;
      draw();
      break;
    case "save":
      if (mesh) tell({ kind: "saved", format: data.format, blob: data.format === "vtu" ? vtuOf(mesh) : stlOf(mesh) });
      break;
  }
};
