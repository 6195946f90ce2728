// The tets of a mesh by what they belong to: labels, parts, regions; as core/files/tet_groups.h has them.
import type { MeshHeader, MeshLabel } from "../generated/tetstream/v1/meshes_pb";
import type { Columns } from "./chunk_store";

export interface TetGroups {
  tags: number[];
  names: string[];
  /** The group of each tet of a chunk. */
  of(columns: Columns): (tet: number) => number;
}

function freeName(wanted: string, taken: Set<string>): string {
  let name = wanted;
  for (let number = 2; taken.has(name); ++number) name = `${wanted}_${number}`;
  taken.add(name);
  return name;
}

/** Names of labels, no two alike. */
export function distinctNames(labels: MeshLabel[]): string[] {
  const taken = new Set<string>();
  return labels.map(({ name, value }) => {
    const alone = labels.filter((other) => other.name === name).length === 1;
    return freeName(!name ? `label_${value}` : alone ? name : `${name}_${value}`, taken);
  });
}

export function tetGroups(header: MeshHeader): TetGroups {
  if (header.labels.length > 0) {
    const values = header.labels.map((label) => Number(label.value));
    const areTags = values.every((value) => value >= 1 && value <= 0x7fffffff);
    return { tags: areTags ? values : values.map((_, i) => i + 1), names: distinctNames(header.labels),
      of: ({ groups }) => (t) => groups![t]! };
  }
  if (header.parts.length > 0) {
    const firsts = header.parts.map((part) => Number(part.firstTet));
    return { tags: firsts.map((_, i) => i + 1), names: header.parts.map((part) => part.name),
      // A chunk belongs to one part.
      of: ({ firstTet }) => {
        const part = firsts.findLastIndex((first) => firstTet >= first);
        return () => part;
      } };
  }
  if (header.hasRegions) {
    return { tags: [1, 2], names: ["inside", "outside"], of: ({ groups }) => (t) => groups![t]! - 1 };
  }
  return { tags: [1], names: ["inside"], of: () => () => 0 };
}

/** How many tets each group has. */
export function countGroups(groups: TetGroups, forEach: (use: (columns: Columns) => void) => void): number[] {
  const counts = groups.tags.map(() => 0);
  forEach((columns) => {
    const of = groups.of(columns);
    for (let t = 0; t < columns.count; ++t) ++counts[of(t)]!;
  });
  return counts;
}

export { freeName };
