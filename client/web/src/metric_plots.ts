// The last hour of the server's metrics as small plots.
import uPlot from "uplot";
import { familyOf, sum, type Samples } from "./metrics";
import { element, made, sizeOf } from "./page";

interface Plot {
  title: string;
  metrics: string[];
  names: string[];
  rate?: boolean;
  bytes?: boolean;
}

const kPlots: Plot[] = [
  { title: "Meshes", metrics: ["tetstream_meshes_running", "tetstream_meshes_queued"], names: ["running", "queued"] },
  { title: "Tets a second", metrics: ["tetstream_sent_tets_total"], names: ["sent"], rate: true },
  { title: "Bytes a second", metrics: ["tetstream_sent_bytes_total", "tetstream_upload_bytes_total"],
    names: ["sent", "received"], rate: true, bytes: true },
  { title: "Memory", metrics: ["process_resident_memory_bytes", "tetstream_resident_bytes", "tetstream_plan_bytes"],
    names: ["process", "grids", "plans"], bytes: true },
  { title: "Store", metrics: ["tetstream_store_bytes", "tetstream_result_bytes"], names: ["grids", "results"], bytes: true },
  { title: "Workers and shards", metrics: ['tetstream_workers{state="working"}', 'tetstream_job_shards{state="leased"}',
    'tetstream_job_shards{state="ready"}'], names: ["workers", "leased", "waiting"] },
  { title: "Cache, lookups a second", metrics: ['tetstream_plan_lookups_total{result="hit"}',
    'tetstream_plan_lookups_total{result="miss"}'], names: ["hits", "misses"], rate: true },
  { title: "Refusals a second", metrics: ["tetstream_refusals_total"], names: ["refused"], rate: true },
  { title: "Connections over HTTP", metrics: ["tetstream_http_connections"], names: ["open"] },
];

/** The metrics that are drawn, without their labels. */
export const kDrawn = [...new Set(kPlots.flatMap((plot) => plot.metrics.map(familyOf)))];

const kSecondsKept = 3600;
// Of a page that was just opened a plot is so wide at least, so that its times are those of today.
const kLeastSeconds = 300;

/** From the first sample to the last, of which there may be none. */
function rangeOf(times: number[]): [number, number] {
  const end = times.at(-1) ?? Date.now() / 1000;
  return [Math.min(times[0] ?? end, end - kLeastSeconds), end];
}

// Pixels: a plot's height, its least width, and what its box keeps for its own edges.
const kHeight = 180, kLeastWidth = 200, kEdges = 16;

function widthIn(box: Element): number {
  return Math.max(box.clientWidth - kEdges, kLeastWidth);
}

/** A colour of the style sheet as a canvas takes it. */
function resolved(name: string, beside: HTMLElement): string {
  const probe = made("span", "", beside);
  probe.style.color = `var(${name})`;
  const colour = getComputedStyle(probe).color;
  probe.remove();
  return colour;
}

export class MetricPlots {
  private times: number[] = [];
  private values: (number | null)[][][] = [];
  private plots: uPlot[] = [];
  private previous?: Samples;

  constructor() {
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.remake());
    // A plot's new size must not change the size of what is observed while that is told.
    new ResizeObserver(() => requestAnimationFrame(() => this.fit())).observe(element("plots"));
  }

  /** Begins anew, with no samples. */
  clear(): void {
    this.times = [];
    this.values = kPlots.map((plot) => plot.metrics.map(() => []));
    this.previous = undefined;
  }

  /** Adds a sample, of a time in seconds; those of before an hour go, and all where the clock was set back. */
  take(time: number, samples: Samples): void {
    const before = this.times.at(-1) ?? -Infinity;
    if (time === before) return;
    if (time < before) this.clear();
    kPlots.forEach((plot, p) => plot.metrics.forEach((metric, m) =>
      this.values[p]![m]!.push(plot.rate ? this.rate(metric, samples, time) : sum(samples, metric))));
    this.times.push(time);
    this.previous = samples;
    const old = this.times.findIndex((t) => t >= time - kSecondsKept);
    if (old > 0) for (const column of [this.times, ...this.values.flat()]) column.splice(0, old);
  }

  /** None for the first sample, and for the first after the server was started anew. */
  private rate(metric: string, samples: Samples, time: number): number | null {
    if (!this.previous) return null;
    const more = sum(samples, metric) - sum(this.previous, metric);
    return more < 0 ? null : more / (time - this.times.at(-1)!);
  }

  draw(): void {
    if (this.plots.length === 0) this.plots = kPlots.map((plot) => this.make(plot));
    this.plots.forEach((plot, p) => plot.setData([this.times, ...this.values[p]!] as uPlot.AlignedData));
    const [first, last] = [this.times[0] ?? 0, this.times.at(-1) ?? 0];
    element("plots").dataset["minutes"] = String(Math.round((last - first) / 60));
  }

  /** Makes the plots anew: their axes, lines and legends have the colours of the moment in which they were made. */
  private remake(): void {
    if (this.plots.length === 0) return;
    for (const plot of this.plots.splice(0)) plot.destroy();
    element("plots").replaceChildren();
    this.draw();
  }

  /** Makes each plot as wide as its box has room for, where it is seen. */
  private fit(): void {
    for (const plot of this.plots) {
      const width = widthIn(plot.root.parentElement!);
      if (width !== plot.width && plot.root.clientWidth > 0) plot.setSize({ width, height: kHeight });
    }
  }

  private make(plot: Plot): uPlot {
    const box = made("div", "", element("plots"));
    box.className = "plot";
    const style = getComputedStyle(document.body);
    const colours = ["--mark", "--bad", "--quiet"].map((name) => resolved(name, box));
    const axis = { stroke: style.color, grid: { stroke: "#8884" }, ticks: { stroke: "#8884" } };
    return new uPlot({
      title: plot.title,
      width: widthIn(box),
      height: kHeight,
      scales: { x: { range: () => rangeOf(this.times) } },
      axes: [axis, { ...axis, size: 70, values: plot.bytes ? (_, ticks) => ticks.map((t) => sizeOf(t)) : undefined }],
      series: [{}, ...plot.names.map((label, i) => ({ label, stroke: colours[i], width: 2 }))],
    }, [[], ...plot.metrics.map(() => [])] as uPlot.AlignedData, box);
  }
}
