// The whole page, from the reader's choices and the core's answers.
import type { Point } from "../core/types";
import { LESSON } from "../lesson/where";
import type { Language, View } from "../state/state";
import { DEFAULTS, withPoint } from "../state/state";
import { Clauses } from "./Clauses";
import { Compare } from "./Compare";
import { Construction } from "./Construction";
import { Count, Headline, LookAt, Where } from "./Controls";
import { Drawing, ghostOf } from "./Drawing";
import { InSight } from "./InSight";
import { Loupe } from "./Loupe";
import { Numbers } from "./Numbers";
import { Plot } from "./Plot";
import { Recipe } from "./Recipe";
import { SeamView } from "./Seam";
import { Themes } from "./Themes";
import { Needed, Readout, Screen, Verdicts } from "./Verdicts";
import type { Change, Page } from "./page";

export interface AppProps {
  page: Page;
  /** Changes the second view's points; `leader` is the curve that keeps its points. */
  move(change: Change, leader: "first" | "second"): void;
}

const VIEWS: readonly View[] = ["curve", "seam"];

export function App({ page, move }: AppProps) {
  const { say, state, around } = page;
  const shows = (view: View) => around.isStill || state.view === view;
  return (
    <div class={around.isEmbedded ? "page embedded" : "page"}>
      {!around.isEmbedded && <Top page={page} />}
      <main>
        <h1>
          <Clauses text={say.text(titleOf(page))} />
        </h1>
        {around.isStill && (
          <noscript>
            <p class="note">{say.text("static")}</p>
          </noscript>
        )}
        <Notes page={page} />
        {shows("curve") && <CurveView page={page} />}
        {shows("curve") && !around.isEmbedded && <p class="closing"><Clauses text={say.text("closing")} /></p>}
        {around.isStill && <h2>{say.text("seam.title")}</h2>}
        {shows("seam") && <SeamView page={page} move={move} />}
        {shows("seam") && !around.isEmbedded && <p class="closing"><Clauses text={say.text("seam.closing")} /></p>}
      </main>
      {!around.isEmbedded && (
        <footer>
          <p>{say.text("footer")}</p>
        </footer>
      )}
    </div>
  );
}

/** Each view has its own title; the still page shows the first one's. */
export function titleOf({ state, around }: Page): "title" | "seam.title" {
  return state.view === "seam" && !around.isStill ? "seam.title" : "title";
}

function Top({ page }: { page: Page }) {
  const { say, set } = page;
  return (
    <header>
      <span class="brand">
        <svg viewBox="0 0 32 20" width="32" height="20" aria-hidden="true">
          <path class="mark-curve" d="M2 18C2 2 30 -6 30 18" />
          <path class="mark-chain" d="M2 18L6.9 6.6L16 3L25.1 6.9L30 18" />
        </svg>
        <span>Chordal</span>
      </span>
      <a class="to-lesson" href={LESSON[say.language]}>
        {say.text("lesson")}
      </a>
      {page.around.isStill ? (
        <OtherLanguage language={say.language} />
      ) : (
        <Tabs page={page} />
      )}
      {!page.around.isStill && (
        <div class="wishes-of-page">
          <div class="languages" role="group" aria-label={say.text("language")}>
            <button type="button" lang="en" aria-pressed={say.language === "en"} onClick={() => set({ language: "en" })}>
              English
            </button>
            <button type="button" lang="zh-CN" aria-pressed={say.language === "zh"} onClick={() => set({ language: "zh" })}>
              中文
            </button>
          </div>
          <Themes language={say.language} change={() => set({ theme: null })} />
        </div>
      )}
    </header>
  );
}

/** Without script: a link to the page in the other language. */
function OtherLanguage({ language }: { language: Language }) {
  const [file, tag, name] = language === "en" ? (["zh.html", "zh-CN", "中文"] as const) : (["index.html", "en", "English"] as const);
  return (
    <a href={file} lang={tag} hreflang={tag}>
      {name}
    </a>
  );
}

function Tabs({ page }: { page: Page }) {
  const { say, state, set } = page;
  return (
    <nav class="tabs" aria-label={say.text("views")}>
      {VIEWS.map((view) => (
        <button key={view} type="button" aria-current={state.view === view ? "page" : undefined} onClick={() => set({ view })}>
          {say.text(`view.${view}`)}
        </button>
      ))}
    </nav>
  );
}

function Notes({ page }: { page: Page }) {
  const { say, notes, close } = page;
  return (
    <div class="notes" role="status">
      {notes.map((note) => (
        <p key={note.key} class="note" data-note={note.key}>
          {say.text(note.key, note.values)}
          <button type="button" aria-label={say.text("note.close")} onClick={() => close(note)}>
            ×
          </button>
        </p>
      ))}
    </div>
  );
}

function CurveView({ page }: { page: Page }) {
  const { say, state, around, set } = page;
  const { control, segments, before, spacing, look, goal, t, density } = DEFAULTS;
  const points = state.control.map((at, i) => ({
    name: say.text(i % 3 === 0 ? "point.end" : "point.name", { i: i + 1 }),
    at,
    move: (change: (at: Point) => Point) => set(({ control }) => ({ control: withPoint(control, i, change(control[i]!)) })),
  }));
  return (
    <>
      <p class="lead">{say.text("lead")}</p>
      <div class="bench">
        <div class="stage">
          <Drawing page={page} />
          <Legend page={page} />
        </div>
        <div class="side" inert={around.isStill}>
          <Headline page={page} />
          <Count page={page} />
          <LookAt page={page} />
          <Where page={page} />
          <div class="look">
            <Loupe page={page} />
            <Readout page={page} />
          </div>
          <Verdicts page={page} />
          <Needed page={page} />
          <Screen page={page} />
        </div>
        <div class="under">
          {!around.isEmbedded && <Recipe page={page} />}
          {!around.isStill && <Numbers page={page} id="point" points={points} />}
          <button
            type="button"
            class="reset"
            inert={around.isStill}
            onClick={() => set({ control, segments, before, spacing, look, goal, t, density })}
          >
            {say.text("reset")}
          </button>
        </div>
      </div>
      {!around.isEmbedded && (
        <>
          <InSight page={page} name="plot" part={Plot} />
          <InSight page={page} name="compare" part={Compare} />
          <InSight page={page} name="construction" part={Construction} />
        </>
      )}
    </>
  );
}

/** The legend of the figure's strokes. */
function Legend({ page }: { page: Page }) {
  const { say, state } = page;
  if (state.look !== "both") return <p class="legend of-figure">{say.text("look.help")}</p>;
  return (
    <p class="legend of-figure">
      <span class="curve">{say.text("legend.curve")}</span>
      <span class="chain">{say.text("legend.chain")}</span>
      {ghostOf(page) && <span class="ghost">{say.text("legend.ghost", { segments: say.segments(state.before ?? 0) })}</span>}
      <span class="gap">{say.text("legend.gap")}</span>
    </p>
  );
}
