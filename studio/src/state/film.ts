// Plays the number of segments like a film: one stop of the slider after the other, slowly while each step is visible.
import { STOPS, stopOf } from "./state";

/** How long a number is shown. Longer below `MANY`, where each number changes the figure most. */
const LONG_MS = 520;
const SHORT_MS = 160;
/** From this number on, one more segment is hard to see. */
const MANY = 10;

export class Film {
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** `show` receives each number and must not stop the film; `ended` is called at the end, also after `stop`. */
  constructor(
    private readonly show: (segments: number) => void,
    private readonly ended: () => void,
  ) {}

  get isPlaying(): boolean {
    return this.timer !== undefined;
  }

  /** Plays from a number of segments to the largest; from the first one if it is at the largest already. */
  start(segments: number): void {
    const from = stopOf(segments);
    this.step(from === STOPS.length - 1 ? -1 : from);
  }

  stop(): void {
    if (this.timer === undefined) return;
    clearTimeout(this.timer);
    this.timer = undefined;
    this.ended();
  }

  private step(stop: number): void {
    if (stop >= 0) this.show(STOPS[stop]!);
    const next = stop + 1;
    if (next >= STOPS.length) return this.stop();
    const wait = stop < 0 ? 0 : STOPS[stop]! < MANY ? LONG_MS : SHORT_MS;
    this.timer = setTimeout(() => this.step(next), wait);
  }
}
