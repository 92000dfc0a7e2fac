// Runs of the command, each in a lane: what of them is seen while they run, and why one ended without a result.
import type { Files, Outcome } from "../core/command";
import { type Jobs, Stopped } from "../core/jobs";
import { type Line, without } from "./document";
import { KEEP_BEST } from "./outcome";
import { withLeft } from "./progress";
import type { LaneName } from "./state";
import type { Store } from "./store";

/** The command's exit code for an unknown option. */
const USAGE = 2;

export const keepingBest = (line: Line): Line => (line.includes(KEEP_BEST) ? line : [...line, KEEP_BEST]);

export class Runs {
  constructor(
    private readonly jobs: Jobs<LaneName>,
    private readonly store: Store,
  ) {}

  cancel(lane: LaneName): void {
    this.jobs.cancel(lane);
  }

  /** Runs a line. If the verb does not know an option of the bench, runs it again without. Returns the line that was run. */
  async runSupported(lane: LaneName, line: Line, files: Files, isReport: boolean): Promise<{ outcome: Outcome; line: Line } | null> {
    const outcome = await this.run(lane, line, files, isReport);
    if (!outcome) return null;
    const unknown = outcome.exit === USAGE && /unexpected argument '(-[\w-]+)/.exec(`${outcome.stderr}${outcome.stdout}`)?.[1];
    const shorter = unknown ? without(line, unknown) : line;
    // Each further run has fewer words, so this ends.
    return shorter.length < line.length ? this.runSupported(lane, shorter, files, isReport) : { outcome, line };
  }

  async run(lane: LaneName, words: Line, files: Files, isReport: boolean): Promise<Outcome | null> {
    const setRunning = (isOn: boolean) => {
      const { running, progress } = this.store.state;
      const { [lane]: _, ...rest } = progress;
      this.store.update({ running: isOn ? [...running.filter((one) => one !== lane), lane] : running.filter((one) => one !== lane), progress: rest });
    };
    setRunning(true);
    try {
      const args = isReport ? [...words, "--json"] : words;
      return await this.jobs.run(lane, args, files, (progress) => this.store.update({ progress: { ...this.store.state.progress, [lane]: withLeft(progress, this.store.state.progress[lane]) } }));
    } catch (error) {
      if (error instanceof Stopped && error.why === "unloaded") this.store.update({ notice: "unloaded" });
      else if (error instanceof Stopped && error.why === "trapped") {
        // The last line is the browser's, and the lines before it may be warnings.
        const last = error.message.split("\n").slice(0, -1).findLast((line) => line && !line.includes("warning:"));
        this.store.update({ notice: "trapped", fault: last ? { text: last } : null });
      } else if (!(error instanceof Stopped)) throw error;
      return null;
    } finally {
      // A newer job may have taken the lane over.
      if (!this.jobs.isRunning(lane)) setRunning(false);
    }
  }
}
