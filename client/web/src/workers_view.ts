// The table of workers: who they are, what they hold, and what keeps them from working.
import { create } from "@bufbuild/protobuf";
import { timestampMs, type Timestamp } from "@bufbuild/protobuf/wkt";
import { ListWorkersRequestSchema, ListWorkersResponseSchema, type LeasedShard,
  type Worker } from "../generated/tetstream/v1/jobs_pb";
import { count, element, explain, made, options, row } from "./page";
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

/** How many shards it has; what they are, to be opened, as far as they are the caller's. */
function leases({ leasedShards, shards, name }: Worker): string | HTMLElement {
  if (shards.length === 0) return count(leasedShards);
  const details = made("details");
  made("summary", `${count(leasedShards)}, of your jobs ${shards.length}`, details).setAttribute("aria-label", `Shards of ${name}`);
  const list = made("ul", "", details);
  for (const shard of shards) made("li", shardText(shard), list);
  return details;
}

export async function drawWorkers(): Promise<void> {
  const table = element("workers");
  try {
    const answer = await unary("JobService/ListWorkers", ListWorkersRequestSchema,
      create(ListWorkersRequestSchema, { pageSize: kMostShown }), ListWorkersResponseSchema, options());
    // What is open stays so.
    const open = new Set([...table.querySelectorAll("tr:has(details[open])")].map((line) => line.firstElementChild?.textContent));
    table.replaceChildren();
    for (const worker of answer.workers) {
      row(table, worker.name, worker.algorithmVersion, stateOf(worker), ago(worker.seenTime, answer.readTime), leases(worker));
      const details = table.lastElementChild!.querySelector("details");
      if (details && open.has(worker.name)) details.open = true;
    }
    if (answer.workers.length === 0) row(table, "none was heard of", "", "", "", "");
    if (answer.nextPageToken) row(table, `and more than these ${kMostShown}`, "", "", "", "");
  } catch (error) {
    table.replaceChildren();
    const none = error instanceof RpcError && error.code === kUnimplemented;
    row(table, none ? "this server takes no jobs" : explain(error), "", "", "", "");
  }
}
