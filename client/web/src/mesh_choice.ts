// What is to be meshed: a stored grid, a file that is sent, or a scene; and what the form says about it.
import { create } from "@bufbuild/protobuf";
import { GetGridInfoRequestSchema, GridFileSchema, ListGridsRequestSchema, ListGridsResponseSchema, type GridFile,
  type GridInfo } from "../generated/tetstream/v1/grids_pb";
import { MeshRequestSchema, Preset, type MeshRequest } from "../generated/tetstream/v1/meshes_pb";
import { count, element, made, options, short, sizeOf } from "./page";
import { unary } from "./rpc";
import { sceneNames, sceneOf } from "./scenes";
import { upload } from "./upload";

// The server answers with no more at a time.
const kPageSize = 1000;

async function storedGrids(): Promise<GridFile[]> {
  const files: GridFile[] = [];
  let pageToken = "";
  do {
    const answer = await unary("GridService/ListGrids", ListGridsRequestSchema,
      create(ListGridsRequestSchema, { pageSize: kPageSize, pageToken }), ListGridsResponseSchema, options());
    files.push(...answer.files);
    pageToken = answer.nextPageToken;
  } while (pageToken);
  return files;
}

/** The start of a stored grid's name, which is a digest. */
function shortName(name: string): string {
  return `${name.slice(6, 18)}…`;
}

function told(grid: GridInfo): string {
  return `${grid.name || "(no name)"}: ${grid.gridClass}, ${count(grid.activeVoxelCount)} voxels of ${short(grid.voxelSize)}` +
    (grid.madeOf ? `; of a surface: ${grid.madeOf}` : "") +
    (grid.notMeshableReason ? `; cannot be meshed: ${grid.notMeshableReason}` : "");
}

/** A line for what is said of one upload, in place of those of uploads that have ended. */
function uploadLine(): HTMLElement {
  const lines = element("uploads");
  for (const old of lines.querySelectorAll("[data-ended]")) old.remove();
  return made("div", "", lines);
}

export class MeshChoice {
  /** What the chosen file is called where it came from. */
  file = "";
  private name = "";
  private grids: GridInfo[] = [];
  /** Whether it is known what is in the chosen file. */
  private isKnown = true;
  private asking?: AbortController;
  private uses = 0;
  private lists = 0;

  /** `changed` is called when another request is to be made than before, or none. */
  constructor(private readonly changed: () => Promise<void>) {
    for (const name of sceneNames()) made("option", name, element("scene"));
  }

  /** Says that the form is used as it is: a file that is still being sent does not take its place any more. */
  use(): void {
    ++this.uses;
  }

  /** Lists the stored grids anew. */
  async refresh(): Promise<void> {
    const mine = ++this.lists;
    const files = await storedGrids();
    if (mine !== this.lists) return;
    const stored = element<HTMLSelectElement>("stored");
    stored.replaceChildren(new Option("none chosen", ""),
      ...files.map((file) => new Option(`${shortName(file.name)} (${sizeOf(Number(file.sizeBytes))})`, file.name)));
    stored.value = this.name;
  }

  /** Sends a file, and chooses it unless the form was used for something else meanwhile. */
  async takeFile(file: File): Promise<void> {
    const mine = ++this.uses;
    const line = uploadLine();
    try {
      const name = await upload(file, (text) => (line.textContent = text));
      line.textContent = `${file.name} is stored` +
        (/\.(stl|obj|ply)$/i.test(file.name) ? ": a surface, which the server makes a volume of" : "");
      await this.refresh();
      if (mine === this.uses) await this.choose(name, file.name);
      else line.textContent += `. It is ${shortName(name)} of the stored grids, to be chosen there`;
    } catch (error) {
      line.remove();
      throw error;
    } finally {
      line.dataset["ended"] = "";
    }
  }

  /** Chooses a stored grid, or none, and asks what is in it. */
  async choose(name: string, file: string): Promise<void> {
    const mine = this.begin(name, file);
    element<HTMLSelectElement>("stored").value = name;
    element<HTMLSelectElement>("scene").value = "";
    await this.changed();
    if (!name) return;
    try {
      const answer = await unary("GridService/GetGridInfo", GetGridInfoRequestSchema,
        create(GetGridInfoRequestSchema, { name }), GridFileSchema, options({ signal: mine.signal }));
      if (!mine.signal.aborted) await this.take(answer.grids);
    } catch (error) {
      if (mine.signal.aborted) return;
      // To choose it again has to be a change.
      this.forget("", "");
      element<HTMLSelectElement>("stored").value = "";
      await this.changed();
      throw error;
    }
  }

  async chooseScene(): Promise<void> {
    this.begin("", "");
    element<HTMLSelectElement>("stored").value = "";
    await this.changed();
  }

  /** Begins with another choice. */
  private begin(name: string, file: string): AbortController {
    this.use();
    this.forget(name, file);
    return (this.asking = new AbortController());
  }

  /** Forgets what was chosen before, for another choice or none; an answer about it comes too late. */
  private forget(name: string, file: string): void {
    this.asking?.abort();
    this.name = name;
    this.file = file;
    this.grids = [];
    this.isKnown = !name;
    element("info").textContent = "";
    element("grid").replaceChildren();
  }

  private async take(grids: GridInfo[]): Promise<void> {
    this.grids = grids;
    this.isKnown = true;
    element("info").textContent = grids.map(told).join("\n");
    const meshable = grids.filter((grid) => !grid.notMeshableReason);
    element("grid").replaceChildren(...meshable.map((grid) => new Option(grid.name || "(no name)", grid.name)));
    await this.changed();
  }

  /** The spacing that the slider stands for: a power of two of the voxel's size or the scene's default. */
  spacing(): number {
    const grid = this.grids.find((one) => one.name === element<HTMLSelectElement>("grid").value) ?? this.grids[0];
    const unit = grid?.voxelSize || 2 / 64;
    return unit * 2 ** Number(element<HTMLInputElement>("spacing").value);
  }

  /** What the form asks for. There is nothing while nothing is chosen, or it is not known what is in it. */
  request(): MeshRequest | undefined {
    const scene = sceneOf(element<HTMLSelectElement>("scene").value);
    if (!this.isKnown || (!this.name && !scene)) return undefined;
    return create(MeshRequestSchema, {
      name: this.name,
      scene,
      gridName: this.name ? element<HTMLSelectElement>("grid").value : "",
      spacing: this.spacing(),
      levels: Number(element<HTMLInputElement>("levels").value),
      preset: element<HTMLInputElement>("both").checked ? Preset.BOTH_SIDES : Preset.DEFAULT,
    });
  }
}
