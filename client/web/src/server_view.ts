// The view of the server: its own metrics, asked for every few seconds, the last hour as plots.
import uPlot from "uplot";
import { element, explain, made, options, row, sizeOf } from "./page";
import { drawWorkers } from "./workers_view";

const kEveryMs = 5000;
const kMostPoints = 3600_000 / kEveryMs;

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

/** What takes memory or disk, and how much it may. */
const kBudgets = [
  { what: "counted meshes", used: "tetstream_plan_bytes", budget: "tetstream_plan_budget_bytes" },
  { what: "grids in memory", used: "tetstream_resident_bytes", budget: "tetstream_resident_budget_bytes" },
  { what: "grids on disk", used: "tetstream_store_bytes", budget: "tetstream_store_budget_bytes" },
  { what: "results of jobs", used: "tetstream_result_bytes", budget: "tetstream_result_budget_bytes" },
];

// Of a page that was just opened a plot is so wide at least, so that its times are those of today.
const kLeastSeconds = 300;

/** From the first sample to the last, of which there may be none. */
function rangeOf(times: number[]): [number, number] {
  const end = times.at(-1) ?? Date.now() / 1000;
  return [Math.min(times[0] ?? end, end - kLeastSeconds), end];
}

type Samples = Map<string, number>;

export function parseMetrics(text: string): Samples {
  const samples: Samples = new Map();
  for (const line of text.split("\n")) {
    const match = /^([^#\s]\S*) (\S+)$/.exec(line);
    if (match) samples.set(match[1]!, Number(match[2]));
  }
  return samples;
}

/** The sum over all labels. */
function sum(samples: Samples, name: string): number {
  let total = 0;
  for (const [key, value] of samples) if (key === name || key.startsWith(`${name}{`)) total += value;
  return total;
}

/** The samples of a metric, by the value of one of its labels. */
function byLabel(samples: Samples, name: string, label: string): [string, number][] {
  return [...samples].filter(([key]) => key.startsWith(`${name}{`))
    .map(([key, value]) => [new RegExp(`${label}="([^"]*)"`).exec(key)?.[1] ?? "", value]);
}

/** A colour of the style sheet as a canvas takes it. */
function resolved(name: string, beside: HTMLElement): string {
  const probe = made("span", "", beside);
  probe.style.color = `var(${name})`;
  const colour = getComputedStyle(probe).color;
  probe.remove();
  return colour;
}

export class ServerView {
  private readonly times: number[] = [];
  private readonly values = kPlots.map((plot) => plot.metrics.map(() => [] as (number | null)[]));
  private plots: uPlot[] = [];
  private previous?: Samples;
  private timer = 0;

  open(): void {
    if (this.plots.length === 0) this.plots = kPlots.map((plot) => this.make(plot));
    if (!this.timer) this.timer = window.setInterval(() => void this.ask(), kEveryMs);
    void this.ask();
  }

  close(): void {
    window.clearInterval(this.timer);
    this.timer = 0;
  }

  private make(plot: Plot): uPlot {
    const box = made("div", "", element("plots"));
    box.className = "plot";
    const style = getComputedStyle(document.body);
    const colours = ["--mark", "--bad", "--quiet"].map((name) => resolved(name, box));
    const axis = { stroke: style.color, grid: { stroke: "#8884" }, ticks: { stroke: "#8884" } };
    return new uPlot({
      title: plot.title,
      width: Math.max(box.clientWidth - 16, 200),
      height: 180,
      scales: { x: { range: () => rangeOf(this.times) } },
      axes: [axis, { ...axis, size: 70, values: plot.bytes ? (_, ticks) => ticks.map((t) => sizeOf(t)) : undefined }],
      series: [{}, ...plot.names.map((label, i) => ({ label, stroke: colours[i], width: 2 }))],
    }, [[], ...plot.metrics.map(() => [])] as uPlot.AlignedData, box);
  }

  private async ask(): Promise<void> {
    try {
      const token = options().token;
      const answer = await fetch("/metrics", { headers: token ? { Authorization: `Bearer ${token}` } : {} });
      if (!answer.ok) throw new Error((await answer.json()).error?.message ?? `HTTP ${answer.status}`);
      this.take(parseMetrics(await answer.text()));
      await drawWorkers();
    } catch (error) {
      element("server-info").textContent = explain(error);
    }
  }

  private take(samples: Samples): void {
    this.times.push(Date.now() / 1000);
    kPlots.forEach((plot, p) => plot.metrics.forEach((metric, m) => {
      const column = this.values[p]![m]!;
      const value = sum(samples, metric);
      if (!plot.rate) column.push(value);
      else column.push(this.previous ? (value - sum(this.previous, metric)) / this.secondsSinceLast() : null);
      if (column.length > kMostPoints) column.shift();
    }));
    if (this.times.length > kMostPoints) this.times.shift();
    this.plots.forEach((plot, p) => plot.setData([this.times, ...this.values[p]!] as uPlot.AlignedData));
    this.previous = samples;
    const since = samples.get("process_start_time_seconds");
    element("server-info").textContent = `Calls so far: ${sum(samples, "tetstream_calls_total")}. ` +
      (since ? `Up since ${new Date(since * 1000).toLocaleString()}.` : "");
    this.drawBudgets(samples);
    this.countWorkers(samples);
    this.drawCache(samples);
    element("refusals").replaceChildren(...[...samples]
      .filter(([name, value]) => name.startsWith("tetstream_refusals_total{") && value > 0)
      .map(([name, value]) => {
        const row = made("tr");
        made("td", /code="([^"]*)"/.exec(name)?.[1] ?? "", row);
        made("td", /reason="([^"]*)"/.exec(name)?.[1] ?? "", row);
        made("td", String(value), row);
        return row;
      }));
  }

  private secondsSinceLast(): number {
    const [before, now] = this.times.slice(-2);
    return Math.max((now ?? 0) - (before ?? 0), 1e-3);
  }

  private drawBudgets(samples: Samples): void {
    const table = element("budgets");
    table.replaceChildren();
    for (const { what, used, budget } of kBudgets) {
      const most = samples.get(budget);
      if (!most) continue;
      const bytes = sum(samples, used);
      const meter = made("meter");
      meter.max = most;
      meter.value = bytes;
      meter.high = most * 0.9;
      meter.setAttribute("aria-label", `Share of ${what}`);
      row(table, what, sizeOf(bytes), sizeOf(most), meter);
    }
  }

  private countWorkers(samples: Samples): void {
    const table = element("worker-counts");
    table.replaceChildren();
    for (const [state, count] of byLabel(samples, "tetstream_workers", "state")) row(table, `workers ${state}`, String(count));
    for (const [state, count] of byLabel(samples, "tetstream_job_shards", "state")) {
      row(table, state === "leased" ? "shards leased: a worker has them" : `shards ${state.replace("_", " ")}`, String(count));
    }
    const oldest = samples.get("tetstream_job_oldest_ready_seconds");
    if (oldest) row(table, "the oldest waits for", `${Math.round(oldest)} s`);
    for (const [outcome, count] of byLabel(samples, "tetstream_worker_shards_total", "outcome")) {
      row(table, `shards of this process ${outcome.replace("_", " ")}`, String(count));
    }
    if (table.childElementCount === 0) row(table, "this server takes no jobs", "");
  }

  private drawCache(samples: Samples): void {
    const table = element("cache");
    table.replaceChildren();
    const lookups = new Map(byLabel(samples, "tetstream_plan_lookups_total", "result"));
    const hits = lookups.get("hit") ?? 0, all = hits + (lookups.get("miss") ?? 0);
    row(table, "counted meshes found", all > 0 ? `${hits} of ${all} (${Math.round((100 * hits) / all)} %)` : "none asked for");
    row(table, "streams from results of jobs", String(sum(samples, "tetstream_cached_streams_total")));
    row(table, "grids in memory", `${sum(samples, "tetstream_resident_grids")}, ${sizeOf(sum(samples, "tetstream_resident_bytes"))}`);
    for (const [what, count] of byLabel(samples, "tetstream_evictions_total", "what")) {
      row(table, `had to go: ${what.replace("_", " ")}`, String(count));
    }
  }
}
