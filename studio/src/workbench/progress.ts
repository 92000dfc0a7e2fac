// How long a run probably still takes.
import type { Progress } from "../core/command";
import type { Running } from "./state";

/** The time left is told from so far on: earlier it jumps. */
const LEFT_AFTER = { seconds: 2, percent: 3 };

/** A stage's progress with the seconds that it probably still takes: as fast as so far. */
export function withLeft(progress: Progress, before: Running | undefined): Running {
  const now = performance.now();
  const since = before?.stage === progress.stage ? before.since : { at: now, percent: progress.percent };
  const [seconds, done] = [(now - since.at) / 1000, progress.percent - since.percent];
  const isKnown = seconds >= LEFT_AFTER.seconds && done >= LEFT_AFTER.percent;
  return { ...progress, since, left: isKnown ? (seconds * (100 - progress.percent)) / done : null };
}
