// The page's side of the worker. Only one call runs at a time, and for each kind only the newest question waits; a page with
// several figures gives each its own key instead. If the module traps or the worker does not answer, a new worker replaces it, and the newest questions are asked again.
import type { AnswerOf, Call, Kind, QuestionOf, Reply } from "./types";

/** The part of `Worker` that the engine uses; tests pass their own. */
export interface WorkerLike {
  postMessage(call: Call): void;
  terminate(): void;
  onmessage: ((event: MessageEvent<Reply>) => void) | null;
  onerror: ((event: ErrorEvent) => void) | null;
}

/** A failure: the worker was restarted, or failed too often and was given up, or the core refused a question. */
export type Trouble = { what: "rebuilt" } | { what: "lost" } | { what: "refused"; why: string };

export interface Listener {
  answered<K extends Kind>(kind: K, answer: AnswerOf<K>, question: QuestionOf<K>, key: string): void;
  /** With the key of the question, if it is about one. */
  troubled(trouble: Trouble, key?: string): void;
}

/** Urgent kinds first: the figure under the finger before the plot. */
const ORDER: readonly Kind[] = ["study", "seam", "ladder", "exhibit"];
/** After this many failures in a row without an answer, the engine gives up. */
const MOST_FAILURES = 3;
/** After this many failures of one figure among several, that figure is given up, and the others go on. */
const MOST_FAILURES_OF_ONE = 2;
/** An answer takes some milliseconds. A worker that is silent for this long hangs or never started. */
const PATIENCE_MS = 15_000;

export class Engine {
  private worker: WorkerLike;
  private waitingQuestions = new Map<string, { kind: Kind; question: QuestionOf<Kind> }>();
  private currentCall: Call | null = null;
  private currentKey = "";
  private timer: ReturnType<typeof setTimeout> | undefined;
  private nextId = 1;
  private failures = 0;
  /** Of each figure that has a key of its own. */
  private readonly failuresByKey = new Map<string, number>();
  private isLost = false;

  constructor(
    private readonly create: () => WorkerLike,
    private readonly listener: Listener,
  ) {
    this.worker = this.start();
  }

  /** Asks a question, which replaces a waiting one with the same key. */
  ask<K extends Kind>(kind: K, question: QuestionOf<K>, key: string = kind): void {
    if (this.isLost) return;
    this.waitingQuestions.set(key, { kind, question });
    this.send();
  }

  /** Forgets a waiting question, whose figure is out of sight. Returns whether there was one. */
  forget(key: string): boolean {
    return this.waitingQuestions.delete(key);
  }

  /** Whether all questions are answered. */
  get isIdle(): boolean {
    return this.currentCall === null && this.waitingQuestions.size === 0;
  }

  private start(): WorkerLike {
    const worker = this.create();
    worker.onmessage = (event) => this.receive(event.data);
    worker.onerror = () => this.fail();
    return worker;
  }

  private send(): void {
    if (this.currentCall) return;
    const waiting = [...this.waitingQuestions];
    const [key, next] = ORDER.flatMap((kind) => waiting.find(([, question]) => question.kind === kind) ?? []) as Partial<(typeof waiting)[number]>;
    if (key === undefined || !next) return;
    this.waitingQuestions.delete(key);
    this.currentKey = key;
    this.currentCall = { id: this.nextId++, ...next };
    this.timer = setTimeout(() => this.fail(), PATIENCE_MS);
    this.worker.postMessage(this.currentCall);
  }

  private receive(reply: Reply): void {
    const call = this.currentCall;
    // A late reply to an earlier call, or one of a worker that was replaced.
    if (!call || reply.id !== call.id) return;
    if ("broken" in reply) return this.fail();
    this.currentCall = null;
    clearTimeout(this.timer);
    this.failures = 0;
    const key = this.currentKey;
    this.failuresByKey.delete(key);
    // Before the answer is shown, so that the worker computes while the page draws.
    this.send();
    if ("answer" in reply) this.listener.answered(call.kind, reply.answer as never, call.question as never, key);
    else this.listener.troubled({ what: "refused", why: reply.refused }, key);
  }

  /** Replaces the worker. Its question is asked again, unless a newer one with the same key waits. */
  private fail(): void {
    clearTimeout(this.timer);
    // A message may be on its way already.
    this.worker.onmessage = this.worker.onerror = null;
    this.worker.terminate();
    const call = this.currentCall;
    this.currentCall = null;
    this.failures += 1;
    if (this.failures >= MOST_FAILURES) {
      this.isLost = true;
      this.waitingQuestions.clear();
      this.listener.troubled({ what: "lost" });
      return;
    }
    const key = this.currentKey;
    const failures = (this.failuresByKey.get(key) ?? 0) + 1;
    const isGivenUp = call !== null && key !== call.kind && failures >= MOST_FAILURES_OF_ONE;
    this.failuresByKey.set(key, failures);
    if (isGivenUp) this.waitingQuestions.delete(key);
    else if (call && !this.waitingQuestions.has(key)) this.waitingQuestions.set(key, call);
    this.worker = this.start();
    if (isGivenUp) this.listener.troubled({ what: "lost" }, key);
    else this.listener.troubled({ what: "rebuilt" });
    this.send();
  }
}
