// Writes the page as text with a still figure at build time, for readers without script and until it runs.
import { renderToString } from "preact-render-to-string";
import type { Core } from "./core/module";
import { Speaker } from "./i18n/speak";
import { ladderOf, seamOf, studyOf } from "./questions";
import { DEFAULTS, type Language } from "./state/state";
import { App } from "./view/App";
import type { Page, Surroundings } from "./view/page";

/** The width of the figure in a wide window, on a screen with one device pixel per CSS pixel. */
const AROUND: Surroundings = { width: 720, ownDensity: 1, isEmbedded: false, isStill: true };

export function still(core: Core, language: Language): string {
  const page: Page = {
    say: new Speaker(language),
    state: DEFAULTS,
    answers: {
      study: core.ask("study", studyOf(DEFAULTS, AROUND)),
      ladder: core.ask("ladder", ladderOf(DEFAULTS, AROUND)),
      seam: core.ask("seam", seamOf(DEFAULTS, "first")),
    },
    around: AROUND,
    notes: [],
    isMoving: false,
    isPlaying: false,
    play: () => undefined,
    set: () => undefined,
    close: () => undefined,
  };
  return renderToString(<App page={page} move={() => undefined} />);
}

export { Core } from "./core/module";
