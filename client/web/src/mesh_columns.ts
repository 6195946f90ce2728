// Columns that several formats have: fields, and what the tets are labelled with.
import type { MeshHeader } from "../generated/tetstream/v1/meshes_pb";
import type { Columns } from "./chunk_store";
import { tetGroups } from "./tet_groups";

export interface Field {
  name: string;
  components: number;
  at: number;  // the place of its first value in a row
  rowFloats: number;
}

export function fieldsOf(header: MeshHeader): Field[] {
  const rowFloats = header.fields.reduce((sum, field) => sum + field.components, 0);
  let next = 0;
  return header.fields.map(({ name, components }) => {
    const at = next;
    next += components;
    return { name, components, at, rowFloats };
  });
}

/** The values of some components of each vertex of a chunk. */
export function valuesOf({ components, at, rowFloats }: Field, { fields, vertices }: Columns): Float32Array {
  const values = new Float32Array(vertices * components);
  for (let v = 0, next = 0; v < vertices; ++v) {
    for (let c = 0; c < components; ++c) values[next++] = fields![v * rowFloats + at + c]!;
  }
  return values;
}

export type LabelType = "UInt8" | "Int32" | "Int64";
type Labels = Uint8Array | Int32Array | BigInt64Array;

export interface TetLabels {
  name: "label" | "region" | "part";
  type: LabelType;
  of(columns: Columns): Labels;
}

export const kLabelBytes: Record<LabelType, number> = { UInt8: 1, Int32: 4, Int64: 8 };
const kLeastInt32 = -(2 ** 31), kMostInt32 = 2 ** 31 - 1;

/** What the tets are labelled with, if anything: values of a segmentation, or numbers from 1 on. */
export function tetLabels(header: MeshHeader): TetLabels | undefined {
  const groups = tetGroups(header);
  if (header.labels.length > 0) {
    const values = header.labels.map((label) => label.value);
    const narrow = values.every((value) => value >= kLeastInt32 && value <= kMostInt32);
    const numbers = values.map(Number);
    return { name: "label", type: narrow ? "Int32" : "Int64", of: (columns) => {
      const of = groups.of(columns);
      return narrow ? Int32Array.from({ length: columns.count }, (_, t) => numbers[of(t)]!)
        : BigInt64Array.from({ length: columns.count }, (_, t) => values[of(t)]!);
    } };
  }
  if (!header.hasRegions && header.parts.length === 0) return undefined;
  return { name: header.hasRegions ? "region" : "part", type: "UInt8", of: (columns) => {
    const of = groups.of(columns);
    return Uint8Array.from({ length: columns.count }, (_, t) => of(t) + 1);
  } };
}
