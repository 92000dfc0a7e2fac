// The address as a trail: what one did is undone by the browser's Back, step by step, before it leaves the page.

/** Changes of the same things within this time are one step: a drag, a run of key presses. */
const SAME_STEP_MS = 1500;
/** Choices about the page, which nobody goes back through. */
const QUIET = new Set(["language", "theme"]);

/** What of the browser's history a trail needs. */
export interface Book {
  push(fragment: string): void;
  replace(fragment: string): void;
}

export class Trail {
  private touched = new Set<string>();
  private last = "";
  private lastAt = -Infinity;

  /** `current` is the fragment that the page was opened with. */
  constructor(
    private readonly book: Book,
    private current: string,
  ) {}

  /** These parts of the state were changed. */
  touch(names: Iterable<string>): void {
    for (const name of names) this.touched.add(name);
  }

  /** Writes the fragment of what was touched since the last time: as a new step, or into the one that is being made. */
  write(fragment: string, now: number): void {
    const what = [...this.touched].filter((name) => !QUIET.has(name)).sort().join();
    this.touched.clear();
    if (fragment === this.current) return;
    const isNew = what !== "" && (what !== this.last || now - this.lastAt > SAME_STEP_MS);
    if (isNew) this.book.push(fragment);
    else this.book.replace(fragment);
    this.current = fragment;
    if (what !== "") [this.last, this.lastAt] = [what, now];
  }

  /** The browser has gone to another step. */
  arrive(fragment: string): void {
    this.touched.clear();
    this.current = fragment;
    this.last = "";
  }
}
