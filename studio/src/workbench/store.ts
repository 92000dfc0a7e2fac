// The state of the workbench, and who waits for a change of it.
import type { Bench } from "./document";
import { HOME } from "./stage/framing";
import type { State } from "./state";

export class Store {
  state: State;
  private awaited: { test: (state: State) => boolean; resolve: () => void }[] = [];

  constructor(
    first: Bench,
    private readonly notify: () => void,
  ) {
    this.state = {
      bench: first,
      past: [],
      future: [],
      shown: null,
      fault: null,
      moreFaults: [],
      inspection: null,
      witnesses: [],
      progress: {},
      running: [],
      beside: "traced",
      picture: null,
      field: null,
      slice: null,
      levels: null,
      trace: null,
      view: HOME,
      home: HOME,
      size: { width: 720, height: 480 },
      notice: null,
      exported: null,
      carried: null,
      link: null,
      isWaiting: false,
      ended: null,
    };
  }

  update(change: Partial<State>): void {
    this.state = { ...this.state, ...change };
    const due = this.awaited.filter(({ test }) => test(this.state));
    if (due.length) this.awaited = this.awaited.filter((one) => !due.includes(one));
    due.forEach(({ resolve }) => resolve());
    this.notify();
  }

  /** Resolves as soon as the state is as a test asks. */
  until(test: (state: State) => boolean): Promise<void> {
    if (test(this.state)) return Promise.resolve();
    return new Promise((resolve) => this.awaited.push({ test, resolve }));
  }
}
