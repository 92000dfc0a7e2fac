// Levels of detail: a slider of distance, and which level one would see from there.
import { Slider } from "../view/parts";
import { Working } from "./Certificate";
import type { Page } from "./words";

/** The slider goes in powers of two, so that far and near have room; a step is an eighth of one. */
const STEPS = 8;

export function Levels({ page }: { page: Page }) {
  const { words, say, state, control } = page;
  const { levels, view, home } = state;
  const now = levelAt(page);
  return (
    <section class="panel">
      <h2>{words.levels}</h2>
      {!levels && (
        <button type="button" disabled={!state.shown} onClick={() => void control?.levels()}>
          {words.makeLevels}
        </button>
      )}
      {levels && now !== null && (
        <>
          <Slider
            id="distance"
            label={words.distance}
            shown={say.number(view.distance)}
            spoken={say.number(view.distance)}
            low={STEPS * Math.log2(home.distance / 4)}
            high={STEPS * Math.log2(Math.max(4 * home.distance, 2 * (levels.facts.at(-1)?.distance ?? 0)))}
            step={1}
            value={STEPS * Math.log2(view.distance)}
            choose={(value) => control?.look({ ...view, distance: 2 ** (value / STEPS) })}
          />
          <p>
            {words.level(now + 1, levels.facts.length, say.whole(levels.facts[now]!.triangles))}
            <br />
            <span class="aside">
              {words.levelError(say.number(levels.facts[now]!.at_most ?? levels.facts[now]!.at_least), say.number(pixels(page, now)))}
            </span>
          </p>
        </>
      )}
      <Working page={page} lanes={["levels"]} />
    </section>
  );
}

/** The level that may be shown from here: the coarsest whose distance has been reached. */
export function levelAt({ state }: Page): number | null {
  const { levels, view } = state;
  if (!levels) return null;
  const far = levels.facts.findLastIndex(({ distance }) => distance <= view.distance);
  return Math.max(far, 0);
}

/** How large the level's error is on this screen, in the middle of the picture. */
function pixels({ state, control }: Page, level: number): number {
  const facts = state.levels!.facts[level]!;
  const screen = control?.screen;
  if (!screen) return 0;
  const perUnit = screen.height / 2 / Math.tan((screen.fovDeg * Math.PI) / 360) / state.view.distance;
  return (facts.at_most ?? facts.at_least) * perUnit;
}
