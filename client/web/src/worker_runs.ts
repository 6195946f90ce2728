// The worker that meshes, seen from the page: which run its messages are of, and what becomes of one that fails.
import type { FromWorker, Order, ToWorker } from "./mesh_worker";

export class WorkerRuns {
  private worker?: Worker;
  private run = 0;

  /** `take` gets what is told of the newest run; `lose` is called with a reason where the worker fails. */
  constructor(private readonly take: (message: FromWorker) => void, private readonly lose: (why: string) => void) {
    this.worker = this.started();
  }

  /** Begins the next run; the one before ends. */
  start(order: Order & { kind: "start" }): void {
    this.worker ??= this.started();
    ++this.run;
    this.send(order);
  }

  send(order: Order, run = this.run): void {
    const message: ToWorker = { ...order, run };
    this.worker?.postMessage(message);
  }

  private started(): Worker {
    const worker = new Worker(new URL("./mesh_worker.ts", import.meta.url), { type: "module" });
    worker.onmessage = ({ data }: MessageEvent<FromWorker>) => {
      // A file is what somebody asked for, whatever is meshed now.
      if (data.run === this.run || data.kind === "saved" || data.kind === "unable") this.take(data);
    };
    worker.onerror = (event) => this.end(worker, event.message || "it could not be started");
    worker.onmessageerror = () => this.end(worker, "what it made could not be read");
    return worker;
  }

  /** Nobody knows what such a worker still does: the next run has another. */
  private end(worker: Worker, why: string): void {
    worker.terminate();
    if (this.worker !== worker) return;
    this.worker = undefined;
    this.lose(why);
  }
}
