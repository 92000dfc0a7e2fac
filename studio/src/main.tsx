// Runs the page: reads the address, asks the core, draws at most once a frame.
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

/** The address is written after a pause: some browsers refuse more than a hundred changes in half a minute. */
const REST_MS = 300;
/** The widest gap is spoken after this pause, so that a drag does not flood a screen reader. */
const SPEAK_MS = 900;
/** If an answer takes longer than this, the point under the finger is drawn without it. */
const SLOW_MS = 60;
/** The pause after which the plot is drawn by itself, not only together with the next figure. */
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
let drawTimer: ReturnType<typeof setTimeout> | undefined;
let writeTimer: ReturnType<typeof setTimeout> | undefined;
let speakTimer: ReturnType<typeof setTimeout> | undefined;
const lastQuestions: Partial<Record<Kind, string>> = {};
let lastSeamQuestion: SeamQuestion;
let isDrawn = false;
let movedAt = -Infinity;
const sizeObserver = new ResizeObserver(measureSurroundings);
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

/** The width of the main figure, if there is one. */
function measured(): number | undefined {
  const width = root.querySelector(".stage .drawing")?.getBoundingClientRect().width;
  return width ? Math.round(width) : undefined;
}

/** Applies a change by the reader. It ends the film if it concerns the number of segments or the view. */
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
  // The answer usually arrives before the next frame, which then shows both. A slow answer must not delay the handle.
  if (ask()) scheduleAfter(SLOW_MS);
  else schedule();
}

function writeSoon(): void {
  clearTimeout(writeTimer);
  writeTimer = setTimeout(writeAddress, REST_MS);
}

/** Writes the address. A whole film is one step of the trail. */
function writeAddress(): void {
  writeTimer = undefined;
  schedule();
  if (!film.isPlaying) trail.write(write(state), performance.now());
}

function addressOf(fragment: string): string {
  return location.pathname + location.search + (fragment && `#${fragment}`);
}

/** Asks the questions of the state that are new. Returns whether there were any. */
function ask(): boolean {
  const isAsked = askIfNew("study", studyOf(state, around));
  const isPlotAsked = askIfNew("ladder", ladderOf(state, around));
  const seam = seamOf(state, leader);
  const isSeamAsked = askIfNew("seam", seam);
  if (isSeamAsked) lastSeamQuestion = seam;
  return isAsked || isPlotAsked || isSeamAsked;
}

function askIfNew<K extends Kind>(kind: K, question: QuestionOf<K>): boolean {
  const text = JSON.stringify(question);
  if (lastQuestions[kind] === text) return false;
  lastQuestions[kind] = text;
  engine.ask(kind, question);
  return true;
}

function answered<K extends Kind>(kind: K, answer: AnswerOf<K>, question: QuestionOf<K>): void {
  answers = { ...answers, [kind]: answer };
  // An older answer must not undo later movements of the hand.
  if (kind === "seam" && question === lastSeamQuestion) adopt(answer as Answers["seam"]);
  // During a drag the plot is drawn together with the next figure, to save a frame.
  if (kind !== "ladder" || !isMoving()) schedule();
}

/** Takes over the points that the core moved to keep the smoothness, rounded to the grid. */
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

/** Draws after a delay, unless it is drawn earlier for another reason. */
function scheduleAfter(ms: number): void {
  clearTimeout(drawTimer);
  drawTimer = setTimeout(schedule, ms);
}

function schedule(): void {
  clearTimeout(drawTimer);
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
  updateDocument(page);
  // Sections out of sight were skipped during the drag: they are drawn after it.
  if (page.isMoving) scheduleAfter(PLOT_MS);
  if (!isDrawn) root.replaceChildren();
  render(<App page={page} move={set} />, root);
  if (!isDrawn) {
    isDrawn = true;
    document.body.append(spoken);
    html.dataset["ready"] = "1";
  }
  const stage = root.querySelector(".stage");
  // A new stage, as after a change of the view, is observed in place of the old one.
  if (stage && !(stage as HTMLElement).dataset["watched"]) {
    (stage as HTMLElement).dataset["watched"] = "1";
    sizeObserver.disconnect();
    sizeObserver.observe(stage);
  }
  // For programs that drive the page: the page and its address show the answers to the newest questions.
  if (engine.isIdle && !writeTimer && !page.isMoving && !film.isPlaying) html.dataset["settled"] = "1";
  clearTimeout(speakTimer);
  speakTimer = setTimeout(speak, SPEAK_MS);
}

/** Sets language and title of the document, only on a change: setting even the same value is costly. */
function updateDocument(page: Page): void {
  const html = document.documentElement;
  if (html.lang !== TAGS[say.language]) html.lang = TAGS[say.language];
  const title = say.text(titleOf(page));
  if (document.title !== title) document.title = title;
}

/** Before the first answer the still page is shown, with the notes above it. */
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

function measureSurroundings(): void {
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
  clearTimeout(writeTimer);
  writeTimer = undefined;
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

// A step of the trail fires popstate, a typed address fires both, and arriving twice does no harm.
addEventListener("popstate", arrive);
addEventListener("hashchange", arrive);
addEventListener("resize", measureSurroundings);

ask();
