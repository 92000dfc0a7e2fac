// Brings the figures to life when they are seen, and lets them sleep when they are not. All share one worker.
import { render } from "preact";
import type { Trouble } from "../core/engine";
import { FRAME } from "../exhibits/frame_texts";
import { type Change, Desk, Run } from "../exhibits/run";
import type { Language } from "../exhibits/say";
import { Bench } from "./Bench";
import { loaded } from "./figures";
import { REVEALED } from "./guesses";
import { handles } from "./handles";

const html = document.documentElement;
const language: Language = html.lang.startsWith("zh") ? "zh" : "en";

/** A figure of the page, by its id. */
export class Placed {
  readonly id: string;
  /** Called after each new state. */
  followers: ((state: Record<string, unknown>) => void)[] = [];
  isSeen = false;
  private run: Run | undefined;
  private starting: Promise<Run> | undefined;
  private frame = 0;
  private isDrawn = false;
  private notes: readonly string[] = [];

  constructor(
    private readonly desk: Desk,
    readonly element: HTMLElement,
  ) {
    this.id = element.dataset["figureOf"]!;
  }

  get isLocked(): boolean {
    return "locked" in this.element.dataset;
  }

  unlock(): void {
    delete this.element.dataset["locked"];
    if (this.isSeen) void this.start();
  }

  see(isSeen: boolean): void {
    this.isSeen = isSeen;
    if (isSeen && !this.isLocked) void this.start();
    else if (!isSeen) this.run?.forget();
    this.draw();
  }

  /** A change by a handle of the text, which may come before the figure was seen. */
  async set(change: Change): Promise<void> {
    (await this.start()).set(change);
  }

  private start(): Promise<Run> {
    this.starting ??= loaded(this.id).then((exhibit) => {
      const first = JSON.parse(this.element.dataset["state"]!) as object;
      const state = { ...(exhibit.defaults as object), ...first };
      this.run = new Run(this.desk, this.id, this.id, exhibit, state, { changed: this.draw, troubled: this.troubled });
      return this.run;
    });
    return this.starting.then((run) => {
      if (this.isSeen) run.ask();
      return run;
    });
  }

  private troubled = (trouble: Trouble): void => {
    const words = FRAME[language];
    const note = trouble.what === "refused" ? words.refused(trouble.why) : words[trouble.what];
    this.notes = [...this.notes.filter((old) => old !== note), note];
    this.draw();
  };

  private draw = (): void => {
    delete html.dataset["settled"];
    this.frame ||= requestAnimationFrame(() => {
      this.frame = 0;
      this.render();
      if (this.desk.isIdle) html.dataset["settled"] = "1";
    });
  };

  private render(): void {
    const { run } = this;
    // Until the first answer the still is shown.
    if (!run || run.answer === undefined) return;
    // Asleep it is drawn once more, to give its WebGL context back.
    const isAwake = this.isSeen;
    if (!isAwake && this.element.dataset["live"] === "asleep") return;
    const slot = this.element.querySelector<HTMLElement>(".bench")!;
    if (!this.isDrawn) slot.replaceChildren();
    this.isDrawn = true;
    render(
      <Bench
        id={this.id}
        exhibit={run.exhibit}
        state={run.state}
        answer={run.answer}
        language={language}
        isStill={false}
        isAwake={isAwake}
        isByHand={"byHand" in this.element.dataset}
        notes={this.notes}
        set={(change) => run.set(change)}
      />,
      slot,
    );
    this.element.dataset["live"] = isAwake ? "awake" : "asleep";
    for (const follow of this.followers) follow(run.state as Record<string, unknown>);
  }
}

export function live(): void {
  const desk = new Desk();
  const placed = new Map<Element, Placed>();
  for (const element of document.querySelectorAll<HTMLElement>("[data-figure-of]")) placed.set(element, new Placed(desk, element));
  const observer = new IntersectionObserver((entries) => {
    for (const entry of entries) placed.get(entry.target)?.see(entry.isIntersecting);
  });
  for (const element of placed.keys()) observer.observe(element);
  document.addEventListener(REVEALED, (event) => {
    const id = (event.target as HTMLElement).dataset["guess"];
    for (const figure of placed.values()) if (figure.element.dataset["locked"] === id) figure.unlock();
  });
  handles([...placed.values()]);
  const hero = document.querySelector<HTMLElement>("[data-hero]");
  if (hero) void import("./hero_live").then(({ heroLive }) => heroLive(hero, language));
}
