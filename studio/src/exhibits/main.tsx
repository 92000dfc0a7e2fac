// Runs an exhibit's page: reads the address, asks the core, draws at most once a frame.
import { render } from "preact";
import type { Trouble } from "../core/engine";
import type { AnyExhibit } from "./exhibit";
import { Frame } from "./Frame";
import { read, write } from "./fragment";
import { FRAME } from "./frame_texts";
import { EXHIBITS, type Entry } from "./index";
import { keepShapes } from "./kept";
import { type Change, Desk, Run } from "./run";
import { type Language, Say } from "./say";

/** The address is written after a pause: some browsers refuse more than a hundred changes in half a minute. */
const REST_MS = 300;
/** The number is spoken after this pause, so that a drag does not flood a screen reader. */
const SPEAK_MS = 900;

const html = document.documentElement;
const root = document.getElementById("app")!;
const language: Language = html.lang.startsWith("zh") ? "zh" : "en";
const isEmbedded = new URLSearchParams(location.search).get("embed") === "1";
const id = html.dataset["exhibit"] || new URLSearchParams(location.search).get("id");
const entry = EXHIBITS.find((entry) => entry.id === id);
if (isEmbedded) html.dataset["embedded"] = "1";
// The list of exhibits has nothing interactive.
if (entry) void entry.load().then((loaded) => live(entry, loaded.default));
else html.dataset["ready"] = "1";

function live(entry: Entry, exhibit: AnyExhibit): void {
  const { state: first, isDamaged } = read(location.hash, exhibit.defaults as object, exhibit.parts);
  const words = FRAME[language];
  let notes: readonly string[] = isDamaged ? [words.damaged] : [];
  let frame = 0;
  let isDrawn = false;
  let writeTimer: ReturnType<typeof setTimeout> | undefined;
  let speakTimer: ReturnType<typeof setTimeout> | undefined;
  const spoken = Object.assign(document.createElement("p"), { className: "spoken" });
  spoken.setAttribute("role", "status");
  const desk = new Desk();
  const run = new Run(desk, entry.id, entry.id, exhibit, first, { changed: schedule, troubled });

  function troubled(trouble: Trouble): void {
    const note = trouble.what === "refused" ? words.refused(trouble.why) : words[trouble.what];
    notes = [...notes.filter((old) => old !== note), note];
    schedule();
  }

  function set(change: Change): void {
    delete html.dataset["settled"];
    clearTimeout(writeTimer);
    writeTimer = setTimeout(writeAddress, REST_MS);
    run.set(change);
  }

  function writeAddress(): void {
    writeTimer = undefined;
    const fragment = write(run.state, exhibit.defaults as object, exhibit.parts);
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
    if (run.answer === undefined) {
      // Before the first answer the still page is shown, with the notes above it.
      const list = root.querySelector(".notes");
      list?.replaceChildren(
        ...notes.map((note) => Object.assign(document.createElement("p"), { className: "note", textContent: note })),
      );
      return;
    }
    const fragment = write(run.state, exhibit.defaults as object, exhibit.parts);
    if (!isDrawn) {
      // The page was written for the initial state.
      if (!fragment) keepShapes(root);
      root.replaceChildren();
    }
    render(
      <Frame
        entry={entry}
        exhibit={exhibit}
        state={run.state}
        answer={run.answer}
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
    // For programs that drive the page: the page and its address show the answer to the newest question.
    if (desk.isIdle && !writeTimer) html.dataset["settled"] = "1";
    clearTimeout(speakTimer);
    speakTimer = setTimeout(speak, SPEAK_MS);
  }

  function speak(): void {
    const { state, answer } = run;
    const page = { state, answer, say: new Say(language), texts: exhibit.texts[language], set, isStill: false, isSmall: false };
    const { label, shown, meaning } = exhibit.number(page);
    const text = `${label}${page.say.marks.colon}${shown}${page.say.marks.stop}${meaning}`;
    if (spoken.textContent !== text) spoken.textContent = text;
  }

  addEventListener("hashchange", () => {
    const { state, isDamaged } = read(location.hash, exhibit.defaults as object, exhibit.parts);
    run.state = state;
    notes = notes.filter((note) => note !== words.damaged);
    if (isDamaged) notes = [...notes, words.damaged];
    delete html.dataset["settled"];
    run.ask();
    schedule();
  });
  run.ask();
}
