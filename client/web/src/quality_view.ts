// What the trailer tells of a mesh: its angles as a histogram, its boundary and thin walls in words.
import type { MeshTrailer } from "../generated/tetstream/v1/meshes_pb";
import { count, element, short } from "./page";

/** Degrees that every angle of a preset keeps. */
export interface Promised {
  low: number;
  high: number;
}

export function drawQuality(trailer: MeshTrailer, promise: Promised | undefined): void {
  const quality = trailer.quality, boundary = trailer.boundary, thin = trailer.thinWalls;
  const words: string[] = [];
  if (quality) {
    const most = Math.max(...quality.dihedralHistogram.map(Number), 1);
    const svg = element("histogram");
    const part = (tag: string, attributes: Record<string, number>): void => {
      const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
      for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, String(value));
      svg.append(node);
    };
    quality.dihedralHistogram.forEach((n, degree) => {
      const height = (96 * Number(n)) / most;
      if (n > 0n) part("rect", { x: degree * 2, y: 100 - height, width: 2, height });
    });
    for (const degree of promise ? [promise.low, promise.high] : []) {
      part("line", { x1: degree * 2, x2: degree * 2, y1: 0, y2: 100 });
    }
    words.push(`Angles ${quality.minDihedralDeg.toFixed(1)}° to ${quality.maxDihedralDeg.toFixed(1)}°` +
      (promise ? `; promised ${promise.low}° to ${promise.high}°` : ""));
  }
  if (boundary) {
    const spots = boundary.nonManifoldEdges + boundary.nonManifoldVertices;
    words.push(`${count(boundary.triangles)} triangles outside, in ${count(boundary.components)} part(s)` +
      (spots > 0n ? `; ${count(spots)} non-manifold spots` : ""));
  }
  if (thin && thin.regionCount > 0n) {
    words.push(`${count(thin.regionCount)} walls thinner than ${short(thin.thickness)}` +
      (thin.suggestedSpacing > 0 ? `: a spacing of ${short(thin.suggestedSpacing)} resolves them` : ""));
  }
  element("quality").textContent = words.join(". ");
}
