// What the core is asked and what it answers. The shapes are those of crates/chordal-wasm.

/** A point of the plane, in units of the drawing; y points up. */
export type Point = readonly [number, number];
export type Cubic = readonly [Point, Point, Point, Point];

export interface StudyQuestion {
  control: Cubic;
  segments: number;
  /** Another number of segments, to compare with. */
  other: number;
  /** Device pixels in one unit of the drawing. */
  pixels_per_unit: number;
  /** The error that is asked for, in device pixels. */
  pixels: number;
  /** The parameter of the construction. */
  t: number;
  /** How much of the curve around the gap is wanted, in units to either side. */
  near: number;
}

export interface Gap {
  distance: number;
  pixels: number;
  place: number;
  on_curve: Point;
  on_polyline: Point;
  /** The part of the curve around the gap, as a cubic of its own. */
  near: Cubic;
}

export interface Chain {
  points: Point[];
  places: number[];
  segments: number;
  /** None where the curve is a single point. */
  gap: Gap | null;
  bound: { at_least: number; at_most: number | null; pixels: number | null; evidence: string };
}

/** How the segments are placed: equal steps of the parameter, or where they are needed. */
export type Spacing = "even" | "fewest";

export interface StudyAnswer {
  control: Cubic;
  even: Chain;
  fewest: Chain;
  /** The chains of the other number, and how many times the larger gap is the smaller; null where one is zero. */
  other: Record<Spacing, Chain> & { segments: number; times: Record<Spacing, number | null> };
  needed: Needed;
  formula: Formula;
  construction: Construction;
}

/** The smallest numbers of segments that are proved to keep the pixels that were asked for. */
export interface Needed {
  even: number | null;
  /** By equal steps a larger number may lose more: the largest that is not proved, with its gap in pixels. */
  even_fails: { segments: number; pixels: number | null } | null;
  /** From here on every number of equal steps is proved. */
  even_from: number | null;
  fewest: number | null;
}

/** The formula for equal steps: no gap is wider than the second derivative's largest length over 8 N². */
export interface Formula {
  /** That length, in units. */
  bend: number;
  /** The gap that is asked for, in units, and the number of segments that the formula has for it. */
  length: number;
  segments: number;
  /** What the formula allows for the number of segments at hand, in units and in pixels. */
  gap: number;
  pixels: number;
}

export interface Construction {
  t: number;
  first: [Point, Point, Point];
  second: [Point, Point];
  point: Point;
}

export interface LadderQuestion {
  control: Cubic;
  counts: readonly number[];
  pixels_per_unit: number;
}

export interface Rung {
  segments: number;
  gap: number;
  bound: number | null;
}

export interface LadderAnswer {
  control: Cubic;
  counts: number[];
  even: Rung[];
  fewest: Rung[];
  /** Points of the curve with their parameters, for finding the one under a finger. */
  rail: { points: Point[]; places: number[] };
}

export type Smoothness = "none" | "C0" | "C1" | "C2";

export interface SeamQuestion {
  first: Cubic;
  second: Cubic;
  smoothness: Smoothness;
  /** Which curve keeps its points while the other follows. */
  leader: "first" | "second";
  /** How long a tooth of the comb is for a curvature of 1. */
  scale: number;
}

export interface Tooth {
  on_curve: Point;
  tip: Point;
  curvature: number;
}

export interface SeamAnswer {
  first: Cubic;
  second: Cubic;
  join: {
    position_gap: number;
    angle_rad: number | null;
    /** Positive where the curve turns left. */
    curvatures: [number | null, number | null];
    curvature_gap: number | null;
    parametric: number | null;
    geometric: number | null;
  };
  comb: [Tooth[], Tooth[]];
}

/** An exhibit asks by its name; its own file knows what the answer holds. Large arrays in it are typed arrays. */
export type ExhibitQuestion = { exhibit: string } & Record<string, unknown>;

/** Each kind of question with its question and its answer. */
export interface Kinds {
  exhibit: [ExhibitQuestion, unknown];
  study: [StudyQuestion, StudyAnswer];
  ladder: [LadderQuestion, LadderAnswer];
  seam: [SeamQuestion, SeamAnswer];
}
export type Kind = keyof Kinds;
export type QuestionOf<K extends Kind> = Kinds[K][0];
export type AnswerOf<K extends Kind> = Kinds[K][1];

/** From the page to the worker. */
export interface Call {
  id: number;
  kind: Kind;
  question: QuestionOf<Kind>;
}

/**
 * From the worker to the page: an answer, the core's refusal in a sentence, or the news that the module is broken and
 * the worker of no more use.
 */
export type Reply =
  | { id: number; answer: AnswerOf<Kind> }
  | { id: number; refused: string }
  | { id: number; broken: string };
