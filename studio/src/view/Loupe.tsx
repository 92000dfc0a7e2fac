// The widest gap, magnified 20 times, on the grid of the screen's pixels.
import type { Point } from "../core/types";
import { cubicPath, linePath, px, Frame } from "./frame";
import { densityOf, type Page } from "./page";

const POWER = 20;
/** Side of the loupe, and the largest distance of the curve from its middle, in CSS pixels. */
const SIDE = 220;
const OFF_CENTRE = 60;
/** How far from the gap the curve can be under the loupe, in CSS pixels of the main figure, with half as much in reserve. */
export const LOUPE_REACH = (1.5 * SIDE) / POWER;

export function Loupe({ page }: { page: Page }) {
  const { say, answers, state, around } = page;
  const chain = answers.study[state.spacing];
  const gap = chain.gap;
  const base = new Frame(around.width);
  const magnified = (point: Point): Point => {
    const [x, y] = base.to(point);
    return [x * POWER, y * POWER];
  };
  const start = gap?.on_curve ?? answers.study.control[0];
  const [from, to] = [magnified(start), magnified(gap?.on_polyline ?? start)];
  // Centred between curve and chain if both fit, otherwise near the curve.
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  const share = length > 0 ? Math.min(length / 2, OFF_CENTRE) / length : 0;
  const centre = [from[0] + (to[0] - from[0]) * share - SIDE / 2, from[1] + (to[1] - from[1]) * share - SIDE / 2] as const;
  const shown = (point: Point): Point => {
    const [x, y] = magnified(point);
    return [x - centre[0], y - centre[1]];
  };
  const pixel = POWER / densityOf(state, around);
  return (
    <figure class="loupe">
      <svg viewBox={`0 0 ${SIDE} ${SIDE}`} role="img" aria-label={say.text("loupe.alt", { px: say.pixels(gap?.pixels ?? 0) })}>
        <path class="grid" d={grid(pixel, centre)} />
        <path class="curve" d={cubicPath((gap?.near ?? answers.study.control).map(shown))} />
        <path class="chain" d={linePath(chain.points.map(shown))} />
        {gap && <path class="needle" d={linePath([shown(gap.on_curve), shown(gap.on_polyline)])} />}
      </svg>
      <figcaption>
        <b>{say.text("loupe")}</b> {say.text("loupe.help")}
      </figcaption>
    </figure>
  );
}

/** The lines between the screen's pixels under the loupe. */
function grid(pixel: number, [left, top]: readonly [number, number]): string {
  let path = "";
  for (let x = pixel - (left % pixel); x < SIDE; x += pixel) path += `M${px(x)} 0V${SIDE}`;
  for (let y = pixel - (top % pixel); y < SIDE; y += pixel) path += `M0 ${px(y)}H${SIDE}`;
  return path;
}
