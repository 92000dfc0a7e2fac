// A figure in the plane: 12 by 8 units, y up.
import type { Children } from "./exhibit";
import { Grip, px } from "./Grip";

export type Point = readonly [number, number];

const SCALE = 60;
export const FLAT = { width: 12, height: 8 } as const;
/** Half the step of the arrow keys, in units. */
const GRID = 0.05;

export const toSvg = ([x, y]: Point): Point => [x * SCALE, (FLAT.height - y) * SCALE];
export const at = (point: Point) => toSvg(point).map(px).join(" ");
export const path = (points: readonly Point[], isClosed = true) => `M${points.map(at).join("L")}${isClosed ? "z" : ""}`;

/** The path of a cubic Bézier curve, from its control points. */
export const cubic = ([a, b, c, d]: readonly [Point, Point, Point, Point]) => `M${at(a)}C${at(b)} ${at(c)} ${at(d)}`;

/** The nearest point inside the figure on a lattice: in hundredths, as the address stores it. */
export function kept([x, y]: Point, lattice = 0.01): Point {
  const steps = Math.round(1 / lattice);
  const within = (value: number, most: number) => Math.min(Math.max(Math.round(value * steps), Math.ceil(0.3 * steps)), Math.floor((most - 0.3) * steps)) / steps;
  return [within(x, FLAT.width), within(y, FLAT.height)];
}

/** A change of a line that nobody sees, in units of the SVG. */
const UNSEEN = 0.12;

/**
 * A line of many points as a path: points that it can do without are left out, by Douglas and Peucker's algorithm, and the
 * others are written relative to the one before. A page of figures is half as large with it.
 */
export function longPath(points: readonly Point[], isClosed: boolean): string {
  const kept = new Uint8Array(points.length);
  kept[0] = kept[points.length - 1] = 1;
  const parts: [number, number][] = [[0, points.length - 1]];
  for (let part = parts.pop(); part; part = parts.pop()) {
    const [from, to] = part;
    const [[ax, ay], [bx, by]] = [points[from]!, points[to]!];
    const length = Math.hypot(bx - ax, by - ay);
    let [farthest, most] = [0, UNSEEN];
    for (let i = from + 1; i < to; i++) {
      const [x, y] = [points[i]![0] - ax, points[i]![1] - ay];
      // A loop ends where it began, and has no chord.
      const off = length ? Math.abs(x * (by - ay) - y * (bx - ax)) / length : Math.hypot(x, y);
      if (off > most) [farthest, most] = [i, off];
    }
    if (farthest) {
      kept[farthest] = 1;
      parts.push([from, farthest], [farthest, to]);
    }
  }
  // In tenths, so that roundings do not add up.
  let last: Point = [0, 0];
  const steps = points.flatMap((point, i) => {
    if (!kept[i]) return [];
    const tenths = [Math.round(point[0] * 10), Math.round(point[1] * 10)] as const;
    const step = `${(tenths[0] - last[0]) / 10} ${(tenths[1] - last[1]) / 10}`;
    last = tenths;
    return [step];
  });
  return `M${steps[0]}${steps.length > 1 ? `l${steps.slice(1).join("l")}` : ""}${isClosed ? "z" : ""}`;
}

export function Flat({ name, children }: { name: string; children: Children }) {
  return (
    <svg class="flat" data-figure viewBox={`0 0 ${FLAT.width * SCALE} ${FLAT.height * SCALE}`} role="group" aria-label={name}>
      {children}
    </svg>
  );
}

interface DotProps {
  name: string;
  spoken: string;
  place: Point;
  isStill: boolean;
  /** The distance of the places that it can have; a hundredth of a unit by default. */
  lattice?: number;
  /** Drawn smaller and paler, for what is not the exhibit's main point. */
  isFaint?: boolean;
  /** The radius of the area that can be grabbed. */
  reach?: number;
  move(change: (from: Point) => Point): void;
  chosen?(): void;
}

/** A point of the plane that can be dragged. */
export function Dot({ name, spoken, place, isStill, lattice = 0.01, isFaint, reach, move, chosen }: DotProps) {
  const step = Math.max(2 * GRID, lattice);
  return (
    <Grip
      name={name}
      spoken={spoken}
      now={place[0]}
      low={0}
      high={FLAT.width}
      at={toSvg(place)}
      isStill={isStill}
      grab={() => (dx, dy) => move(() => kept([place[0] + dx / SCALE, place[1] - dy / SCALE], lattice))}
      step={(right, up) => move(([x, y]) => kept([x + right * step, y + (Math.abs(up) === Infinity ? 0 : up * step)], lattice))}
      {...(isFaint === undefined ? {} : { isFaint })}
      {...(reach === undefined ? {} : { reach })}
      {...(chosen ? { chosen } : {})}
    />
  );
}
