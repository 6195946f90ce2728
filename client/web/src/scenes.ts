// Scenes to begin with, as the JSON of docs/scenes.md.
import { create, type MessageInitShape } from "@bufbuild/protobuf";
import { SceneSchema, type Scene } from "../generated/tetstream/v1/scene_pb";

const kScenes: Record<string, MessageInitShape<typeof SceneSchema>> = {
  "a ball": { nodes: [{ kind: { case: "sphere", value: { radius: 1 } } }] },
  "a ring": { nodes: [{ kind: { case: "torus", value: { majorRadius: 1, minorRadius: 0.35 } } }] },
  "a bored block": {
    nodes: [
      { name: "block", kind: { case: "roundedBox", value: { size: [2, 2, 1], rounding: 0.15 } } },
      { name: "bore", kind: { case: "cylinder", value: { radius: 0.5, height: 3 } } },
      { kind: { case: "difference", value: { of: ["block", "bore"] } } },
    ],
  },
};

export function sceneNames(): string[] {
  return Object.keys(kScenes);
}

export function sceneOf(name: string): Scene | undefined {
  const scene = kScenes[name];
  return scene && create(SceneSchema, scene);
}
