// The questions to the core and its answers. Their shapes are defined by crates/chordal-wasm.

/** A point of the plane, in units of the drawing; y points up. */
export type Point = readonly [number, number];
export type Cubic = readonly [Point, Point, Point, Point];

export interface StudyQuestion {
  control: Cubic;
  segments: number;
  /** A second number of segments, for comparison. */
  other: number;
  /** Device pixels in one unit of the drawing. */
  pixels_per_unit: number;
  /** The wanted error, in device pixels. */
  pixels: number;
  /** The curve parameter of de Casteljau's construction. */
  t: number;
  /** How much of the curve to return around the gap, in units to either side. */
  near: number;
}

export interface Gap {
  distance: number;
  pixels: number;
  place: number;
  on_curve: Point;
  on_polyline: Point;
  /** The part of the curve around the gap, as a cubic. */
  near: Cubic;
}

export interface Chain {
  points: Point[];
  places: number[];
  segments: number;
  /** `null` if the curve is a single point. */
  gap: Gap | null;
  bound: { at_least: number; at_most: number | null; pixels: number | null; evidence: string };
}

/** How the vertices are placed: in equal steps of the parameter, or so that the fewest segments are needed. */
export type Spacing = "even" | "fewest";

export interface StudyAnswer {
  control: Cubic;
  even: Chain;
  fewest: Chain;
  /** The chains with the other number of segments, and the ratio of the larger gap to the smaller; `null` if one is zero. */
  other: Record<Spacing, Chain> & { segments: number; times: Record<Spacing, number | null> };
  needed: Needed;
  formula: Formula;
  construction: Construction;
}

/** The smallest numbers of segments that are proved to stay within the wanted error. */
export interface Needed {
  even: number | null;
  /** With equal steps a larger number may have a larger gap: the largest number that is not proved, with its gap in pixels. */
  even_fails: { segments: number; pixels: number | null } | null;
  /** From this number on, every number of equal steps is proved. */
  even_from: number | null;
  fewest: number | null;
}

/** The formula for equal steps: the gap is at most max |B″| / 8 N². */
export interface Formula {
  /** max |B″|, in units. */
  bend: number;
  /** The wanted gap, in units, and the number of segments that the formula gives for it. */
  length: number;
  segments: number;
  /** The gap that the formula allows for the current number of segments, in units and in pixels. */
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
  /** Points of the curve with their parameters, to find the one nearest to a finger. */
  rail: { points: Point[]; places: number[] };
}

export type Smoothness = "none" | "C0" | "C1" | "C2";

export interface SeamQuestion {
  first: Cubic;
  second: Cubic;
  smoothness: Smoothness;
  /** The curve that keeps its points; the other one follows. */
  leader: "first" | "second";
  /** The length of a comb tooth for a curvature of 1. */
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

/** A question of an exhibit, by its name; the exhibit's file defines the answer. Large arrays arrive as typed arrays. */
export type ExhibitQuestion = { exhibit: string } & Record<string, unknown>;

/** The question and the answer of each kind. */
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

/** From the worker to the page: an answer, the core's refusal, or why the module is broken and the worker useless. */
export type Reply =
  | { id: number; answer: AnswerOf<Kind> }
  | { id: number; refused: string }
  | { id: number; broken: string };
