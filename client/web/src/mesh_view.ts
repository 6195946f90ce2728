// The view that meshes: choose, estimate, watch it come, look into it, save it.
import { create, fromBinary, toBinary } from "@bufbuild/protobuf";
import { JobState, ReadJobResultRequestSchema } from "../generated/tetstream/v1/jobs_pb";
import { Encoding, EstimateMeshRequestSchema, MeshEventSchema, MeshHeaderSchema, Preset, StreamMeshRequestSchema, type Box,
  type MeshHeader, type MeshTrailer } from "../generated/tetstream/v1/meshes_pb";
import type { FromWorker, Holding } from "./mesh_worker";
import { fileNameOf, formatOf, kFormats, type SavedFormat } from "./formats";
import { askForJob } from "./job_request";
import { MeshChoice } from "./mesh_choice";
import { kNowhere, grpcPlace, twinsOf, type GrpcPlace } from "./twins";
import { alertOf, count, element, explain, made, options, short, sizeOf } from "./page";
import { drawQuality, type Promised } from "./quality_view";
import { kUnavailable, RpcError, unary } from "./rpc";
import type { WorstTet } from "./tet_mesh";
import { pictureOn } from "./viewer";
import { WorkerRuns } from "./worker_runs";

// Degrees that every angle of a preset keeps: GetCapabilities says them.
export type Promises = Map<Preset, Promised>;

// More tets than these are drawn by their surface alone; `?most_tets=` in the page's address says otherwise.
const kMostTets = 30_000_000;

function mostTets(): number {
  const said = Number(new URLSearchParams(location.search).get("most_tets"));
  return said > 0 ? said : kMostTets;
}

export class MeshView {
  private readonly picture = pictureOn(element<HTMLCanvasElement>("canvas"));
  private readonly worker = new WorkerRuns((message) => this.take(message), (why) => this.lose(why));
  private readonly choice = new MeshChoice(() => this.estimate());
  private canMesh = false;
  private isAskingForJob = false;
  private header?: MeshHeader;
  private estimating?: AbortController;
  private drawnFirst = 0;
  private place: GrpcPlace = kNowhere;
  private canSave = false;
  private keepsTets = true;
  private saveWhenWhole = false;

  constructor(private readonly promises: () => Promises) {
    const drop = element("drop");
    drop.addEventListener("dragover", (event) => {
      event.preventDefault();
      drop.classList.add("over");
    });
    drop.addEventListener("dragleave", () => drop.classList.remove("over"));
    drop.addEventListener("drop", (event) => {
      event.preventDefault();
      drop.classList.remove("over");
      const file = event.dataTransfer?.files[0];
      if (file) void this.guard(() => this.choice.takeFile(file));
    });
    const on = (id: string, event: string, act: () => unknown): void =>
      element(id).addEventListener(event, () => void this.guard(async () => act()));
    on("file", "change", () => {
      const file = element<HTMLInputElement>("file").files?.[0];
      return file && this.choice.takeFile(file);
    });
    on("stored", "change", () => this.choice.choose(element<HTMLSelectElement>("stored").value, ""));
    on("scene", "change", () => this.choice.chooseScene());
    for (const id of ["grid", "spacing", "levels", "both"]) on(id, "input", () => this.estimate());
    element("mesh-form").addEventListener("submit", (event) => {
      event.preventDefault();
      void this.guard(async () => this.start());
    });
    on("stop", "click", () => this.cancel());
    on("submit", "click", () => this.submitJob());
    for (const id of ["colour", "cut-axis", "cut-at"]) on(id, "input", () => this.redraw());
    element("format").append(...kFormats.map(({ ending, what }) => new Option(`.${ending}: ${what}`, ending)));
    on("format", "input", () => this.chooseFormat());
    on("save", "click", () => this.save());
    element("canvas").addEventListener("webglcontextrestored", () => this.redraw());
    void grpcPlace().then((place) => {
      this.place = place;
      this.tellTwins();
    });
  }

  async refresh(): Promise<void> {
    await this.choice.refresh();
  }

  /** Draws the mesh that a job has made, and saves it as the menu says where that is wanted. */
  showJob(name: string, save: boolean): void {
    this.saveWhenWhole = save;
    this.begin("JobService/ReadJobResult",
      toBinary(ReadJobResultRequestSchema, create(ReadJobResultRequestSchema, { name })));
  }

  private async guard(act: () => Promise<unknown>): Promise<void> {
    try {
      alertOf("");
      await act();
    } catch (error) {
      alertOf(explain(error));
    }
  }

  private async estimate(): Promise<void> {
    this.estimating?.abort();
    const mine = (this.estimating = new AbortController());
    const request = this.choice.request();
    this.allowMeshing(Boolean(request));
    element("estimate").textContent = "";
    this.tellTwins();
    if (!request) return;
    element("spacing-text").textContent = short(this.choice.spacing());
    element("estimate").textContent = "Counting…";
    try {
      const header = await unary("MeshService/EstimateMesh", EstimateMeshRequestSchema,
        create(EstimateMeshRequestSchema, { mesh: request }), MeshHeaderSchema, options({ signal: mine.signal }));
      if (mine.signal.aborted) return;
      element("estimate").textContent = `${count(header.tetCount)} tets, ${count(header.vertexCount)} vertices, ` +
        `${sizeOf(Number(header.meshBytes))}, about ${short(header.fillSeconds)} s` +
        (header.insideGuess ? `. ${header.insideGuess}` : "");
    } catch (error) {
      if (mine.signal.aborted) return;
      element("estimate").textContent = explain(error);
      // A server that cannot be reached may be there again by the time that somebody meshes.
      if (error instanceof RpcError && error.code !== kUnavailable) this.allowMeshing(false);
    }
  }

  private allowMeshing(allowed: boolean): void {
    this.canMesh = allowed;
    element<HTMLButtonElement>("go").disabled = !allowed;
    element<HTMLButtonElement>("submit").disabled = !allowed || this.isAskingForJob;
  }

  /** The command line and the Python that make the same mesh, and save it as the menu says. */
  private tellTwins(): void {
    const request = this.choice.request();
    const twins = !request ? { command: "", python: "" } : twinsOf(request, { file: this.choice.file, ending: this.ending(), place: this.place,
      hasToken: options().token !== "" });
    element<HTMLTextAreaElement>("command").value = twins.command;
    element<HTMLTextAreaElement>("python").value = twins.python;
  }

  private ending(): SavedFormat {
    return formatOf(element<HTMLSelectElement>("format").value).ending;
  }

  private chooseFormat(): void {
    const { ending, zipped } = formatOf(this.ending());
    // A surface alone has no names.
    element<HTMLButtonElement>("save").disabled = !this.canSave || (!this.keepsTets && ending !== "stl");
    element("save-note").textContent = zipped ? `A .zip with ${zipped}.` : "";
    this.tellTwins();
  }

  private allowSaving(allowed: boolean): void {
    this.canSave = allowed;
    this.chooseFormat();
  }

  private save(): void {
    this.worker.send({ kind: "save", format: this.ending() });
  }

  private start(): void {
    const request = this.choice.request();
    if (!request) return;
    this.choice.use();
    this.saveWhenWhole = false;
    const stream = create(StreamMeshRequestSchema, { mesh: request, encoding: Encoding.PACKED });
    this.begin("MeshService/StreamMesh", toBinary(StreamMeshRequestSchema, stream));
  }

  private begin(method: string, request: Uint8Array): void {
    this.header = undefined;
    this.drawnFirst = 0;
    document.body.dataset["mesh"] = "running";
    element<HTMLButtonElement>("stop").disabled = false;
    this.allowSaving(false);
    for (const id of ["histogram", "worst"]) element(id).replaceChildren();
    element("quality").textContent = "";
    element("status").textContent = "Waiting for the server…";
    element<HTMLProgressElement>("progress").removeAttribute("value");
    this.picture.clear();
    this.worker.start({ kind: "start", method, request, token: options().token, mostTets: mostTets() });
  }

  private cancel(): void {
    this.worker.send({ kind: "cancel" });
    this.ended("cancelled", "Cancelled: what has come stays");
  }

  private ended(how: string, text: string): void {
    document.body.dataset["mesh"] = how;
    element<HTMLButtonElement>("stop").disabled = true;
    element("status").textContent = text;
    if (how !== "done") element<HTMLProgressElement>("progress").value = 0;
  }

  /** The worker is gone, and what it had of a mesh. */
  private lose(why: string): void {
    alertOf(`What meshes in this page has failed: ${why}. The next mesh begins anew.`);
    this.allowSaving(false);
    if (document.body.dataset["mesh"] === "running") this.ended("failed", "The mesh did not come to its end");
  }

  private async submitJob(): Promise<void> {
    const mesh = this.choice.request();
    if (!mesh || this.isAskingForJob) return;
    this.choice.use();
    this.isAskingForJob = true;
    this.allowMeshing(this.canMesh);
    try {
      const job = await askForJob(mesh, this.choice.file);
      element("status").textContent = `${job.name}: ${JobState[job.state]!.toLowerCase()}`;
      location.hash = "#jobs";
    } finally {
      this.isAskingForJob = false;
      this.allowMeshing(this.canMesh);
    }
  }

  private redraw(): void {
    const header = this.header;
    if (!header) return;
    const axis = ["x", "y", "z"].indexOf(element<HTMLSelectElement>("cut-axis").value);
    const colour = element<HTMLSelectElement>("colour").value;
    const [low, high] = this.bounds(header);
    const share = Number(element<HTMLInputElement>("cut-at").value);
    this.worker.send({ kind: "draw", colour,
      cut: axis < 0 ? undefined : { axis, at: low[axis]! + (high[axis]! - low[axis]!) * share } });
  }

  /** Where the mesh lies, relative to its origin as its positions are. */
  private bounds(header: MeshHeader): [number[], number[]] {
    return this.relative(header.bounds, header);
  }

  private relative(box: Box | undefined, header = this.header): [number[], number[]] {
    const o = header?.origin, low = box?.min, high = box?.max;
    const less = (p: typeof low): number[] =>
      [(p?.x ?? 0) - (o?.x ?? 0), (p?.y ?? 0) - (o?.y ?? 0), (p?.z ?? 0) - (o?.z ?? 0)];
    return [less(low), less(high)];
  }

  private take(message: FromWorker): void {
    const ofTheMesh = !["surface", "saved", "unable"].includes(message.kind);
    if (document.body.dataset["mesh"] === "cancelled" && ofTheMesh) return;
    switch (message.kind) {
      case "progress":
        element("status").textContent = message.total > 0
          ? `Counting: ${count(message.done)} of ${count(message.total)} bricks` : "Reading the grid…";
        return;
      case "header":
        return this.takeHeader(message.event, message.keepsTets);
      case "surface":
        return this.takeSurface(message);
      case "trailer": {
        const event = fromBinary(MeshEventSchema, message.event).event;
        if (event.case === "trailer") {
          this.tellHolding(message.holding);
          this.takeTrailer(event.value, message.worst, message.seconds);
          this.mark(event.value, message.seams);
        }
        return;
      }
      case "failed":
        alertOf(explain(new RpcError(message.code, message.message, message.reason, message.requestId)));
        return this.ended("failed", "The mesh did not come to its end");
      case "unable":
        return alertOf(message.message);
      case "saved": {
        const link = document.createElement("a");
        link.href = URL.createObjectURL(message.blob);
        link.download = fileNameOf(formatOf(message.format));
        link.click();
        setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
      }
    }
  }

  private takeHeader(bytes: Uint8Array, keepsTets: boolean): void {
    const event = fromBinary(MeshEventSchema, bytes).event;
    if (event.case !== "header") return;
    this.header = event.value;
    const [low, high] = this.bounds(event.value);
    this.picture.look(low, high);
    this.keepsTets = keepsTets;
    if (!keepsTets) alertOf("The mesh is more than a tab holds: its surface alone is drawn. The command line saves all of it.");
    element<HTMLSelectElement>("cut-axis").disabled = !keepsTets;
    this.redraw();
  }

  private takeSurface(message: FromWorker & { kind: "surface" }): void {
    this.picture.show(message.surface, () => this.worker.send({ kind: "drawn" }, message.run));
    const triangles = message.surface.triangles;
    const canvas = element("canvas");
    canvas.dataset["triangles"] = String(triangles);
    canvas.dataset["chunks"] = String(message.chunks);
    this.tellHolding(message.holding);
    if (this.drawnFirst === 0 && triangles > 0) {
      this.drawnFirst = message.seconds;
      canvas.dataset["first"] = String(message.seconds);
    }
    if (document.body.dataset["mesh"] !== "running" || !this.header) return;
    const total = Number(this.header.tetCount);
    element<HTMLProgressElement>("progress").value = total > 0 ? message.tets / total : 1;
    element("status").textContent = `${count(message.tets)} of ${count(total)} tets, ` +
      `${sizeOf(message.holding.received)}, ${sizeOf(message.holding.received / Math.max(message.seconds, 1e-3))}/s`;
    canvas.dataset["progressive"] = String(Math.max(Number(canvas.dataset["progressive"] ?? 0),
      message.tets < total ? triangles : 0));
  }

  /** What a test may read: bytes that the mesh takes, at most, and those that came. */
  private tellHolding({ now, most, received }: Holding): void {
    Object.assign(element("canvas").dataset, { held: now, heldMost: most, received });
  }

  private takeTrailer(trailer: MeshTrailer, worst: WorstTet[], seconds: number): void {
    element("canvas").dataset["seconds"] = String(seconds);
    this.ended("done", `${count(this.header!.tetCount)} tets in ${short(seconds)} s; ` +
      `first triangles after ${short(this.drawnFirst)} s`);
    this.allowSaving(true);
    if (this.saveWhenWhole) this.save();
    drawQuality(trailer, this.promises().get(this.header!.canonicalRequest?.preset || Preset.DEFAULT));
    const list = element("worst");
    for (const one of worst) {
      const button = made("button", `${one.angle.toFixed(2)}°`, made("li", "", list));
      button.type = "button";
      button.addEventListener("click", () => {
        const size = this.header!.spacing * 4;
        this.picture.look(one.at.map((x) => x - size), one.at.map((x) => x + size), true);
      });
    }
  }

  /** Thin walls as boxes, edges that are no manifold as lines. */
  private mark(trailer: MeshTrailer, seams: Float32Array): void {
    const regions = trailer.thinWalls?.regions ?? [];
    this.picture.mark(regions.map((region) => this.relative(region.box)), seams);
  }
}
