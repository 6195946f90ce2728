// The table of workers: who they are, what they hold, and what keeps them from working.
import { create } from "@bufbuild/protobuf";
import { timestampMs, type Timestamp } from "@bufbuild/protobuf/wkt";
import { ListWorkersRequestSchema, ListWorkersResponseSchema, type LeasedShard,
  type Worker } from "../generated/tetstream/v1/jobs_pb";
import { count, element, explain, fillRow, keptRows, made, options, row } from "./page";
import { RpcError, unary } from "./rpc";

const kMostShown = 200;
const kUnimplemented = 12;

/** By the store's clock, which is the only one that counts for workers. */
function ago(then: Timestamp | undefined, now: Timestamp | undefined): string {
  const seconds = Math.max(0, Math.round(((now ? timestampMs(now) : 0) - (then ? timestampMs(then) : 0)) / 1000));
  return seconds < 120 ? `${seconds} s ago` : seconds < 7200 ? `${Math.round(seconds / 60)} min ago`
    : `${Math.round(seconds / 3600)} h ago`;
}

export function stateOf({ lost, trouble }: Worker): string {
  if (lost) return "lost: nothing is heard of it";
  return trouble ? `in quarantine: ${trouble.message}` : "works";
}

function shardText({ job, firstChunk, endChunk, attempt }: LeasedShard): string {
  const what = endChunk > firstChunk ? `${firstChunk} to ${endChunk - 1n}` : "its count";
  return `${job.slice(5)}: ${what}${attempt > 1 ? `, attempt ${attempt}` : ""}`;
}

/** How many shards it has; what they are, to be opened, as far as they are the caller's. What is open stays so. */
function leases({ leasedShards, shards, name }: Worker, cell: Element | undefined): (string | Element)[] | undefined {
  if (shards.length === 0) return [count(leasedShards)];
  const before = cell?.querySelector("details");
  const details = before ?? made("details");
  const summary = before?.querySelector("summary") ?? made("summary", "", details);
  const list = before?.querySelector("ul") ?? made("ul", "", details);
  summary.textContent = `${count(leasedShards)}, of your jobs ${shards.length}`;
  summary.setAttribute("aria-label", `Shards of ${name}`);
  list.replaceChildren(...shards.map((shard) => made("li", shardText(shard))));
  return before ? undefined : [details];
}

/** The first workers by name, as many as are shown. An answer may have fewer than were asked for, and not be the last. */
async function listWorkers(): Promise<{ workers: Worker[]; readTime?: Timestamp; areMore: boolean }> {
  const workers: Worker[] = [];
  for (let pageToken = ""; ;) {
    const answer = await unary("JobService/ListWorkers", ListWorkersRequestSchema,
      create(ListWorkersRequestSchema, { pageSize: kMostShown - workers.length, pageToken }), ListWorkersResponseSchema, options());
    workers.push(...answer.workers);
    pageToken = answer.nextPageToken;
    if (!pageToken || workers.length >= kMostShown) return { workers, readTime: answer.readTime, areMore: pageToken !== "" };
  }
}

export async function drawWorkers(): Promise<void> {
  const table = element("workers");
  try {
    const { workers, readTime, areMore } = await listWorkers();
    const more = areMore ? [`and more than these ${kMostShown}`] : [];
    const none = workers.length === 0 ? ["none was heard of"] : [];
    const lines = keptRows(table, [...workers.map((worker) => worker.name), ...none, ...more]);
    workers.forEach((worker, i) => {
      const line = lines[i]!;
      fillRow(line, worker.name, worker.algorithmVersion, stateOf(worker), ago(worker.seenTime, readTime),
        leases(worker, line.children[4]));
    });
    [...none, ...more].forEach((text, i) => fillRow(lines[workers.length + i]!, text, "", "", "", ""));
  } catch (error) {
    table.replaceChildren();
    const none = error instanceof RpcError && error.code === kUnimplemented;
    row(table, none ? "this server takes no jobs" : explain(error), "", "", "", "");
  }
}
