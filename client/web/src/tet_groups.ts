// The tets of a mesh by what they belong to: labels, parts, regions; as core/files/tet_groups.h has them.
import type { MeshHeader, MeshLabel } from "../generated/tetstream/v1/meshes_pb";
import type { ChunkStore, Columns } from "./chunk_store";

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
  const taken = new Set<string>(), called = new Map<string, number>();
  for (const { name } of labels) called.set(name, (called.get(name) ?? 0) + 1);
  return labels.map(({ name, value }) =>
    freeName(!name ? `label_${value}` : called.get(name) === 1 ? name : `${name}_${value}`, taken));
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

/** The tets of each group. Of a mesh with many groups few chunks have any of one: no others are unpacked for it. */
export class GroupedTets {
  readonly counts: number[];
  private readonly chunks: number[][];

  constructor(readonly groups: TetGroups, private readonly store: ChunkStore) {
    this.counts = groups.tags.map(() => 0);
    this.chunks = groups.tags.map(() => []);
    for (let c = 0; c < store.count; ++c) {
      const columns = store.columns(c), of = groups.of(columns);
      for (let t = 0; t < columns.count; ++t) {
        const group = of(t);
        ++this.counts[group]!;
        if (this.chunks[group]!.at(-1) !== c) this.chunks[group]!.push(c);
      }
    }
  }

  /** Groups that have tets. */
  get there(): number[] {
    return this.counts.flatMap((count, group) => (count > 0 ? [group] : []));
  }

  /** Calls `use` with each chunk that has tets of a group, and with their places in it, rising. */
  forEach(group: number, use: (columns: Columns, own: number[]) => void): void {
    for (const c of this.chunks[group]!) {
      const columns = this.store.columns(c), of = this.groups.of(columns), own: number[] = [];
      for (let t = 0; t < columns.count; ++t) if (of(t) === group) own.push(t);
      use(columns, own);
    }
  }
}

export { freeName };
