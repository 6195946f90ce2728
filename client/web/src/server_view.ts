// The view of the server: its own metrics, asked for every few seconds, beside what it kept of the last hour.
import { MetricPlots, kDrawn } from "./metric_plots";
import { byLabel, parseMetrics, samplesOf, sum, type History, type Samples } from "./metrics";
import { element, explain, made, options, row, sizeOf } from "./page";
import { drawWorkers } from "./workers_view";

const kEveryMs = 5000;

/** What takes memory or disk, and how much it may. */
const kBudgets = [
  { what: "counted meshes", used: "tetstream_plan_bytes", budget: "tetstream_plan_budget_bytes" },
  { what: "grids in memory", used: "tetstream_resident_bytes", budget: "tetstream_resident_budget_bytes" },
  { what: "grids on disk", used: "tetstream_store_bytes", budget: "tetstream_store_budget_bytes" },
  { what: "results of jobs", used: "tetstream_result_bytes", budget: "tetstream_result_budget_bytes" },
];

/** What the server answers to a GET with the token of this page. */
async function get(path: string): Promise<Response> {
  const token = options().token;
  const answer = await fetch(path, { headers: token ? { Authorization: `Bearer ${token}` } : {} });
  if (!answer.ok) throw new Error((await answer.json()).error?.message ?? `HTTP ${answer.status}`);
  return answer;
}

export class ServerView {
  private readonly plots = new MetricPlots();
  private timer = 0;

  open(): void {
    this.close();
    this.timer = window.setInterval(() => void this.ask(), kEveryMs);
    void this.begin();
  }

  close(): void {
    window.clearInterval(this.timer);
    this.timer = 0;
  }

  /** The hour until now comes from the server, so that nothing is missing of the time when nobody looked. */
  private async begin(): Promise<void> {
    this.plots.clear();
    this.plots.draw();
    try {
      const history = (await (await get(`/metrics/history?names=${kDrawn.join(",")}`)).json()) as History;
      for (const { time, samples } of samplesOf(history, Date.now() / 1000)) this.plots.take(time, samples);
    } catch (error) {
      element("server-info").textContent = explain(error);
    }
    await this.ask();
  }

  private async ask(): Promise<void> {
    try {
      this.take(parseMetrics(await (await get("/metrics")).text()));
      await drawWorkers();
    } catch (error) {
      element("server-info").textContent = explain(error);
    }
  }

  private take(samples: Samples): void {
    this.plots.take(Date.now() / 1000, samples);
    this.plots.draw();
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
