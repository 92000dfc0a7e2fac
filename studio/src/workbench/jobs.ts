// The page's side of the workers. Work is in lanes, such as the preview and the proof: lanes run beside each other, and in a
// lane the newest order takes the place of an older one, whose worker is ended. The module is compiled once for all.
import type { Files, Outcome, Progress } from "./command";
import type { Order, Reply } from "./worker";

/** What a worker is to the lanes; tests bring their own. */
export interface WorkerLike {
  postMessage(order: Order): void;
  terminate(): void;
  onmessage: ((event: MessageEvent<Reply>) => void) | null;
  onerror: ((event: ErrorEvent) => void) | null;
}

/** How a run ended that gave no outcome. */
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
}

interface Lane {
  worker: WorkerLike;
  running: Running | null;
}

export class Jobs<Name extends string> {
  private readonly lanes = new Map<Name, Lane>();
  private next = 1;

  constructor(
    private readonly module: () => Promise<WebAssembly.Module>,
    private readonly create: () => WorkerLike,
  ) {}

  /** Runs the command. Rejected with [`Stopped`]: by a newer order of the lane, by [`cancel`], or by a trap. */
  async run(name: Name, words: readonly string[], files: Files, progressed: (progress: Progress) => void = () => undefined): Promise<Outcome> {
    const id = this.next++;
    this.end(name, "newer");
    const lane = this.lanes.get(name) ?? this.start(name);
    const done = new Promise<Outcome>((resolve, reject) => {
      lane.running = { id, resolve, reject, progressed };
    });
    // Whoever asks is told; here nobody needs to be.
    done.catch(() => undefined);
    const module = await this.module().catch((error: unknown) => {
      lane.running = null;
      throw new Stopped("unloaded", String(error));
    });
    // While the module was loaded, a newer order may have come.
    if (lane.running?.id === id) lane.worker.postMessage({ id, module, words, files });
    return done;
  }

  cancel(name: Name): void {
    this.end(name, "cancelled");
  }

  isRunning(name: Name): boolean {
    return Boolean(this.lanes.get(name)?.running);
  }

  private end(name: Name, why: "newer" | "cancelled"): void {
    const lane = this.lanes.get(name);
    if (!lane?.running) return;
    const { running } = lane;
    lane.running = null;
    this.drop(name, lane);
    running.reject(new Stopped(why));
  }

  private drop(name: Name, lane: Lane): void {
    lane.worker.onmessage = lane.worker.onerror = null;
    lane.worker.terminate();
    this.lanes.delete(name);
  }

  private start(name: Name): Lane {
    const lane: Lane = { worker: this.create(), running: null };
    this.lanes.set(name, lane);
    lane.worker.onmessage = ({ data }) => {
      const { running } = lane;
      if (data.id !== running?.id) return;
      if ("progress" in data) return running.progressed(data.progress);
      lane.running = null;
      if ("outcome" in data) return running.resolve(data.outcome);
      // What a trap leaves behind is not used again.
      this.drop(name, lane);
      running.reject(new Stopped("trapped", data.trapped));
    };
    lane.worker.onerror = (event) => {
      const { running } = lane;
      this.drop(name, lane);
      running?.reject(new Stopped("trapped", event.message));
    };
    return lane;
  }
}
