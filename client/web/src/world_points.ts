// Coordinates as files have them: of the world, in float32 unless that would bend tets.
import { CoordinateType, type MeshHeader } from "../generated/tetstream/v1/meshes_pb";
import type { ChunkStore } from "./chunk_store";

const kRounding = 2 ** -24, kMostShiftPerSpacing = 1e-4;

/** Whether a file's coordinates are float64. */
export function isWide(header: MeshHeader): boolean {
  const { min, max } = header.bounds ?? {};
  const largest = Math.max(...[min, max].flatMap((p) => [p?.x ?? 0, p?.y ?? 0, p?.z ?? 0]).map(Math.abs));
  return largest * kRounding > kMostShiftPerSpacing * header.spacing || header.coordinateType === CoordinateType.FLOAT64;
}

export type WorldPoints = Float32Array | Float64Array;

/** Calls `use` with the world coordinates of each chunk's vertices, in the type that files have unless it is told. */
export function forEachPoints(header: MeshHeader, store: ChunkStore,
    use: (points: WorldPoints, firstVertex: number) => void, wide = isWide(header)): void {
  const origin = [header.origin?.x ?? 0, header.origin?.y ?? 0, header.origin?.z ?? 0];
  store.forEachPositions((first, positions) => {
    const points = wide ? new Float64Array(positions.length) : new Float32Array(positions.length);
    for (let i = 0; i < points.length; ++i) points[i] = positions[i]! + origin[i % 3]!;
    use(points, first);
  });
}
