// The workers that carry the threads of the page's runs. A run gets those that are free at its start, and gives them back when
// it is over; there are as many as the machine has cores beside the one of a run, whatever number of runs there is.
import { type Crew, type Progress, runMemory } from "./command";
import { ThreadSlots } from "./thread_slots";
import type { ThreadOrder, ThreadReply } from "./thread_worker";

/** The part of `Worker` that a crew uses; tests pass their own. */
export interface ThreadWorkerLike {
  postMessage(order: ThreadOrder): void;
  terminate(): void;
  onmessage: ((event: MessageEvent<ThreadReply>) => void) | null;
  onerror: ((event: ErrorEvent) => void) | null;
}

/**
 * A worker that has had memories of so many bytes is replaced while it has nothing to do. Chosen: a few proofs, or some ten
 * drafts. A browser may keep the memory of a run that is over until it looks for what is no longer used, and shared memory
 * does not make it look.
 */
export const MOST_DROPPED_BYTES = 2 ** 29;

/** Chosen: few jobs have work for more, and every worker takes megabytes. */
const MOST_THREADS = 8;

/** The threads that a run of this page may have, its own among them: one where workers may not share memory. */
export const threadsOfPage = (): number => (globalThis.crossOriginIsolated ? Math.min(navigator.hardwareConcurrency || 1, MOST_THREADS) : 1);

/** What a run has of the crew. */
export interface Share {
  readonly crew: Crew;
  /** The run is over: workers whose threads have not ended by the next run are terminated. */
  over(): void;
  /** Ends the threads wherever they are. */
  end(): void;
}

export class Crews {
  private readonly free = new Set<ThreadWorkerLike>();
  /** Of runs that are over, those that still have workers. */
  private readonly late = new Set<Share>();
  private count = 0;
  /** Of the memories that these workers have had. */
  private bytes = 0;

  constructor(
    private readonly create: () => ThreadWorkerLike,
    /** Beside the worker of a run. */
    private readonly most: number,
  ) {}

  /** Hands the free workers to a run, unless there are none. After `trapped`, the run cannot end by itself. */
  share(module: WebAssembly.Module, progressed: (progress: Progress) => void, trapped: (why: string) => void): Share | undefined {
    for (const share of this.late) share.end();
    if (this.bytes > MOST_DROPPED_BYTES) {
      for (const worker of this.free) this.discard(worker);
      this.bytes = 0;
    }
    for (; this.count < this.most; this.count++) this.free.add(this.create());
    const workers = [...this.free];
    if (workers.length === 0) return undefined;
    this.free.clear();
    const crew: Crew = { memory: runMemory(), slots: ThreadSlots.of(workers.length).memory, count: workers.length };
    const busy = new Set(workers);
    const share: Share = {
      crew,
      over: () => {
        this.bytes += crew.memory.buffer.byteLength;
        if (busy.size > 0) this.late.add(share);
      },
      end: () => {
        for (const worker of busy) this.discard(worker);
        busy.clear();
        this.late.delete(share);
      },
    };
    workers.forEach((worker, slot) => {
      worker.onmessage = ({ data }) => {
        if (data === "free") {
          // Not the handlers of the run, which would keep its memory.
          worker.onmessage = null;
          worker.onerror = () => this.discard(worker);
          this.free.add(worker);
          busy.delete(worker);
          if (busy.size === 0) this.late.delete(share);
        } else if ("progress" in data) progressed(data.progress);
        else trapped(data.trapped);
      };
      worker.onerror = (event) => trapped(event.message);
      worker.postMessage({ module, ...crew, slot });
    });
    return share;
  }

  private discard(worker: ThreadWorkerLike): void {
    worker.onmessage = worker.onerror = null;
    worker.terminate();
    this.free.delete(worker);
    this.count -= 1;
  }
}
