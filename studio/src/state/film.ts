// The number of segments, played like a film: one stop of the slider after the other, slowly while each one shows.
import { STOPS, stopOf } from "./state";

/** How long a number stays: the first ones change the figure most. */
const LONG_MS = 520;
const SHORT_MS = 160;
/** From here on one more segment is hard to see. */
const MANY = 10;

export class Film {
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** `show` is given each number and leaves the film running; `ended` hears of its end, whichever it was. */
  constructor(
    private readonly show: (segments: number) => void,
    private readonly ended: () => void,
  ) {}

  get isPlaying(): boolean {
    return this.timer !== undefined;
  }

  /** From a number of segments to the most, or once more from the first when that is where it stands. */
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
