// The shards of a job as a bar: done, with a worker, waiting, failed for good.
import { JobState, type Job } from "../generated/tetstream/v1/jobs_pb";
import { count, made } from "./page";

/** What there are of each kind, in the order of the bar; the names are those of page.css, too. */
export function shardKinds({ progress, state }: Job): [string, number][] {
  const all = Number(progress?.shardCount ?? 0), done = Number(progress?.doneShards ?? 0);
  const dead = Number(progress?.deadShards ?? 0), running = Number(progress?.runningShards ?? 0);
  // Shards of a job that ended before they were made count as dead, whatever it ended by.
  const dropped = state === JobState.CANCELLED || state === JobState.EXPIRED;
  return [["done", done], ["running", running], [dropped ? "dropped" : "failed", dead],
    ["waiting", Math.max(0, all - done - running - dead)]];
}

/** The bar, and the same in words. */
export function shardsOf(job: Job): HTMLElement[] {
  const kinds = shardKinds(job).filter(([, shards]) => shards > 0);
  const all = kinds.reduce((sum, [, shards]) => sum + shards, 0);
  const counted = Number(job.progress?.chunkCount ?? 0) > 0;
  const what = all === 0 ? "none yet" : kinds.map(([kind, shards]) => `${count(shards)} ${kind}`).join(", ");
  const bar = made("div");
  bar.className = "shards";
  bar.setAttribute("role", "img");
  bar.setAttribute("aria-label", `Shards of ${job.displayName || job.name}: ${what}`);
  for (const [kind, shards] of kinds) {
    const part = made("span", "", bar);
    part.className = kind;
    part.dataset["shards"] = String(shards);
    part.style.flexGrow = String(shards);
  }
  return [bar, made("span", all > 0 && !counted ? `counting: ${what}` : what)];
}
