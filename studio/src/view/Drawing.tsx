// The main figure: the true curve, the segments drawn in its place, the widest gap, and the points that move it all.
import type { Chain, Cubic, Point } from "../core/types";
import { withPoint } from "../state/state";
import { Handle } from "./Handle";
import { Frame, cubicPath, linePath, pair, px } from "./frame";
import type { Page } from "./page";

/** More vertices than this are only clutter. */
const MOST_DOTS = 48;
/** How far the label of the gap stands from it, and how close to the edge it comes, in CSS pixels. */
const LABEL = { away: 34, edgeX: 46, edgeY: 16 };

export function Drawing({ page }: { page: Page }) {
  const { say, state, answers } = page;
  const frame = new Frame(page.around.width);
  const study = answers.study;
  const chain = study[state.spacing];
  const gap = chain.gap;
  const title = say.text("figure.alt", {
    segments: say.segments(chain.segments),
    px: say.pixels(gap?.pixels ?? 0),
    place: say.text("place", { percent: say.percent(gap?.place ?? 0) }),
  });
  return (
    <svg
      class="drawing"
      viewBox={`0 0 ${px(frame.width)} ${px(frame.height)}`}
      role="group"
      aria-label={title}
      data-figure="curve"
    >
      <g aria-hidden="true">
        <Polygon control={state.control} frame={frame} />
        <CurveAndChain control={study.control} chain={chain} frame={frame} />
        {gap && <Needle gap={[gap.on_curve, gap.on_polyline]} label={say.text("verdict.px", { n: say.number(gap.pixels) })} frame={frame} />}
      </g>
      {state.control.map((at, i) => (
        <Handle
          key={i}
          name={say.text(i % 3 === 0 ? "point.end" : "point.name", { i: i + 1 })}
          spoken={say.text("point.at", { x: say.coordinate(at[0]), y: say.coordinate(at[1]) })}
          help="point-help"
          at={at}
          frame={frame}
          isStill={page.around.isStill}
          kind={i % 3 === 0 ? "end" : "inner"}
          move={(change) => page.set(({ control }) => ({ control: withPoint(control, i, change(control[i]!)) }))}
        />
      ))}
    </svg>
  );
}

/** The sides of the control polygon that hold the handles. */
export function Polygon({ control, frame }: { control: readonly Point[]; frame: Frame }) {
  const [a, b, c, d] = control.map((point) => frame.to(point));
  return <path class="polygon" d={`${linePath([a!, b!])}${linePath([d!, c!])}`} />;
}

export function CurveAndChain({ control, chain, frame }: { control: Cubic; chain: Chain; frame: Frame }) {
  const points = chain.points.map((point) => frame.to(point));
  return (
    <>
      <path class="curve" d={cubicPath(control.map((point) => frame.to(point)))} />
      <path class="chain" d={linePath(points)} />
      {points.length <= MOST_DOTS && <path class="vertices" d={points.map((point) => `M${pair(point)}h0`).join("")} />}
    </>
  );
}

/** The gap where it really is, a ring around it that shows where to look, and its width beside it. */
function Needle({ gap: [onCurve, onChain], label, frame }: { gap: [Point, Point]; label: string; frame: Frame }) {
  const [from, to] = [frame.to(onCurve), frame.to(onChain)];
  const length = Math.hypot(from[0] - to[0], from[1] - to[1]);
  const middle: Point = [(from[0] + to[0]) / 2, (from[1] + to[1]) / 2];
  const ring = Math.max(length / 2 + 5, 10);
  // The label stands on the curve's side of the gap, where no segment is; straight above when there is no side.
  const side: Point = length > 0 ? [(from[0] - to[0]) / length, (from[1] - to[1]) / length] : [0, -1];
  const away = ring + LABEL.away - 10;
  const x = Math.min(Math.max(middle[0] + side[0] * (away + 16), LABEL.edgeX), frame.width - LABEL.edgeX);
  const y = Math.min(Math.max(middle[1] + side[1] * away, LABEL.edgeY), frame.height - LABEL.edgeY);
  return (
    <g class="gap">
      <circle class="ring" cx={px(middle[0])} cy={px(middle[1])} r={px(ring)} />
      <path class="needle" d={linePath([from, to])} />
      <text class="label" x={px(x)} y={px(y)} dy="0.35em" text-anchor="middle">
        {label}
      </text>
    </g>
  );
}
