// The reader's choices. Everything on the page follows from them, and they fit into the address.
import type { Cubic, Point, Smoothness, Spacing } from "../core/types";

export type Language = "en" | "zh";
export type Theme = "auto" | "light" | "dark";
export type View = "curve" | "seam";
/** Which strokes the figure shows: curve and chain overlaid, or only one of them, to be judged by eye. */
export type Look = "both" | "chain" | "curve";
/** Device pixels per CSS pixel; 0 is the density of this screen. */
export type Density = 0 | 1 | 2 | 3;

/** The control points of the second view: four of the first curve, then four of the second. */
export type Eight = readonly [Point, Point, Point, Point, Point, Point, Point, Point];

export interface State {
  view: View;
  control: Cubic;
  segments: number;
  /** The number before it was doubled or halved; `null` after any other change. */
  before: number | null;
  spacing: Spacing;
  look: Look;
  /** The wanted error, in device pixels. */
  goal: Goal;
  t: number;
  density: Density;
  seam: Eight;
  smoothness: Smoothness;
  /** The length of a comb tooth for a curvature of 1, in units. */
  comb: number;
  /** From the address; otherwise the page decides. */
  language: Language | null;
  /** From the address; otherwise the reader's last choice on any page, or the system's: see public/theme.js. */
  theme: Theme | null;
}

export const GOALS = [1, 0.5, 0.25] as const;
export type Goal = (typeof GOALS)[number];
export const MOST_SEGMENTS = 128;

/** The drawing: 10 by 6 units, with a margin so that handles at the edge are visible. */
export const WORLD = { width: 10, height: 6, margin: 0.4 } as const;
/** Control points lie on a grid of hundredths, so that an address stores them exactly. */
export const GRID = 100;

export const DEFAULTS: State = {
  view: "curve",
  control: [
    [1, 0.8],
    [2.2, 5.8],
    [3, 5],
    [9.4, 2],
  ],
  segments: 6,
  before: null,
  spacing: "even",
  look: "both",
  goal: 0.5,
  t: 0.4,
  density: 0,
  seam: [
    [0.6, 1.4],
    [2.2, 5],
    [3.9, 4.4],
    [5, 3.4],
    [5, 3.4],
    [5.6, 1.4],
    [8, 0.6],
    [9.4, 4.4],
  ],
  smoothness: "C0",
  comb: 2,
  language: null,
  theme: null,
};

/** The numbers of segments at the stops of the slider: every number up to 24, then in growing steps. */
export const STOPS: readonly number[] = stops();

function stops(): number[] {
  const counts: number[] = [];
  for (let n = 1; n <= MOST_SEGMENTS; n += n < 24 ? 1 : n < 48 ? 2 : 4) counts.push(n);
  return counts;
}

/** The index of the stop nearest to a number of segments. */
export function stopOf(segments: number): number {
  let best = 0;
  STOPS.forEach((n, i) => {
    if (Math.abs(n - segments) < Math.abs(STOPS[best]! - segments)) best = i;
  });
  return best;
}

export function within(value: number, low: number, high: number): number {
  return Math.min(Math.max(value, low), high);
}

/** The nearest grid point inside the drawing. */
export function onGrid([x, y]: Point): Point {
  const snap = (value: number, most: number) => Math.round(within(value, 0, most) * GRID) / GRID;
  return [snap(x, WORLD.width), snap(y, WORLD.height)];
}

/** A copy of the points in which one point is replaced. */
export function withPoint<P extends readonly Point[]>(points: P, index: number, point: Point): P {
  return points.map((old, i) => (i === index ? point : old)) as unknown as P;
}
