// The page's side of the worker. One call is under way at a time; of each kind only the newest question waits. A worker
// whose module trapped, or that does not answer, is replaced by a new one, and the newest questions are asked again.
import type { AnswerOf, Call, Kind, QuestionOf, Reply } from "./types";

/** What a worker is to the engine; tests bring their own. */
export interface WorkerLike {
  postMessage(call: Call): void;
  terminate(): void;
  onmessage: ((event: MessageEvent<Reply>) => void) | null;
  onerror: ((event: ErrorEvent) => void) | null;
}

/** Something went wrong: the worker was rebuilt, or could not be kept alive, or the core refused a question. */
export type Trouble = { what: "rebuilt" } | { what: "lost" } | { what: "refused"; why: string };

export interface Listener {
  answered<K extends Kind>(kind: K, answer: AnswerOf<K>, question: QuestionOf<K>): void;
  troubled(trouble: Trouble): void;
}

/** What matters more is asked first: the figure under the finger before the plot. */
const ORDER: readonly Kind[] = ["study", "seam", "ladder", "exhibit"];
/** A worker that broke this often in a row, without one answer between, is given up. */
const MOST_FAILURES = 3;
/** An answer takes some milliseconds. A worker that is silent for this long hangs or never started. */
const PATIENCE_MS = 15_000;

export class Engine {
  private worker: WorkerLike;
  private waiting = new Map<Kind, QuestionOf<Kind>>();
  private current: Call | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private next = 1;
  private failures = 0;
  private isLost = false;

  constructor(
    private readonly create: () => WorkerLike,
    private readonly listener: Listener,
  ) {
    this.worker = this.start();
  }

  /** Asks; a newer question of the same kind takes the place of one that still waits. */
  ask<K extends Kind>(kind: K, question: QuestionOf<K>): void {
    if (this.isLost) return;
    this.waiting.set(kind, question);
    this.send();
  }

  /** Whether every question has had its answer. */
  get isIdle(): boolean {
    return this.current === null && this.waiting.size === 0;
  }

  private start(): WorkerLike {
    const worker = this.create();
    worker.onmessage = (event) => this.receive(event.data);
    worker.onerror = () => this.fail();
    return worker;
  }

  private send(): void {
    if (this.current) return;
    const kind = ORDER.find((kind) => this.waiting.has(kind));
    if (!kind) return;
    const question = this.waiting.get(kind)!;
    this.waiting.delete(kind);
    this.current = { id: this.next++, kind, question };
    this.timer = setTimeout(() => this.fail(), PATIENCE_MS);
    this.worker.postMessage(this.current);
  }

  private receive(reply: Reply): void {
    const call = this.current;
    // A late word from before is of no interest.
    if (!call || reply.id !== call.id) return;
    if ("broken" in reply) return this.fail();
    this.current = null;
    clearTimeout(this.timer);
    this.failures = 0;
    this.send();
    if ("answer" in reply) this.listener.answered(call.kind, reply.answer as never, call.question as never);
    else this.listener.troubled({ what: "refused", why: reply.refused });
  }

  /** The worker is of no more use. Its question is asked again, unless a newer one waits. */
  private fail(): void {
    clearTimeout(this.timer);
    this.worker.onmessage = this.worker.onerror = null;
    this.worker.terminate();
    const call = this.current;
    this.current = null;
    this.failures += 1;
    if (this.failures >= MOST_FAILURES) {
      this.isLost = true;
      this.waiting.clear();
      this.listener.troubled({ what: "lost" });
      return;
    }
    if (call && !this.waiting.has(call.kind)) this.waiting.set(call.kind, call.question);
    this.worker = this.start();
    this.listener.troubled({ what: "rebuilt" });
    this.send();
  }
}
