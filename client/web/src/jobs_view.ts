// The view of batch jobs: listed once, then kept up to date by what the server tells.
import { create } from "@bufbuild/protobuf";
import { EmptySchema } from "@bufbuild/protobuf/wkt";
import { CancelJobRequestSchema, DeleteJobRequestSchema, GetJobRequestSchema, JobChange, JobEventSchema, JobSchema,
  JobState, ListJobsRequestSchema, ListJobsResponseSchema, RetryJobRequestSchema, WatchJobsRequestSchema,
  type Job } from "../generated/tetstream/v1/jobs_pb";
import { alertOf, count, element, explain, fillRow, keptRows, made, options } from "./page";
import { kOutOfRange, RpcError, stream, unary } from "./rpc";
import { shardsOf } from "./shard_bar";

// How long until a watch that broke is taken up; doubled each time, up to the second.
const kRetryMs = 500, kMostRetryMs = 10_000;
// So many jobs are listed at first, and more each time that older ones are asked for.
const kPageSize = 200;

export class JobsView {
  private jobs = new Map<string, Job>();
  private watching?: AbortController;
  /** Where the jobs begin that are older than those that are listed; empty where there are none. */
  private older = "";
  private olderLists = 0;
  // What is deleted while a list of older jobs comes is in it.
  private readonly deleted = new Set<string>();

  constructor(private readonly show: (job: string, save: boolean) => void) {
    const states = element<HTMLSelectElement>("job-state");
    for (const [name, value] of Object.entries(JobState)) {
      if (typeof value === "number" && value > 0) states.append(new Option(name.toLowerCase(), String(value)));
    }
    element("job-filter").addEventListener("submit", (event) => event.preventDefault());
    for (const id of ["job-state", "job-label"]) element(id).addEventListener("input", () => this.draw());
    element("older-jobs").addEventListener("click", () => {
      alertOf("");
      this.listOlder().catch((error) => alertOf(explain(error)));
    });
  }

  open(): void {
    if (!this.watching) void this.watch((this.watching = new AbortController()));
  }

  close(): void {
    this.watching?.abort();
    this.watching = undefined;
  }

  private async watch(mine: AbortController): Promise<void> {
    let wait = kRetryMs;
    let revision: bigint | undefined;
    while (!mine.signal.aborted) {
      try {
        revision ??= await this.list(mine.signal);
        element("watch-state").textContent = "live";
        const request = create(WatchJobsRequestSchema, { afterRevision: revision });
        for await (const event of stream("JobService/WatchJobs", WatchJobsRequestSchema, request, JobEventSchema,
          options({ signal: mine.signal }))) {
          revision = event.revision;
          wait = kRetryMs;
          if (event.change === JobChange.DELETED) this.forget(event.name);
          else await this.fetch(event.name, mine.signal);
          this.draw();
        }
      } catch (error) {
        if (mine.signal.aborted) return;
        if (error instanceof RpcError && error.code === kOutOfRange) revision = undefined;
        element("watch-state").textContent = explain(error);
        await new Promise((done) => setTimeout(done, wait));
        wait = Math.min(wait * 2, kMostRetryMs);
      }
    }
  }

  /**
   * The next jobs, as many as are listed at once. An answer may have fewer than were asked for, and not be the last. The
   * revision is the first answer's: what changes while others come is told after that.
   */
  private async page(signal: AbortSignal, pageToken = ""): Promise<{ jobs: Job[]; older: string; revision: bigint }> {
    const jobs: Job[] = [];
    let revision: bigint | undefined;
    do {
      const answer = await unary("JobService/ListJobs", ListJobsRequestSchema,
        create(ListJobsRequestSchema, { pageSize: kPageSize - jobs.length, pageToken }), ListJobsResponseSchema, options({ signal }));
      jobs.push(...answer.jobs);
      revision ??= answer.revision;
      pageToken = answer.nextPageToken;
    } while (pageToken && jobs.length < kPageSize);
    return { jobs, older: pageToken, revision };
  }

  private async list(signal: AbortSignal): Promise<bigint> {
    const { jobs, older, revision } = await this.page(signal);
    this.jobs = new Map(jobs.map((job) => [job.name, job]));
    this.older = older;
    this.draw();
    return revision;
  }

  /** Adds the next page of jobs. What the watch has told of one of them meanwhile is newer. */
  private async listOlder(): Promise<void> {
    const watch = this.watching, from = this.older;
    if (!watch || !from) return;
    ++this.olderLists;
    try {
      const { jobs, older } = await this.page(watch.signal, from);
      if (watch.signal.aborted || this.older !== from) return;
      for (const job of jobs) if (!this.jobs.has(job.name) && !this.deleted.has(job.name)) this.jobs.set(job.name, job);
      this.older = older;
      this.draw();
    } catch (error) {
      if (!watch.signal.aborted) throw error;
    } finally {
      if (--this.olderLists === 0) this.deleted.clear();
    }
  }

  private forget(name: string): void {
    this.jobs.delete(name);
    if (this.olderLists > 0) this.deleted.add(name);
  }

  private async fetch(name: string, signal: AbortSignal): Promise<void> {
    try {
      this.jobs.set(name, await unary("JobService/GetJob", GetJobRequestSchema, create(GetJobRequestSchema, { name }),
        JobSchema, options({ signal })));
    } catch (error) {
      if (!(error instanceof RpcError) || error.reason !== "JOB_NOT_FOUND") throw error;
      this.forget(name);  // deleted before we asked
    }
  }

  private wanted(job: Job): boolean {
    const state = element<HTMLSelectElement>("job-state").value;
    const [key, value] = element<HTMLInputElement>("job-label").value.split("=");
    return (!state || job.state === Number(state)) &&
      (!key || (key in job.labels && (!value || job.labels[key] === value)));
  }

  private draw(): void {
    const shown = [...this.jobs.values()].filter((job) => this.wanted(job)).sort((a, b) => (a.name < b.name ? 1 : -1));
    const lines = keptRows(element("job-rows"), shown.map((job) => job.name));
    shown.forEach((job, i) => this.tell(job, lines[i]!));
    element("older").hidden = !this.older;
    element("job-count").textContent = `${count(this.jobs.size)} jobs are listed, and there are older ones`;
  }

  private tell(job: Job, line: HTMLTableRowElement): void {
    const state = JobState[job.state]!.toLowerCase();
    // What can be done with a job depends on its state alone: until that changes, its buttons stay.
    const buttons = line.dataset["state"] === state ? undefined : this.buttonsOf(job);
    line.dataset["job"] = job.name;
    line.dataset["state"] = state;
    const error = made("span", job.error?.message ?? "");
    error.className = "error";
    fillRow(line, job.displayName || job.name.slice(5),
      [job.cached ? `${state} (stored)` : state, ...(job.error ? [error] : [])],
      `${count(job.progress?.doneChunks ?? 0)}/${count(job.progress?.chunkCount ?? 0)}`,
      shardsOf(job),
      Object.entries(job.labels).map(([k, v]) => `${k}=${v}`).join(", "),
      buttons);
  }

  private buttonsOf(job: Job): HTMLButtonElement[] {
    const buttons: HTMLButtonElement[] = [];
    const button = (text: string, act: () => Promise<unknown>): void => {
      const node = made("button", text);
      buttons.push(node);
      node.type = "button";
      node.setAttribute("aria-label", `${text} ${job.displayName || job.name}`);
      node.addEventListener("click", () => {
        alertOf("");
        act().catch((error) => alertOf(explain(error)));
      });
    };
    const name = job.name;
    if (job.state === JobState.SUCCEEDED) {
      button("Look", async () => this.show(name, false));
      button("Fetch", async () => this.show(name, true));
    }
    if (job.state === JobState.QUEUED || job.state === JobState.RUNNING) {
      button("Cancel", () => unary("JobService/CancelJob", CancelJobRequestSchema,
        create(CancelJobRequestSchema, { name }), JobSchema, options()));
      return buttons;
    }
    if (job.state !== JobState.SUCCEEDED) {
      button("Retry", () => unary("JobService/RetryJob", RetryJobRequestSchema,
        create(RetryJobRequestSchema, { name }), JobSchema, options()));
    }
    button("Delete", () => unary("JobService/DeleteJob", DeleteJobRequestSchema,
      create(DeleteJobRequestSchema, { name }), EmptySchema, options()));
    return buttons;
  }
}
