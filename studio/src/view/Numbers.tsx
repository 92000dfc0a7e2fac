// The same points as plain sliders: for readers who prefer to type, and for assistive technology that supports only
// one-dimensional sliders.
import type { Point } from "../core/types";
import { GRID, WORLD } from "../state/state";
import type { Move } from "./Handle";
import { Hint } from "./Hint";
import { Slider } from "./parts";
import type { Page } from "./page";

interface Props {
  page: Page;
  id: string;
  points: readonly { name: string; at: Point; move: Move }[];
}

export function Numbers({ page, id, points }: Props) {
  const { say } = page;
  const axes = [
    ["point.x", 0, WORLD.width],
    ["point.y", 1, WORLD.height],
  ] as const;
  return (
    <details class="numbers">
      <summary>{say.text("point.numbers")}</summary>
      <p id={`${id}-help`}>
        <Hint text={say.text("point.help")} />
      </p>
      <div class="axes">
        {points.flatMap(({ name, at, move }, i) =>
          axes.map(([key, axis, high]) => (
            <Slider
              key={`${i}${axis}`}
              id={`${id}-${i}-${axis}`}
              label={say.text(key, { name })}
              shown={say.coordinate(at[axis])}
              low={0}
              high={high}
              step={1 / GRID}
              value={at[axis]}
              choose={(value) => move(([x, y]) => (axis === 0 ? [value, y] : [x, value]))}
            />
          )),
        )}
      </div>
    </details>
  );
}
