// A chart with two axes, each linear or logarithmic.
import type { Children } from "./exhibit";
import { px } from "./Grip";

export interface Axis {
  low: number;
  high: number;
  isLog?: boolean;
  label: string;
  ticks: readonly (readonly [at: number, label: string])[];
}

export type Place = (x: number, y: number) => readonly [number, number];

interface ChartProps {
  name: string;
  x: Axis;
  y: Axis;
  width?: number;
  height?: number;
  /** Whether it is the main figure, rather than a small chart in the panel. */
  isFigure?: boolean;
  children(at: Place): Children;
}

const share = ({ low, high, isLog }: Axis, value: number) =>
  isLog ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);

export function Chart({ name, x, y, width = 320, height = 200, isFigure, children }: ChartProps) {
  const [left, right, top, bottom] = isFigure ? [92, 24, 44, 62] : [50, 10, 26, 40];
  const at: Place = (a, b) => [
    left + share(x, a) * (width - left - right),
    height - bottom - share(y, b) * (height - top - bottom),
  ];
  const [x0, y0] = [left, height - bottom];
  return (
    <svg
      class={isFigure ? "flat chart" : "chart small"}
      viewBox={`0 0 ${width} ${height}`}
      {...(isFigure ? { "data-figure": true, role: "group" as const } : { role: "img" as const })}
      aria-label={name}
    >
      <path class="axis" d={`M${x0} ${top - 8}V${y0}H${width - right + 6}`} />
      {x.ticks.map(([value, label], i) => {
        const tick = px(at(value, y.low)[0]);
        return (
          <g key={label}>
            <path class="rule" d={`M${tick} ${y0}V${top}`} />
            <text x={tick} y={y0 + (isFigure ? 22 : 15)} class={i % 2 ? "x every-other" : "x"}>
              {label}
            </text>
          </g>
        );
      })}
      {y.ticks.map(([value, label]) => {
        const tick = px(at(x.low, value)[1]);
        return (
          <g key={label}>
            <path class="rule" d={`M${x0} ${tick}H${width - right}`} />
            <text x={x0 - 6} y={Number(tick) + 4} class="y">
              {label}
            </text>
          </g>
        );
      })}
      <text class="x title" x={(left + width - right) / 2} y={height - 8}>
        {x.label}
      </text>
      <text class="title" x={isFigure ? 14 : 2} y={isFigure ? 24 : 12}>
        {y.label}
      </text>
      {children(at)}
    </svg>
  );
}

/** The path through points. */
export const chain = (at: Place, points: readonly (readonly [number, number])[]) =>
  points.length ? `M${points.map(([x, y]) => at(x, y).map(px).join(" ")).join("L")}` : "";
