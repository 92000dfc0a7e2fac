// Levels of detail: a slider for the distance, and the level that is visible from there.
import { Slider } from "../view/parts";
import { Working } from "./Certificate";
import { isBroken } from "./outdated";
import { distanceOf, pixelsOf } from "./pixels";
import type { LevelFacts } from "./report";
import type { Page } from "./words";

/** The slider is logarithmic, so that near and far have the same room: so many steps for each doubling. */
const STEPS = 8;

export function Levels({ page }: { page: Page }) {
  const { words, say, state, control } = page;
  const { levels, view, home } = state;
  const now = levelAt(page);
  const away = control?.sight.away ?? view.distance;
  return (
    <section class="panel">
      <h2>{words.levels}</h2>
      {!levels && (
        <button type="button" disabled={!state.shown || isBroken(state)} onClick={() => void control?.onDemand.levels()}>
          {words.makeLevels}
        </button>
      )}
      {levels && now !== null && (
        <>
          <Slider
            id="distance"
            label={words.distance}
            shown={say.number(away)}
            low={STEPS * Math.log2(home.distance / 4)}
            high={STEPS * Math.log2(Math.max(4 * home.distance, 2 * (levels.facts.at(-1)?.distance ?? 0)))}
            value={STEPS * Math.log2(view.distance)}
            choose={(value) => control?.look({ ...view, distance: 2 ** (value / STEPS) })}
          />
          <p>
            {words.level(now + 1, levels.facts.length, say.whole(levels.facts[now]!.triangles))}
            <br />
            <span class="aside">
              {errorOf(page, levels.facts[now]!)}
            </span>
          </p>
          <button type="button" onClick={() => control?.withoutLevels()}>
            {words.withoutLevels}
          </button>
        </>
      )}
      <Working page={page} lanes={["levels"]} />
    </section>
  );
}

/** The levels are built for this many pixels. Up to this share more is due to rounding of the numbers in the command line. */
const PIXELS = 1;
const ROUNDING = 1e-3;

/** The error of a level, and its size on the screen from the current distance. */
function errorOf({ words, say, control }: Page, { at_least, at_most }: LevelFacts): string {
  if (at_most === null || !control) return words.atLeast(say.number(at_least));
  const screen = { ...control.sight.screen, distance: control.sight.away };
  const pixels = pixelsOf(at_most, screen);
  const from = pixels > PIXELS * (1 + ROUNDING) ? say.number(distanceOf(at_most, PIXELS, screen)) : null;
  return words.levelError(say.number(at_most), Number.isFinite(pixels) ? say.number(pixels) : null, from);
}

/** The level to show at the current distance: the coarsest whose switching distance is reached. */
export function levelAt({ state, control }: Page): number | null {
  const { levels } = state;
  if (!levels || !control) return null;
  const { away } = control.sight;
  const coarsest = levels.facts.findLastIndex(({ distance }) => distance <= away);
  return Math.max(coarsest, 0);
}
