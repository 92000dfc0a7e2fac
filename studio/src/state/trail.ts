// The browser's history as a trail: Back undoes the reader's changes step by step before it leaves the page.

/** Changes of the same parts within this time are one step: a drag, a run of key presses. */
const SAME_STEP_MS = 1500;
/** Choices about the page itself, which are no steps of their own. */
const QUIET = new Set(["language", "theme"]);

/** The part of the browser's history that a trail uses. */
export interface Book {
  push(fragment: string): void;
  replace(fragment: string): void;
}

export class Trail {
  private touched = new Set<string>();
  private last = "";
  private lastAt = -Infinity;

  /** `current` is the fragment with which the page was opened. */
  constructor(
    private readonly book: Book,
    private current: string,
  ) {}

  /** Records that these parts of the state were changed. */
  touch(names: Iterable<string>): void {
    for (const name of names) this.touched.add(name);
  }

  /** Writes the fragment: as a new step, or into the last step if the same parts changed again. */
  write(fragment: string, now: number): void {
    const names = [...this.touched].filter((name) => !QUIET.has(name)).sort().join();
    this.touched.clear();
    if (fragment === this.current) return;
    const isNew = names !== "" && (names !== this.last || now - this.lastAt > SAME_STEP_MS);
    if (isNew) this.book.push(fragment);
    else this.book.replace(fragment);
    this.current = fragment;
    if (names !== "") [this.last, this.lastAt] = [names, now];
  }

  /** Call after the browser went to another step. */
  arrive(fragment: string): void {
    this.touched.clear();
    this.current = fragment;
    this.last = "";
  }
}
