// The widest gap against the number of segments, both logarithmic, with a line of slope −2 for comparison.
import type { TargetedPointerEvent } from "preact";
import type { Chain, Rung, Spacing } from "../core/types";
import { GOALS, MOST_SEGMENTS, within } from "../state/state";
import { Clauses } from "./Clauses";
import { follow } from "./Handle";
import { FRACTIONS } from "./Verdicts";
import { px } from "./frame";
import type { Page } from "./page";

/** The numbers of segments for which the core computes the gap. */
export const COUNTS: readonly number[] = [1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 56, 64, 80, 96, 112, 128];
const TICKS = [1, 2, 4, 8, 16, 32, 64, 128];
/** Always from 0.01 to 1000 pixels: if the axis moved during a drag, changes would be invisible. */
const DECADES = [0.01, 0.1, 1, 10, 100, 1000];
const MARGIN = { left: 52, right: 16, top: 14, bottom: 42 };
/** In a narrower frame the whole plot is scaled down, because the margins would leave no room. */
const NARROWEST = 280;
/** The width of the label of a goal. */
const GOAL_WIDTH = 44;
const TABLE = [1, 2, 4, 8, 16, 32, 64, 128];

/** From counts and pixels to positions in the plot. */
class Scales {
  readonly right: number;
  readonly bottom: number;
  constructor(
    readonly width: number,
    readonly height: number,
  ) {
    this.right = width - MARGIN.right;
    this.bottom = height - MARGIN.bottom;
  }
  x(n: number): number {
    return MARGIN.left + (Math.log2(n) / Math.log2(MOST_SEGMENTS)) * (this.right - MARGIN.left);
  }
  y(pixels: number): number {
    // The axis has five decades and begins at 10^−2. A gap of 0 has no logarithm.
    const share = (Math.log10(Math.max(pixels, 1e-9)) + 2) / 5;
    return this.bottom - share * (this.bottom - MARGIN.top);
  }
  count(x: number): number {
    const share = (x - MARGIN.left) / (this.right - MARGIN.left);
    return within(Math.round(2 ** (share * Math.log2(MOST_SEGMENTS))), 1, MOST_SEGMENTS);
  }
}

export function Plot({ page }: { page: Page }) {
  const { say, state, answers } = page;
  const width = Math.max(Math.min(page.around.width, 720), NARROWEST);
  const scales = new Scales(width, Math.round(Math.max(width * 0.56, 260)));
  const { ladder, study } = answers;
  const at = (rungs: Rung[], n: number) => say.pixels(rungs[ladder.counts.indexOf(n)]?.gap ?? 0);
  const values = {
    even: at(ladder.even, 8),
    even2: at(ladder.even, 16),
    even4: at(ladder.even, 32),
    fewest: at(ladder.fewest, 8),
    fewest2: at(ladder.fewest, 16),
    fewest4: at(ladder.fewest, 32),
  };
  const now = study[state.spacing];
  const here = Math.max(now.segments, 1);
  const choose = (segments: number) => page.set({ segments, before: null });
  return (
    <>
      <h2 id="plot-title">
        <Clauses text={say.text("plot.title")} />
      </h2>
      <p>{say.text("plot.text")}</p>
      <svg
        class="plot"
        viewBox={`0 0 ${px(width)} ${scales.height}`}
        role="img"
        aria-label={say.text("plot.alt", values)}
        onPointerDown={(event: TargetedPointerEvent<SVGSVGElement>) => pick(event, scales, choose)}
      >
        <Axes scales={scales} page={page} />
        <clipPath id="plot-clip">
          <rect x={MARGIN.left} y={MARGIN.top} width={px(scales.right - MARGIN.left)} height={px(scales.bottom - MARGIN.top)} />
        </clipPath>
        <g clip-path="url(#plot-clip)">
          <Slope rungs={ladder.even} scales={scales} />
          <Dots spacing="even" rungs={ladder.even} counts={ladder.counts} scales={scales} />
          <Dots spacing="fewest" rungs={ladder.fewest} counts={ladder.counts} scales={scales} />
          <path class="now" d={`M${px(scales.x(here))} ${MARGIN.top}V${px(scales.bottom)}`} />
          <Doubling page={page} scales={scales} />
          {now.gap && <circle class={`now ${state.spacing}`} cx={px(scales.x(here))} cy={px(scales.y(now.gap.pixels))} r="6" />}
        </g>
      </svg>
      <p class="legend">
        <span class="even">{say.text("spacing.even")}</span>
        <span class="fewest">{say.text("spacing.fewest")}</span>
        <span class="slope">{say.text("plot.slope")}</span>
      </p>
      <Table page={page} />
    </>
  );
}

function Axes({ scales, page }: { scales: Scales; page: Page }) {
  const { say, state } = page;
  return (
    <g class="axes">
      {DECADES.map((value) => (
        <g key={value}>
          <path class="rule" d={`M${MARGIN.left} ${px(scales.y(value))}H${px(scales.right)}`} />
          <text x={MARGIN.left - 8} y={px(scales.y(value))} dy="0.35em" text-anchor="end">
            {value}
          </text>
        </g>
      ))}
      {GOALS.map((goal, k) => (
        <g key={goal} class={goal === state.goal ? "goal chosen" : "goal"}>
          <path d={`M${MARGIN.left} ${px(scales.y(goal))}H${px(scales.right)}`} />
          {/* Side by side: the lines are closer than a label is high. */}
          <text x={px(scales.right - (GOALS.length - 1 - k) * GOAL_WIDTH)} y={px(scales.y(goal) - 4)} text-anchor="end">
            {say.text("verdict.px", { n: FRACTIONS[goal]! })}
          </text>
        </g>
      ))}
      {TICKS.map((n) => (
        <text key={n} x={px(scales.x(n))} y={scales.bottom + 16} text-anchor="middle">
          {n}
        </text>
      ))}
      <text class="name" x={px((MARGIN.left + scales.right) / 2)} y={scales.height - 6} text-anchor="middle">
        {say.text("plot.x")}
      </text>
      <text class="name" transform={`translate(13 ${px((MARGIN.top + scales.bottom) / 2)})rotate(-90)`} text-anchor="middle">
        {say.text("plot.y")}
      </text>
    </g>
  );
}

/** The slope triangle: the ratio of the two numbers of segments and the ratio of their gaps. */
function Doubling({ page, scales }: { page: Page; scales: Scales }) {
  const { say, state, answers } = page;
  const { other, ...study } = answers.study;
  const times = other.times[state.spacing];
  // The other chain has half or twice the segments.
  const [few, many] = [study[state.spacing], other[state.spacing]].sort((a, b) => a.segments - b.segments) as [Chain, Chain];
  if (times === null || !few.gap || !many.gap || few.segments === many.segments || many.segments > MOST_SEGMENTS) return null;
  const [left, right] = [scales.x(few.segments), scales.x(many.segments)];
  const [top, bottom] = [scales.y(few.gap.pixels), scales.y(many.gap.pixels)];
  return (
    <g class="doubling">
      <path d={`M${px(left)} ${px(top)}H${px(right)}V${px(bottom)}`} />
      <text x={px((left + right) / 2)} y={px(top - 6)} text-anchor="middle">
        {`×${say.number(many.segments / few.segments)}`}
      </text>
      <text x={px(right + 6)} y={px((top + bottom) / 2)} dy="0.35em">
        {`÷${say.times(times)}`}
      </text>
    </g>
  );
}

/** The line of slope −2 through the last dot of the equal steps: a quarter of the gap for every doubling. */
function Slope({ rungs, scales }: { rungs: Rung[]; scales: Scales }) {
  const last = rungs.at(-1);
  if (!last || last.gap <= 0) return null;
  const at = (n: number) => `${px(scales.x(n))} ${px(scales.y((last.gap * last.segments ** 2) / n ** 2))}`;
  return <path class="slope" d={`M${at(1)}L${at(MOST_SEGMENTS)}`} />;
}

function Dots({ spacing, rungs, counts, scales }: { spacing: Spacing; rungs: Rung[]; counts: number[]; scales: Scales }) {
  const places = rungs.flatMap((rung, i) => (rung.gap > 0 ? [`${px(scales.x(counts[i]!))} ${px(scales.y(rung.gap))}`] : []));
  return (
    <g class={spacing}>
      <path class="line" d={places.length ? `M${places.join("L")}` : ""} />
      <path class="dots" d={places.map((place) => `M${place}h0`).join("")} />
    </g>
  );
}

/** A press or a drag in the plot chooses the number of segments; with the keyboard, the slider does. */
function pick(event: TargetedPointerEvent<SVGSVGElement>, scales: Scales, choose: (n: number) => void) {
  if (event.button !== 0) return;
  const box = event.currentTarget.getBoundingClientRect();
  const chooseAt = (now: PointerEvent) => choose(scales.count(((now.clientX - box.left) * scales.width) / box.width));
  chooseAt(event);
  follow(event, chooseAt);
}

function Table({ page }: { page: Page }) {
  const { say, answers } = page;
  const { counts, even, fewest } = answers.ladder;
  return (
    <details class="plot-table">
      <summary>{say.text("plot.table")}</summary>
      <table>
        <thead>
          <tr>
            <th scope="col">{say.text("segments")}</th>
            <th scope="col">{say.text("spacing.even")}</th>
            <th scope="col">{say.text("spacing.fewest")}</th>
          </tr>
        </thead>
        <tbody>
          {TABLE.map((n) => (
            <tr key={n}>
              <th scope="row">{n}</th>
              <td>{say.pixels(even[counts.indexOf(n)]?.gap ?? 0)}</td>
              <td>{say.pixels(fewest[counts.indexOf(n)]?.gap ?? 0)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </details>
  );
}
