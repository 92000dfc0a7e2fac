// What gives the picture its scale: a grid on the ground, the axes, and the sizes of the shape's box.
import type { Layer, Projector, Vec3, View } from "../../viewer";
import { axesOf, dot, minus, plus } from "../../viewer/view";
import type { Box } from "../pixels";
import type { Page } from "../words";

/** About so many squares of the grid across the distance to the target. Chosen: more are a blur. */
const SQUARES = 24;
/** Squares from the middle to the edge of the grid. */
const REACH = 20;
/** The length of a piece of a line, in squares. */
const PIECE = 4;
/** Along a side of the shape with more squares only every fifth line has a number. */
const MOST_LABELS = 8;
/** Below this elevation, in degrees, the ground is seen from the side. */
const LEVEL = 8;
const AXES = { x: "#c8472f", y: "#3f8a3a", z: "#3a6fc8" } as const;

/** The side of a square: 1, 2 or 5 times a power of ten. */
export function gridStep(distance: number): number {
  const rough = distance / SQUARES;
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * ([1, 2, 5, 10].find((times) => times * power >= rough * 0.999) ?? 10);
}

/** The middle of the grid: the target, rounded so that the grid seldom moves. */
export const gridMiddle = ({ target }: View, step: number): readonly [number, number] =>
  [0, 1].map((k) => Math.round(target[k]! / (5 * step)) * 5 * step) as unknown as [number, number];

/** The grid under the shape, around that middle, and the axes through the origin. */
export function groundLayers(box: Box, step: number, middle: readonly [number, number]): Layer[] {
  const [low, high] = box;
  const floor = low[2];
  const reach = REACH * step;
  const [thin, thick]: [number[], number[]] = [[], []];
  for (let i = -REACH; i <= REACH; i++) {
    const [x, y] = [middle[0] + i * step, middle[1] + i * step];
    // Every fifth line, counted from the origin.
    const [ofX, ofY] = [x, y].map((value) => (Math.round(value / step) % 5 === 0 ? thick : thin)) as [number[], number[]];
    // In pieces: the depth along one long line that passes the eye is too coarse to be hidden by the shape.
    for (let at = -reach; at < reach - step / 2; at += PIECE * step) {
      ofX.push(x, middle[1] + at, floor, x, middle[1] + at + PIECE * step, floor);
      ofY.push(middle[0] + at, y, floor, middle[0] + at + PIECE * step, y, floor);
    }
  }
  const long = 1.25 * Math.max(...low.map(Math.abs), ...high.map(Math.abs));
  const line = (id: string, positions: readonly number[], paint: string, width: number): Layer => ({
    kind: "lines",
    id,
    positions: Float32Array.from(positions),
    paint,
    width,
    isWhole: true,
  });
  return [
    line("grid", thin, "--bench-grid", 0.8),
    line("grid-5", thick, "--bench-grid-5", 1),
    line("axis-x", [0, 0, 0, long, 0, 0], AXES.x, 1.4),
    line("axis-y", [0, 0, 0, 0, long, 0], AXES.y, 1.4),
    line("axis-z", [0, 0, 0, 0, 0, long], AXES.z, 1.4),
  ];
}

/** The directions of the axes, in a corner of the picture. */
export function Triad({ view, x, y }: { view: View; x: number; y: number }) {
  const [right, up, back] = axesOf(view);
  const arms = (["x", "y", "z"] as const).map((name, k) => {
    const axis = [0, 0, 0].map((_, i) => Number(i === k)) as unknown as Vec3;
    return { name, dx: 26 * dot(axis, right), dy: -26 * dot(axis, up), depth: dot(axis, back) };
  });
  return (
    <g class="triad" transform={`translate(${x} ${y})`} aria-hidden="true">
      {arms
        .sort((a, b) => a.depth - b.depth)
        .map(({ name, dx, dy }) => (
          <g key={name}>
            <path d={`M0 0L${dx.toFixed(1)} ${dy.toFixed(1)}`} stroke={AXES[name]} />
            <text x={(1.35 * dx).toFixed(1)} y={(1.35 * dy + 4).toFixed(1)} fill={AXES[name]}>
              {name.toUpperCase()}
            </text>
          </g>
        ))}
    </g>
  );
}

/** The numbers along the grid's edges through the origin's axes, every fifth line. */
export function GridLabels({ page, at, view, box, step }: { page: Page; at: Projector; view: View; box: Box; step: number }) {
  const [low, high] = box;
  // From the side all of them would be on one line.
  if (Math.abs(view.elevation) < LEVEL) return null;
  const middle = gridMiddle(view, step);
  const labels: { key: string; point: Vec3; text: string }[] = [];
  for (const k of [0, 1] as const) {
    const other = (1 - k) as 0 | 1;
    // Along the side of the box that is nearer to the eye, a square away from it.
    const side = at.eye[other] > (low[other] + high[other]) / 2 ? high[other] + step : low[other] - step;
    const every = high[k] - low[k] > MOST_LABELS * step ? 5 : 1;
    // As far as the shape and the grid go.
    const [from, to] = [Math.max(low[k], middle[k] - REACH * step), Math.min(high[k], middle[k] + REACH * step)];
    for (let i = Math.ceil(from / step / every) - 1; i <= Math.floor(to / step / every) + 1; i++) {
      const point = [0, 0, low[2]] as [number, number, number];
      point[k] = every * i * step;
      point[other] = side;
      labels.push({ key: `${k} ${i}`, point, text: page.say.number(Number((every * i * step).toPrecision(6))) });
    }
  }
  return (
    <g class="grid-labels" aria-hidden="true">
      {labels.map(({ key, point, text }) => {
        const [x, y, depth] = at.to(point);
        return depth > 0 ? (
          <text key={key} x={x.toFixed(1)} y={(y + 4).toFixed(1)}>
            {text}
          </text>
        ) : null;
      })}
    </g>
  );
}

/** The sizes of the box, beside the edges of its outline that the eye sees. */
export function Sizes({ page, at, view, box, unit }: { page: Page; at: Projector; view: View; box: Box; unit: string }) {
  const [low, high] = box;
  const middle = low.map((x, k) => (x + high[k]!) / 2) as unknown as Vec3;
  const near = low.map((x, k) => (at.eye[k]! > middle[k]! ? high[k]! : x)) as unknown as Vec3;
  const away = 0.06 * Math.hypot(...minus(high, low));
  const lines = [0, 1, 2].map((k) => {
    // Along x and y on the near side of the ground; along z on the corner that is farthest to a side.
    const ends = [low, high].map((end) => {
      const point = [...near] as [number, number, number];
      point[2] = low[2];
      point[k] = end[k]!;
      return point;
    }) as [[number, number, number], [number, number, number]];
    const out: [number, number, number] = [0, 0, 0];
    if (k < 2) {
      const other = 1 - k;
      out[other] = near[other]! > middle[other]! ? away : -away;
      // From the side that would be on the edge itself.
      if (Math.abs(view.elevation) < LEVEL) out[2] = -away;
    } else {
      const corners = [[low[0], near[1]], [high[0], near[1]], [near[0], low[1]], [near[0], high[1]]] as const;
      const widest = [...corners].sort((a, b) => at.to([b[0], b[1], middle[2]])[0] - at.to([a[0], a[1], middle[2]])[0])[0]!;
      for (const end of ends) [end[0], end[1]] = widest;
      for (const j of [0, 1]) out[j] = ((widest[j]! > middle[j]! ? 1 : -1) * away) / Math.SQRT2;
    }
    return { name: "XYZ"[k]!, a: plus(ends[0], out), b: plus(ends[1], out), size: high[k]! - low[k]! };
  });
  return (
    <g class="sizes" aria-hidden="true">
      {lines.map(({ name, a, b, size }) => {
        const [[ax, ay, da], [bx, by, db]] = [at.to(a), at.to(b)];
        const length = Math.hypot(bx - ax, by - ay);
        // Seen along the edge there is no room for its size.
        if (da <= 0 || db <= 0 || length < 24) return null;
        const [tx, ty] = [(-(by - ay) / length) * 4, ((bx - ax) / length) * 4];
        const tick = (x: number, y: number) => `M${(x - tx).toFixed(1)} ${(y - ty).toFixed(1)}L${(x + tx).toFixed(1)} ${(y + ty).toFixed(1)}`;
        return (
          <g key={name}>
            <path d={`M${ax.toFixed(1)} ${ay.toFixed(1)}L${bx.toFixed(1)} ${by.toFixed(1)}${tick(ax, ay)}${tick(bx, by)}`} />
            <text x={((ax + bx) / 2).toFixed(1)} y={((ay + by) / 2 + 4).toFixed(1)}>
              {page.say.number(size)}
              {unit && ` ${unit}`}
            </text>
          </g>
        );
      })}
    </g>
  );
}
