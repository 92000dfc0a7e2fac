// A figure that follows its state, on a page of one exhibit or of many: asks the core, keeps the newest answer. All figures of a
// page share one worker.
import { Engine, type Trouble } from "../core/engine";
import type { AnyExhibit } from "./exhibit";

export type Change = object | ((state: object) => object);

interface Listener {
  /** After a new state or answer. */
  changed(): void;
  troubled(trouble: Trouble): void;
}

/** The worker of a page, and its figures by their keys. */
export class Desk {
  private readonly runs = new Map<string, Run>();
  private started: Engine | undefined;

  /** Started with the first question, so that a page whose figures are not seen loads no core. */
  get engine(): Engine {
    return (this.started ??= this.start());
  }

  /** Whether all questions are answered. */
  get isIdle(): boolean {
    return this.started?.isIdle ?? true;
  }

  private start = () => new Engine(() => new Worker(new URL("./worker.ts", import.meta.url), { type: "module" }), {
    answered: (_, answer, __, key) => this.runs.get(key)?.answered(answer),
    troubled: (trouble, key) => {
      const concerned = key === undefined ? [...this.runs.values()] : [this.runs.get(key)];
      for (const run of concerned) run?.listener.troubled(trouble);
    },
  });

  forget(key: string): boolean {
    return this.started?.forget(key) ?? false;
  }

  add(key: string, run: Run): void {
    this.runs.set(key, run);
  }
}

export class Run {
  answer: unknown;
  private lastQuestion = "";

  constructor(
    private readonly desk: Desk,
    private readonly key: string,
    /** The exhibit's name, for the core. */
    private readonly id: string,
    readonly exhibit: AnyExhibit,
    public state: object,
    readonly listener: Listener,
  ) {
    desk.add(key, this);
  }

  /** Asks the question of the current state, unless it is the one that was asked last. */
  ask(): void {
    if (this.exhibit.isIdle?.(this.state)) {
      if (this.answer === undefined) this.answered({});
      return;
    }
    const question = { exhibit: this.id, ...this.exhibit.question(this.state) };
    const text = JSON.stringify(question);
    if (text === this.lastQuestion) return;
    this.lastQuestion = text;
    this.desk.engine.ask("exhibit", question, this.key);
  }

  /** Takes a waiting question back; the next `ask` asks it again. */
  forget(): void {
    if (this.desk.forget(this.key)) this.lastQuestion = "";
  }

  set(change: Change): void {
    this.state = { ...this.state, ...(typeof change === "function" ? change(this.state) : change) };
    this.ask();
    this.listener.changed();
  }

  answered(answer: unknown): void {
    this.answer = answer;
    this.listener.changed();
  }
}
