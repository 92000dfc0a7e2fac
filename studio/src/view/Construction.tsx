// De Casteljau's construction at a parameter that can be dragged along the curve.
import type { TargetedPointerEvent } from "preact";
import type { Point } from "../core/types";
import { Clauses } from "./Clauses";
import { follow, pointerIn } from "./Handle";
import { Frame, cubicPath, linePath, pair, px } from "./frame";
import { Slider } from "./parts";
import type { Page } from "./page";

const WIDTH = 560;

export function Construction({ page }: { page: Page }) {
  const { say, state, answers } = page;
  const frame = new Frame(WIDTH);
  const to = (point: Point) => frame.to(point);
  const { construction, control } = answers.study;
  const spoken = say.text("construction.at", {
    percent: say.percent(construction.t),
    x: say.coordinate(construction.point[0]),
    y: say.coordinate(construction.point[1]),
  });
  return (
    <>
      <h2 id="construction-title">
        <Clauses text={say.text("construction.title")} />
      </h2>
      <p>{say.text("construction.text")}</p>
      <div class="construction">
        <svg
          class="drawing construction"
          viewBox={`0 0 ${WIDTH} ${px(frame.height)}`}
          role="img"
          aria-label={say.text("construction.alt", { percent: say.percent(construction.t) })}
        >
          <path class="level zero" d={linePath(control.map(to))} />
          <path class="curve" d={cubicPath(control.map(to))} />
          <path class="level one" d={linePath(construction.first.map(to))} />
          <path class="level two" d={linePath(construction.second.map(to))} />
          <path class="knots zero" d={dots(control.map(to))} />
          <path class="knots one" d={dots(construction.first.map(to))} />
          <path class="knots two" d={dots(construction.second.map(to))} />
          <g
            class="rider"
            transform={`translate(${pair(to(construction.point))})`}
            onPointerDown={(event: TargetedPointerEvent<SVGGElement>) => ride(event, page, frame)}
          >
            <circle class="reach" r={24} />
            <circle class="dot" r={8} />
          </g>
        </svg>
        <div inert={page.around.isStill}>
        <Slider
          id="t"
          label={say.text("construction.t")}
          shown={say.number(state.t)}
          spoken={spoken}
          low={0}
          high={1}
          step={0.01}
          value={state.t}
          choose={(t) => page.set({ t })}
        />
        </div>
      </div>
    </>
  );
}

function dots(points: readonly Point[]): string {
  return points.map((point) => `M${pair(point)}h0`).join("");
}

/** Moves the point along the curve with the finger, to the nearest of the core's points on the curve. */
function ride(event: TargetedPointerEvent<SVGGElement>, page: Page, frame: Frame) {
  if (event.button !== 0) return;
  const pointAt = pointerIn(event.currentTarget, frame);
  const { points, places } = page.answers.ladder.rail;
  follow(event, (now) => {
    const [x, y] = pointAt(now);
    let best = 0;
    let nearest = Infinity;
    points.forEach((point, i) => {
      const distance = Math.hypot(point[0] - x, point[1] - y);
      if (distance < nearest) [best, nearest] = [i, distance];
    });
    page.set({ t: Math.round((places[best] ?? 0) * 1000) / 1000 });
  });
}
