// The whole page from the reader's choices and the core's answers.
import type { Point } from "../core/types";
import type { Theme, View } from "../state/state";
import { DEFAULTS, withPoint } from "../state/state";
import { Compare } from "./Compare";
import { Construction } from "./Construction";
import { Count, Headline, Needed, Readout, Screen, Verdicts, Where } from "./Controls";
import { Drawing } from "./Drawing";
import { InSight } from "./InSight";
import { Loupe } from "./Loupe";
import { Numbers } from "./Numbers";
import { Plot } from "./Plot";
import { SeamView } from "./Seam";
import type { Change, Page } from "./page";

export interface AppProps {
  page: Page;
  /** A change of the second view's points, and which curve leads. */
  move(change: Change, leader: "first" | "second"): void;
}

const VIEWS: readonly View[] = ["curve", "seam"];
const THEMES: readonly Theme[] = ["auto", "light", "dark"];

export function App({ page, move }: AppProps) {
  const { say, state, around } = page;
  const shows = (view: View) => around.isStill || state.view === view;
  return (
    <div class={around.isEmbedded ? "page embedded" : "page"}>
      {!around.isEmbedded && <Top page={page} />}
      <main>
        <h1>{say.text("title")}</h1>
        {around.isStill && (
          <noscript>
            <p class="note">{say.text("static")}</p>
          </noscript>
        )}
        <Notes page={page} />
        {!around.isStill && <Tabs page={page} />}
        {shows("curve") && <CurveView page={page} />}
        {around.isStill && <h2>{say.text("view.seam")}</h2>}
        {shows("seam") && <SeamView page={page} move={move} />}
        {!around.isEmbedded && <p class="closing">{say.text("closing")}</p>}
      </main>
      {!around.isEmbedded && (
        <footer>
          <p>{say.text("footer")}</p>
        </footer>
      )}
    </div>
  );
}

function Top({ page }: { page: Page }) {
  const { say, state, set } = page;
  return (
    <header>
      <span class="brand">
        <svg viewBox="0 0 32 20" width="32" height="20" aria-hidden="true">
          <path class="mark-curve" d="M2 18C2 2 30 -6 30 18" />
          <path class="mark-chain" d="M2 18L6.9 6.6L16 3L25.1 6.9L30 18" />
        </svg>
        Chordal
      </span>
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
          <label class="theme">
            <span>{say.text("theme")}</span>
            <select value={state.theme} onChange={(event) => set({ theme: event.currentTarget.value as Theme })}>
              {THEMES.map((theme) => (
                <option key={theme} value={theme} selected={theme === state.theme}>
                  {say.text(`theme.${theme}`)}
                </option>
              ))}
            </select>
          </label>
        </div>
      )}
    </header>
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
  const { control, segments, spacing, goal, t, density } = DEFAULTS;
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
          <Headline page={page} />
          <div class="row" inert={around.isStill}>
            <Count page={page} />
            <Where page={page} />
          </div>
          {!around.isStill && <Numbers page={page} id="point" points={points} />}
          <button type="button" class="reset" inert={around.isStill} onClick={() => set({ control, segments, spacing, goal, t, density })}>
            {say.text("reset")}
          </button>
        </div>
        <div class="panel">
          <div class="look">
            <Loupe page={page} />
            <Readout page={page} />
          </div>
          <div class="panel" inert={around.isStill}>
            <Verdicts page={page} />
            <Needed page={page} />
            <Screen page={page} />
          </div>
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
