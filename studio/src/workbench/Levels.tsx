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
  const away = control?.screen.distance ?? view.distance;
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
            shown={say.number(away)}
            spoken={say.number(away)}
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
              {words.levelError(say.number(levels.facts[now]!.at_most ?? levels.facts[now]!.at_least))}
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

/** The level that may be shown from here: the coarsest whose distance has been reached. */
export function levelAt({ state, control }: Page): number | null {
  const { levels } = state;
  if (!levels || !control) return null;
  const away = control.screen.distance;
  const far = levels.facts.findLastIndex(({ distance }) => distance <= away);
  return Math.max(far, 0);
}
