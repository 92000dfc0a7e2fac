// Brings the page to life: reads the address, asks the core, draws at most once a frame.
import { render } from "preact";
import { Engine, type Trouble } from "./core/engine";
import type { AnswerOf, Kind, QuestionOf, SeamQuestion } from "./core/types";
import { Speaker, TAGS, preferred } from "./i18n/speak";
import { ladderOf, seamOf, studyOf } from "./questions";
import { Film } from "./state/film";
import { read, write } from "./state/fragment";
import { type Eight, GRID, type Language, type State } from "./state/state";
import { Trail } from "./state/trail";
import { App, titleOf } from "./view/App";
import type { Answers, Change, Note, Page, Surroundings } from "./view/page";

/** The address is written when the hand rests: some browsers refuse more than a hundred changes in half a minute. */
const REST_MS = 300;
/** And the widest gap is spoken then. */
const SPEAK_MS = 900;
/** An answer that takes longer than this is not waited for: the point under the finger moves without it. */
const SLOW_MS = 60;
/** How long the hand rests before the plot is drawn for its own sake. */
const PLOT_MS = 80;

const root = document.getElementById("app")!;
const pageLanguage: Language = document.documentElement.lang.startsWith("zh") ? "zh" : preferred(navigator.languages);

let { state, isDamaged } = read(location.hash);
let answers: Partial<Answers> = {};
let notes: readonly Note[] = isDamaged ? [{ key: "note.damaged" }] : [];
let around: Surroundings = {
  width: measured() ?? 720,
  ownDensity: devicePixelRatio,
  isEmbedded: new URLSearchParams(location.search).get("embed") === "1",
  isStill: false,
};
let say = new Speaker(languageOf(state));
let leader: "first" | "second" = "first";
let frame = 0;
let waiting: ReturnType<typeof setTimeout> | undefined;
let writing: ReturnType<typeof setTimeout> | undefined;
let speaking: ReturnType<typeof setTimeout> | undefined;
const asked: Partial<Record<Kind, string>> = {};
let seamAsked: SeamQuestion;
let isDrawn = false;
let movedAt = -Infinity;
const sizes = new ResizeObserver(lookAround);
const spoken = Object.assign(document.createElement("p"), { className: "spoken" });
spoken.setAttribute("role", "status");

const trail = new Trail(
  {
    push: (fragment) => history.pushState(null, "", addressOf(fragment)),
    replace: (fragment) => history.replaceState(null, "", addressOf(fragment)),
  },
  location.hash.slice(1),
);
const film = new Film(
  (segments) => change({ segments, before: null }, "first"),
  () => {
    writeSoon();
    schedule();
  },
);

const engine = new Engine(() => new Worker(new URL("./worker.ts", import.meta.url), { type: "module" }), { answered, troubled });

function languageOf(state: State): Language {
  return state.language ?? pageLanguage;
}

/** The width of the main figure, where there is one. */
function measured(): number | undefined {
  const width = root.querySelector(".stage .drawing")?.getBoundingClientRect().width;
  return width ? Math.round(width) : undefined;
}

/** What the reader does. It ends the film, unless it is about something else. */
function set(wish: Change, who: "first" | "second" = "first"): void {
  const changes = typeof wish === "function" ? wish(state) : wish;
  if ("segments" in changes || "view" in changes) film.stop();
  change(changes, who);
}

function change(changes: Partial<State>, who: "first" | "second"): void {
  const before = languageOf(state);
  state = { ...state, ...changes };
  trail.touch(Object.keys(changes));
  leader = who;
  if (languageOf(state) !== before) say = new Speaker(languageOf(state));
  writeSoon();
  delete document.documentElement.dataset["settled"];
  movedAt = performance.now();
  // The answer is here before the next frame, and one frame shows both. A slow one is not waited for.
  if (ask()) later(SLOW_MS);
  else schedule();
}

function writeSoon(): void {
  clearTimeout(writing);
  writing = setTimeout(writeAddress, REST_MS);
}

/** A film is one step of the trail, however long it was. */
function writeAddress(): void {
  writing = undefined;
  schedule();
  if (!film.isPlaying) trail.write(write(state), performance.now());
}

function addressOf(fragment: string): string {
  return location.pathname + location.search + (fragment && `#${fragment}`);
}

/** Asks what the state needs and was not asked yet. Whether there was anything. */
function ask(): boolean {
  const isAsked = askIfNew("study", studyOf(state, around));
  const isPlotAsked = askIfNew("ladder", ladderOf(state, around));
  const seam = seamOf(state, leader);
  const isSeamAsked = askIfNew("seam", seam);
  if (isSeamAsked) seamAsked = seam;
  return isAsked || isPlotAsked || isSeamAsked;
}

function askIfNew<K extends Kind>(kind: K, question: QuestionOf<K>): boolean {
  const text = JSON.stringify(question);
  if (asked[kind] === text) return false;
  asked[kind] = text;
  engine.ask(kind, question);
  return true;
}

function answered<K extends Kind>(kind: K, answer: AnswerOf<K>, question: QuestionOf<K>): void {
  answers = { ...answers, [kind]: answer };
  // An older answer must not take back what the hand has done since.
  if (kind === "seam" && question === seamAsked) adopt(answer as Answers["seam"]);
  // While the hand moves, the plot is drawn together with the next figure and not by itself.
  if (kind !== "ladder" || !isMoving()) schedule();
}

/** The core has moved the points that have to follow; they are the state now, on the grid. */
function adopt({ first, second }: Answers["seam"]): void {
  const snap = (value: number) => Math.round(value * GRID) / GRID;
  const seam = [...first, ...second].map(([x, y]) => [snap(x), snap(y)] as const);
  state = { ...state, seam: seam as unknown as Eight };
}

function troubled(trouble: Trouble): void {
  if (trouble.what === "refused") note({ key: "note.refused", values: { why: trouble.why } });
  else note({ key: trouble.what === "lost" ? "note.lost" : "note.rebuilt" });
  schedule();
}

function note(news: Note): void {
  notes = [...notes.filter((old) => old.key !== news.key), news];
}

function isMoving(): boolean {
  return performance.now() - movedAt < PLOT_MS;
}

/** Draws soon, unless something else makes it draw before. */
function later(ms: number): void {
  clearTimeout(waiting);
  waiting = setTimeout(schedule, ms);
}

function schedule(): void {
  clearTimeout(waiting);
  frame ||= requestAnimationFrame(() => {
    frame = 0;
    draw();
  });
}

function draw(): void {
  const { study, ladder, seam } = answers;
  if (!study || !ladder || !seam) {
    drawNotes();
    return;
  }
  const html = document.documentElement;
  const page: Page = {
    say,
    state,
    answers: { study, ladder, seam },
    around,
    notes,
    isMoving: isMoving(),
    isPlaying: film.isPlaying,
    play: () => {
      if (film.isPlaying) film.stop();
      else film.start(state.segments);
      schedule();
    },
    set,
    close: (note) => {
      notes = notes.filter((other) => other !== note);
      schedule();
    },
  };
  dress(page);
  // What is out of sight was left as it was: once the hand rests, everything is drawn.
  if (page.isMoving) later(PLOT_MS);
  if (!isDrawn) root.replaceChildren();
  render(<App page={page} move={set} />, root);
  if (!isDrawn) {
    isDrawn = true;
    document.body.append(spoken);
    html.dataset["ready"] = "1";
  }
  const stage = root.querySelector(".stage");
  if (stage && !(stage as HTMLElement).dataset["watched"]) {
    (stage as HTMLElement).dataset["watched"] = "1";
    sizes.disconnect();
    sizes.observe(stage);
  }
  // For whoever drives the page by program: what shows is the answer to the newest question, and the address says so.
  if (engine.isIdle && !writing && !page.isMoving && !film.isPlaying) html.dataset["settled"] = "1";
  clearTimeout(speaking);
  speaking = setTimeout(speak, SPEAK_MS);
}

/** Language and title of the whole document, which is costly to change, be it for the same. */
function dress(page: Page): void {
  const html = document.documentElement;
  if (html.lang !== TAGS[say.language]) html.lang = TAGS[say.language];
  const title = say.text(titleOf(page));
  if (document.title !== title) document.title = title;
}

/** Before the first answer the still page stands; what went wrong is said above it. */
function drawNotes(): void {
  const old = root.querySelector(".notes");
  if (!old) return;
  old.replaceChildren(
    ...notes.map((note) => Object.assign(document.createElement("p"), { className: "note", textContent: say.text(note.key, note.values) })),
  );
}

function speak(): void {
  const text = root.querySelector(".headline")?.textContent ?? "";
  if (spoken.textContent !== text) spoken.textContent = text;
}

function lookAround(): void {
  const width = measured() ?? around.width;
  if (width === around.width && devicePixelRatio === around.ownDensity) return;
  around = { ...around, width, ownDensity: devicePixelRatio };
  delete document.documentElement.dataset["settled"];
  ask();
  schedule();
}

/** Back, forward, or another address typed over this one. */
function arrive(): void {
  film.stop();
  clearTimeout(writing);
  writing = undefined;
  ({ state, isDamaged } = read(location.hash));
  trail.arrive(location.hash.slice(1));
  say = new Speaker(languageOf(state));
  notes = notes.filter((note) => note.key !== "note.damaged");
  if (isDamaged) note({ key: "note.damaged" });
  leader = "first";
  delete document.documentElement.dataset["settled"];
  ask();
  schedule();
}

// A step of the trail is a popstate, a typed address is both, and arriving twice does no harm.
addEventListener("popstate", arrive);
addEventListener("hashchange", arrive);
addEventListener("resize", lookAround);

ask();
