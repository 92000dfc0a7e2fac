// The page's side of the workers. Runs are assigned to lanes, such as draft and proof: lanes run in parallel, and in a lane
// a new run cancels the previous one by ending its worker. The module is compiled once for all workers.
import type { Files, Outcome, Progress } from "./command";
import type { Order, Reply } from "./command_worker";
import { type Crews, MOST_DROPPED_BYTES, type Share } from "./crew";

/** The part of `Worker` that the lanes use; tests pass their own. */
export interface WorkerLike {
  postMessage(order: Order): void;
  terminate(): void;
  onmessage: ((event: MessageEvent<Reply>) => void) | null;
  onerror: ((event: ErrorEvent) => void) | null;
}

/** Why a run ended without an outcome. */
export class Stopped extends Error {
  constructor(
    readonly why: "newer" | "cancelled" | "trapped" | "unloaded",
    message = why as string,
  ) {
    super(message);
  }
}

interface Running {
  id: number;
  resolve(outcome: Outcome): void;
  reject(error: Stopped): void;
  progressed(progress: Progress): void;
  share?: Share | undefined;
}

interface Lane {
  worker: WorkerLike;
  running: Running | null;
  /** Of the memories that this worker has dropped. */
  bytes: number;
}

export class Jobs<Name extends string> {
  private readonly lanes = new Map<Name, Lane>();
  private nextId = 1;

  constructor(
    private readonly module: () => Promise<WebAssembly.Module>,
    private readonly create: () => WorkerLike,
    /** Where workers may share memory: who carries the threads of runs. */
    private readonly crews?: Crews,
    /** Whether the runs of a lane have threads. */
    private readonly hasThreads: (name: Name) => boolean = () => true,
  ) {}

  /** Runs the command. Rejects with [`Stopped`] after a newer run in the lane, [`cancel`], or a trap. */
  async run(name: Name, words: readonly string[], files: Files, progressed: (progress: Progress) => void = () => undefined): Promise<Outcome> {
    const id = this.nextId++;
    this.stop(name, "newer");
    // `stop` has ended a busy worker; an idle one is used again.
    const lane = this.lanes.get(name) ?? this.start(name);
    const outcome = new Promise<Outcome>((resolve, reject) => {
      lane.running = { id, resolve, reject, progressed };
    });
    // The caller handles the rejection; this only prevents an unhandled one while the module loads.
    outcome.catch(() => undefined);
    // If the module cannot be loaded, only this lane is freed: a newer run has a lane of its own.
    const module = await this.module().catch((error: unknown) => {
      lane.running = null;
      throw new Stopped("unloaded", String(error));
    });
    // A newer run may have started while the module was loading.
    const { running } = lane;
    if (running?.id !== id) return outcome;
    if (this.hasThreads(name)) {
      const failed = (why: string) => lane.running === running && this.fail(name, lane, why);
      running.share = this.crews?.share(module, (progress) => lane.running === running && progressed(progress), failed);
    }
    lane.worker.postMessage({ id, module, words, files, crew: running.share?.crew });
    return outcome;
  }

  cancel(name: Name): void {
    this.stop(name, "cancelled");
  }

  isRunning(name: Name): boolean {
    return Boolean(this.lanes.get(name)?.running);
  }

  private stop(name: Name, why: "newer" | "cancelled"): void {
    const lane = this.lanes.get(name);
    if (!lane?.running) return;
    this.end(name, lane, new Stopped(why));
  }

  private fail(name: Name, lane: Lane, why: string): void {
    this.end(name, lane, new Stopped("trapped", why));
  }

  /** Ends a lane with its run, wherever that is. */
  private end(name: Name, lane: Lane, why: Stopped): void {
    const { running } = lane;
    lane.running = null;
    this.drop(name, lane);
    running?.share?.end();
    running?.reject(why);
  }

  private drop(name: Name, lane: Lane): void {
    lane.worker.onmessage = lane.worker.onerror = null;
    lane.worker.terminate();
    this.lanes.delete(name);
  }

  private start(name: Name): Lane {
    const lane: Lane = { worker: this.create(), running: null, bytes: 0 };
    this.lanes.set(name, lane);
    lane.worker.onmessage = ({ data }) => {
      const { running } = lane;
      if (data.id !== running?.id) return;
      if ("progress" in data) return running.progressed(data.progress);
      // After a trap the instance may be in any state, so its worker is not reused.
      if ("trapped" in data) return this.fail(name, lane, data.trapped);
      lane.running = null;
      running.share?.over();
      lane.bytes += data.bytes;
      if (lane.bytes > MOST_DROPPED_BYTES) this.drop(name, lane);
      running.resolve(data.outcome);
    };
    lane.worker.onerror = (event) => this.fail(name, lane, event.message);
    return lane;
  }
}
