// Takes a shape of the reader's own through the lesson: the dialogue that brings it, the line at the top that names it, and its
// stations, which run when they are about to be seen and sleep when they are not, as the figures do.
import "./own.css";
import { render } from "preact";
import { Awake } from "../../exhibits/Scene";
import type { Language } from "../../exhibits/say";
import { BenchSay } from "../../workbench/words";
import { opened } from "../../workbench/opened";
import type { StationId } from "../outline";
import { loadSentences } from "../../workbench/command_zh";
import { Dialog } from "./Dialog";
import { Line } from "./Line";
import { OwnShape } from "./shape";
import { COMPONENTS } from "./stations";
import { OWN_TEXTS } from "./texts";

const language: Language = document.documentElement.lang.startsWith("zh") ? "zh" : "en";
const words = OWN_TEXTS[language];
const say = new BenchSay(language);
/** How far ahead of the reader a station starts. */
const AHEAD = "40% 0px";

/** Where a station is in the page. */
interface Place {
  element: HTMLElement;
  id: StationId;
  isSeen: boolean;
  /** Whether it was ever about to be seen, since there is this shape. */
  isReached: boolean;
}

export class Guide {
  private readonly own = new OwnShape(() => this.draw());
  private readonly root = document.createElement("div");
  private readonly line = document.querySelector<HTMLElement>("[data-own-line]")!;
  private readonly places: readonly Place[];
  private frame = 0;
  private shownShape: OwnShape["shape"] = null;

  private constructor() {
    this.places = [...document.querySelectorAll<HTMLElement>("[data-own]")].map((element) => ({
      element,
      id: element.dataset["own"] as StationId,
      isSeen: false,
      isReached: false,
    }));
    const observer = new IntersectionObserver(
      (entries) => {
        for (const { target, isIntersecting } of entries) this.places.find(({ element }) => element === target)!.isSeen = isIntersecting;
        this.draw();
      },
      { rootMargin: AHEAD },
    );
    for (const { element } of this.places) observer.observe(element);
    document.body.append(this.root);
  }

  /** With the shape that this browser keeps, if there is one. */
  static async start(): Promise<Guide> {
    // Without them errors stay English.
    if (language === "zh") await loadSentences().catch(() => undefined);
    const guide = new Guide();
    await guide.own.again();
    guide.render();
    return guide;
  }

  open(): void {
    this.render();
    const dialog = this.root.querySelector("dialog")!;
    if (!dialog.open) dialog.showModal();
  }

  /** Takes files along that were chosen, or dropped on the page. */
  take(files: readonly File[]): void {
    if (!files.length) return;
    this.open();
    void this.taken(this.own.take(() => opened(files), files[0]!.name));
  }

  private async taken(taking: Promise<boolean>): Promise<void> {
    if (!(await taking)) return;
    this.render();
    this.root.querySelector("dialog")!.close();
  }

  private draw(): void {
    this.frame ||= requestAnimationFrame(() => this.render());
  }

  private render(): void {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    const { own, places } = this;
    const isNew = own.shape !== this.shownShape;
    this.shownShape = own.shape;
    render(<Dialog own={own} words={words} language={language} take={(files) => this.take(files)} taken={(taking) => void this.taken(taking)} />, this.root);
    render(<Line own={own} words={words} />, this.line);
    for (const place of places) {
      const { element, id } = place;
      element.hidden = !own.shape;
      if (isNew) place.isReached = false;
      if (!own.shape) {
        render(null, element);
        continue;
      }
      place.isReached ||= place.isSeen;
      const Component = COMPONENTS[id];
      // Until it is reached it is its room alone, so that nothing moves when it comes.
      render(
        place.isReached ? (
          <Awake.Provider value={place.isSeen}>
            <Component page={{ id, own, words, say, language }} />
          </Awake.Provider>
        ) : (
          <h4 id={`own-${id}-title`}>{words.stations[id]}</h4>
        ),
        element,
      );
    }
  }
}
