// The field of the current script in GLSL, for the graphics card. Runs follow one another like drafts, so that the picture
// follows a drag.
import type { Files, Outcome } from "../core/command";
import { type Bench, type Line, isScript, reading } from "./document";
import { madeBy, reportOf } from "./outcome";
import type { State } from "./state";

/** The code of a refusal: a field that is no expression has no program. */
const UNSUPPORTED = "unsupported";
const OUTPUT = "field.glsl";

/** The part of the controller that it uses. */
interface Owner {
  state(): State;
  update(change: Partial<State>): void;
  run(line: Line, files: Files): Promise<Outcome | null>;
}

export class FieldSource {
  private isRunning = false;
  private newest: Bench | null = null;
  constructor(private readonly owner: Owner) {}

  /** Asks for the field of the current script, and of each that replaces it meanwhile. */
  async follow(): Promise<void> {
    if (this.isRunning) return;
    this.isRunning = true;
    const { owner } = this;
    try {
      while (this.newest !== owner.state().bench) {
        const { bench: current, field } = owner.state();
        this.newest = current;
        // A script with a mistake keeps the picture of the last one that worked; another file does not.
        if (field && field.bench.name !== current.name) owner.update({ field: null });
        const line = ["convert", ...reading(current), OUTPUT];
        const outcome = isScript(current) ? await owner.run(line, current.files) : null;
        const bytes = outcome && madeBy(outcome, line)?.[OUTPUT];
        if (bytes) owner.update({ field: { bench: current, source: new TextDecoder().decode(bytes) } });
        else if (outcome && reportOf(outcome).error?.code === UNSUPPORTED) owner.update({ field: null });
      }
    } finally {
      this.isRunning = false;
    }
  }
}
