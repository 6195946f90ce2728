// The command line and the Python that do what the page does.
import { toJsonString } from "@bufbuild/protobuf";
import { Preset, type MeshRequest } from "../generated/tetstream/v1/meshes_pb";
import { SceneSchema } from "../generated/tetstream/v1/scene_pb";
import { short } from "./page";

/** Where gRPC's port is, as the server says it: see grpc_place.h there. */
export interface GrpcPlace {
  address?: string;
  host?: string;
  port?: number;
  tls: boolean;
}

/** Until the server has said it: the usual port. */
export const kNowhere: GrpcPlace = { host: "", port: 7447, tls: location.protocol === "https:" };

export async function grpcPlace(): Promise<GrpcPlace> {
  try {
    const answer = await fetch("/v1/grpc.json");
    return answer.ok ? ((await answer.json()) as GrpcPlace) : kNowhere;
  } catch {
    return kNowhere;
  }
}

/** The server's address as clients take it. One that listens everywhere is where the page came from. */
function addressOf({ address, host, port }: GrpcPlace): string {
  return address ?? `${host || location.hostname}:${port}`;
}

/** An argument as a shell takes it. */
function quoted(text: string): string {
  return /^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replace(/'/g, "'\\''")}'`;
}

export interface TwinSetting {
  file: string;
  ending: string;
  place: GrpcPlace;
  hasToken: boolean;
}

/** What the Python meshes, as it is written there. */
function pythonInput(input: string, grid: string, scene: string): string {
  if (scene) return `ts.Solid.from_json(${JSON.stringify(scene)})`;
  const file = JSON.stringify(input);
  return grid ? `client.upload_file(${file}, ${JSON.stringify(grid)})` : file;
}

export function twinsOf(request: MeshRequest, setting: TwinSetting): { command: string; python: string } {
  const { place } = setting;
  const scene = request.scene ? toJsonString(SceneSchema, request.scene, { useProtoFieldName: true }) : "";
  const input = scene ? "scene.json" : setting.file || "volume.vdb";
  const output = `mesh.${setting.ending}`, spacing = short(request.spacing!);
  const flags = [`--spacing ${spacing}`, `--levels ${request.levels}`];
  const named = [`spacing=${spacing}`, `levels=${request.levels}`];
  // The command makes a volume of a surface by itself, and that has no name.
  const grid = /\.(stl|obj|ply)$/i.test(input) ? "" : request.gridName;
  if (grid) flags.unshift(`--grid ${quoted(grid)}`);
  if (request.preset === Preset.BOTH_SIDES) {
    flags.push("--preset both-sides");
    named.push('preset="both_sides"');
  }
  flags.push(`--server ${addressOf(place)}`);
  const how = [JSON.stringify(addressOf(place))];
  if (place.tls) {
    flags.push("--tls");
    how.push("tls=True");
  }
  if (setting.hasToken) {
    flags.push("--token-file token");
    how.push('token=open("token").read().strip()');
  }
  return {
    command: (scene ? `echo ${quoted(scene)} > ${input}\n` : "") +
      `tetstream mesh ${quoted(input)} -o ${output} ${flags.join(" ")}`,
    python: `import tetstream as ts\nclient = ts.Client(${how.join(", ")})\n` +
      `client.mesh(${[pythonInput(input, grid, scene), ...named].join(", ")}).write("${output}")`,
  };
}
