// The main figure: the true curve, its chain of segments, the widest gap, and the handles of the control points.
import type { Chain, Cubic, Point } from "../core/types";
import { withPoint } from "../state/state";
import { Handle } from "./Handle";
import { Frame, cubicPath, linePath, pair, px } from "./frame";
import type { Page } from "./page";

/** With more vertices the dots are only clutter. */
const MOST_DOTS = 48;
/** A gap longer than this, in CSS pixels, is visible without a ring around it. */
const LONG = 60;
/** The gap's label, in CSS pixels: its distance from the ring, half its size, and its distance from handles. */
const LABEL = { away: 14, halfWidth: 40, halfHeight: 10, clear: 26 };
/** Positions to try for the label, as turns from the curve's side of the gap, best first; the first free one is used. */
const TURNS = [0, 0.125, -0.125, 0.5, 0.25, -0.25, 0.375, -0.375];

const ALONE = { chain: "look.chain.alt", curve: "look.curve.alt" } as const;

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
      class={`drawing look-${state.look}`}
      viewBox={`0 0 ${px(frame.width)} ${px(frame.height)}`}
      role="group"
      aria-label={state.look === "both" ? title : say.text(ALONE[state.look], { segments: say.segments(chain.segments) })}
      data-figure="curve"
    >
      <g aria-hidden="true">
        {state.look === "both" && (
          <>
            <Polygon control={state.control} frame={frame} />
            <CurveAndChain control={study.control} chain={chain} ghost={ghostOf(page)} frame={frame} />
            {gap && (
              <Needle
                gap={[gap.on_curve, gap.on_polyline]}
                label={say.text("verdict.px", { n: say.number(gap.pixels) })}
                handles={state.control}
                frame={frame}
              />
            )}
          </>
        )}
        {state.look === "chain" && <path class="stroke" d={linePath(chain.points.map((point) => frame.to(point)))} />}
        {state.look === "curve" && <path class="stroke" d={cubicPath(study.control.map((point) => frame.to(point)))} />}
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

/** The chain before the last doubling or halving. */
export function ghostOf({ state, answers }: Page): Chain | undefined {
  const other = answers.study.other;
  return state.before === other.segments ? other[state.spacing] : undefined;
}

/** The two sides of the control polygon that end at the curve's ends. */
export function Polygon({ control, frame }: { control: readonly Point[]; frame: Frame }) {
  const [a, b, c, d] = control.map((point) => frame.to(point));
  return <path class="polygon" d={`${linePath([a!, b!])}${linePath([d!, c!])}`} />;
}

interface ChainProps {
  control: Cubic;
  chain: Chain;
  ghost?: Chain | undefined;
  frame: Frame;
}

export function CurveAndChain({ control, chain, ghost, frame }: ChainProps) {
  const points = chain.points.map((point) => frame.to(point));
  return (
    <>
      <path class="curve" d={cubicPath(control.map((point) => frame.to(point)))} />
      <path class="core" d={cubicPath(control.map((point) => frame.to(point)))} />
      {ghost && <path class="ghost" d={linePath(ghost.points.map((point) => frame.to(point)))} />}
      <path class="chain" d={linePath(points)} />
      {points.length <= MOST_DOTS && <path class="vertices" d={points.map((point) => `M${pair(point)}h0`).join("")} />}
    </>
  );
}

interface NeedleProps {
  gap: readonly [Point, Point];
  label: string;
  /** The label must not cover them. */
  handles: readonly Point[];
  frame: Frame;
}

/** The gap as a needle, a ring around a short one, and its width beside it. */
function Needle({ gap, label, handles, frame }: NeedleProps) {
  const [from, to] = [frame.to(gap[0]), frame.to(gap[1])];
  const length = Math.hypot(from[0] - to[0], from[1] - to[1]);
  const middle: Point = [(from[0] + to[0]) / 2, (from[1] + to[1]) / 2];
  const isLong = length > LONG;
  const ring = isLong ? 0 : Math.max(length / 2 + 5, 10);
  // On the curve's side of a short gap no segment is in the way; beside a long one there is room.
  const along = length > 0 ? Math.atan2(from[1] - to[1], from[0] - to[0]) : -Math.PI / 2;
  const side = isLong ? along + Math.PI / 2 : along;
  const [x, y] = labelPlace(middle, ring, side, handles.map((point) => frame.to(point)), frame);
  return (
    <g class="gap">
      {ring > 0 && <circle class="ring" cx={px(middle[0])} cy={px(middle[1])} r={px(ring)} />}
      <path class="needle" d={linePath([from, to])} />
      <text class="label" x={px(x)} y={px(y)} dy="0.35em" text-anchor="middle">
        {label}
      </text>
    </g>
  );
}

/** A free position for the label, as near as possible to that side of the gap. */
function labelPlace(middle: Point, ring: number, side: number, handles: readonly Point[], frame: Frame): Point {
  const candidates = TURNS.map((turn): Point => {
    const angle = side + turn * 2 * Math.PI;
    const away = ring + LABEL.away;
    return [
      middle[0] + Math.cos(angle) * (away + LABEL.halfWidth - 12),
      middle[1] + Math.sin(angle) * (away + LABEL.halfHeight - 4),
    ];
  });
  const isFree = ([x, y]: Point) =>
    x > LABEL.halfWidth &&
    x < frame.width - LABEL.halfWidth &&
    y > LABEL.halfHeight &&
    y < frame.height - LABEL.halfHeight &&
    handles.every((at) => Math.abs(at[0] - x) > LABEL.halfWidth + 8 || Math.abs(at[1] - y) > LABEL.clear);
  const [x, y] = candidates.find(isFree) ?? candidates[0]!;
  const keep = (value: number, half: number, size: number) => Math.min(Math.max(value, half), size - half);
  return [keep(x, LABEL.halfWidth, frame.width), keep(y, LABEL.halfHeight, frame.height)];
}
