// What the reader has chosen: everything that the page shows follows from it, and it fits into the address.
import type { Cubic, Point, Smoothness, Spacing } from "../core/types";

export type Language = "en" | "zh";
export type Theme = "auto" | "light" | "dark";
export type View = "curve" | "seam";
/** What the figure shows: the curve and its chain laid over each other, or one of them alone, as a stroke to be judged. */
export type Look = "both" | "chain" | "curve";
/** Device pixels per CSS pixel: those of this screen, or of another one. */
export type Density = 0 | 1 | 2 | 3;

/** Four points, then four more: the curve of the first view, and those of the second. */
export type Eight = readonly [Point, Point, Point, Point, Point, Point, Point, Point];

export interface State {
  view: View;
  control: Cubic;
  segments: number;
  /** The number before it was doubled or halved; none after any other change. */
  before: number | null;
  spacing: Spacing;
  look: Look;
  /** The error that is asked for, in device pixels. */
  goal: Goal;
  t: number;
  density: Density;
  seam: Eight;
  smoothness: Smoothness;
  /** The length of a tooth of the comb for a curvature of 1, in units. */
  comb: number;
  /** As the address says; else the page decides. */
  language: Language | null;
  /** As the address says; else as the reader chose on any page, or as the system does: see public/theme.js. */
  theme: Theme | null;
}

export const GOALS = [1, 0.5, 0.25] as const;
export type Goal = (typeof GOALS)[number];
export const MOST_SEGMENTS = 128;

/** The drawing: 10 by 6 units, with a margin in which handles at the edge still show. */
export const WORLD = { width: 10, height: 6, margin: 0.4 } as const;
/** Control points lie on a grid of hundredths, so that an address holds them exactly. */
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

/** The numbers of segments at the stops of the slider: every one while they are few, then in growing steps. */
export const STOPS: readonly number[] = stops();

function stops(): number[] {
  const all: number[] = [];
  for (let n = 1; n <= MOST_SEGMENTS; n += n < 24 ? 1 : n < 48 ? 2 : 4) all.push(n);
  return all;
}

/** The stop nearest to a number of segments. */
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

/** The point of the grid nearest to where the hand is, inside the drawing. */
export function onGrid([x, y]: Point): Point {
  const snap = (value: number, most: number) => Math.round(within(value, 0, most) * GRID) / GRID;
  return [snap(x, WORLD.width), snap(y, WORLD.height)];
}

/** The same points with one in another place. */
export function withPoint<P extends readonly Point[]>(points: P, index: number, point: Point): P {
  return points.map((old, i) => (i === index ? point : old)) as unknown as P;
}
