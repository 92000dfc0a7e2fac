// Brings an exhibit's page to life: reads the address, asks the core, draws at most once a frame.
import { render } from "preact";
import { Engine, type Trouble } from "../core/engine";
import type { AnyExhibit } from "./exhibit";
import { Frame } from "./Frame";
import { read, write } from "./fragment";
import { FRAME } from "./frame_texts";
import { EXHIBITS, type Entry } from "./index";
import { type Language, Say } from "./say";

/** The address is written when the hand rests: some browsers refuse more than a hundred changes in half a minute. */
const REST_MS = 300;
/** And the number is spoken then. */
const SPEAK_MS = 900;

const html = document.documentElement;
const root = document.getElementById("app")!;
const language: Language = html.lang.startsWith("zh") ? "zh" : "en";
const isEmbedded = new URLSearchParams(location.search).get("embed") === "1";
const id = html.dataset["exhibit"] || new URLSearchParams(location.search).get("id");
const entry = EXHIBITS.find((entry) => entry.id === id);
if (isEmbedded) html.dataset["embedded"] = "1";
// The list of all has nothing to move.
if (entry) void entry.load().then((loaded) => live(entry, loaded.default));
else html.dataset["ready"] = "1";

function live(entry: Entry, exhibit: AnyExhibit): void {
  let { state, isDamaged } = read(location.hash, exhibit.defaults as object, exhibit.parts);
  const words = FRAME[language];
  let notes: readonly string[] = isDamaged ? [words.damaged] : [];
  let answer: unknown;
  let asked = "";
  let frame = 0;
  let isDrawn = false;
  let writing: ReturnType<typeof setTimeout> | undefined;
  let speaking: ReturnType<typeof setTimeout> | undefined;
  const spoken = Object.assign(document.createElement("p"), { className: "spoken" });
  spoken.setAttribute("role", "status");
  const engine = new Engine(() => new Worker(new URL("./worker.ts", import.meta.url), { type: "module" }), {
    answered,
    troubled,
  });

  function ask(): boolean {
    const question = { exhibit: entry.id, ...exhibit.question(state) };
    const text = JSON.stringify(question);
    if (text === asked) return false;
    asked = text;
    engine.ask("exhibit", question);
    return true;
  }

  function answered(_: string, found: unknown): void {
    answer = found;
    schedule();
  }

  function troubled(trouble: Trouble): void {
    const said = trouble.what === "refused" ? words.refused(trouble.why) : words[trouble.what];
    notes = [...notes.filter((old) => old !== said), said];
    schedule();
  }

  function set(change: object | ((state: object) => object)): void {
    state = { ...state, ...(typeof change === "function" ? change(state) : change) };
    delete html.dataset["settled"];
    clearTimeout(writing);
    writing = setTimeout(writeAddress, REST_MS);
    ask();
    schedule();
  }

  function writeAddress(): void {
    writing = undefined;
    const fragment = write(state, exhibit.defaults as object, exhibit.parts);
    history.replaceState(null, "", location.pathname + location.search + (fragment && `#${fragment}`));
    schedule();
  }

  function schedule(): void {
    frame ||= requestAnimationFrame(() => {
      frame = 0;
      draw();
    });
  }

  function draw(): void {
    if (answer === undefined) {
      // Before the first answer the still page stands; what went wrong is said above it.
      const place = root.querySelector(".notes");
      place?.replaceChildren(
        ...notes.map((note) => Object.assign(document.createElement("p"), { className: "note", textContent: note })),
      );
      return;
    }
    if (!isDrawn) root.replaceChildren();
    const fragment = write(state, exhibit.defaults as object, exhibit.parts);
    render(
      <Frame
        entry={entry}
        exhibit={exhibit}
        state={state}
        answer={answer}
        language={language}
        fragment={fragment}
        isStill={false}
        isEmbedded={isEmbedded}
        notes={notes}
        set={set}
      />,
      root,
    );
    if (!isDrawn) {
      isDrawn = true;
      document.body.append(spoken);
      html.dataset["ready"] = "1";
    }
    // For whoever drives the page by program: what shows is the answer to the newest question, and the address says so.
    if (engine.isIdle && !writing) html.dataset["settled"] = "1";
    clearTimeout(speaking);
    speaking = setTimeout(speak, SPEAK_MS);
  }

  function speak(): void {
    const page = { state, answer, say: new Say(language), texts: exhibit.texts[language], set, isStill: false, isSmall: false };
    const { label, shown, meaning } = exhibit.number(page);
    const text = `${label}: ${shown}. ${meaning}`;
    if (spoken.textContent !== text) spoken.textContent = text;
  }

  addEventListener("hashchange", () => {
    ({ state, isDamaged } = read(location.hash, exhibit.defaults as object, exhibit.parts));
    notes = notes.filter((note) => note !== words.damaged);
    if (isDamaged) notes = [...notes, words.damaged];
    delete html.dataset["settled"];
    ask();
    schedule();
  });
  ask();
}
