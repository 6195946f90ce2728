// The page: three views, a token, and what they say when something goes wrong.
import { create } from "@bufbuild/protobuf";
import { CapabilitiesSchema, GetCapabilitiesRequestSchema } from "../generated/tetstream/v1/meshes_pb";
import { JobsView } from "./jobs_view";
import { MeshView, type Promises } from "./mesh_view";
import { alertOf, element, explain, options, setToken } from "./page";
import { unary } from "./rpc";
import { ServerView } from "./server_view";

const kViews = ["mesh", "jobs", "server"];
let promises: Promises = new Map();
const mesh = new MeshView(() => promises);
const jobs = new JobsView((job, save) => {
  location.hash = "#mesh";
  mesh.showJob(job, save);
});
const server = new ServerView();

function turn(): void {
  const view = kViews.includes(location.hash.slice(1)) ? location.hash.slice(1) : "mesh";
  for (const name of kViews) element(name).hidden = name !== view;
  for (const link of document.querySelectorAll<HTMLAnchorElement>("nav a")) {
    if (link.dataset["view"] === view) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
  }
  if (view === "jobs") jobs.open();
  else jobs.close();
  if (view === "server") server.open();
  else server.close();
}

async function greet(): Promise<void> {
  try {
    const can = await unary("MeshService/GetCapabilities", GetCapabilitiesRequestSchema,
      create(GetCapabilitiesRequestSchema), CapabilitiesSchema, options());
    promises = new Map(can.presets.map((p) => [p.preset, { low: p.minDihedralDeg, high: p.maxDihedralDeg }]));
    await mesh.refresh();
    alertOf("");
    document.body.dataset["server"] = can.serverVersion;
  } catch (error) {
    alertOf(explain(error));
  }
}

element("token-form").addEventListener("submit", (event) => {
  event.preventDefault();
  setToken(element<HTMLInputElement>("token").value);
  jobs.close();
  turn();
  void greet();
});
window.addEventListener("hashchange", turn);
turn();
void greet();
