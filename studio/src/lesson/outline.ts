// The lesson's structure, which both languages share: sections, the blocks in them, their figures with a first state, guesses,
// code, terms and questions. The texts of a language are in en.tsx and zh.tsx; a test holds that they fill every place.
import { SEAM_VIEW, SPOUT, SPOUT_VIEW } from "../exhibits/spout";
import type { Facts } from "./facts";

/** A prediction before the reveal. */
export type GuessPlan =
  | { kind: "number"; answer(facts: Facts): number }
  /** Two to four options, of which one is right. */
  | { kind: "choice"; options: readonly string[]; right: string };

export interface BlockPlan {
  id: string;
  /** An exhibit's id, or that of a figure of the lesson. Without one the text stands alone. */
  figure?: string;
  /** What differs from the exhibit's own initial state. */
  state?: Record<string, unknown>;
  /** Its first control repeats what the hand does in the picture, and is folded with the others on a narrow screen. */
  isByHand?: true;
  /** Asked before the figure, whose number is covered until then. */
  guess?: GuessPlan;
  /** A file's name in code/, without its ending. */
  code?: string;
  /** A still of both answers stands here. */
  twoAnswers?: true;
  /** The table of the two answers stands here. */
  table?: true;
}

export interface SectionPlan {
  id: string;
  blocks: readonly BlockPlan[];
}

/** Figures that have no page of their own; see figures.ts. */
export const OWN_FIGURES = ["segments"] as const;

export const SECTIONS = [
  {
    id: "question",
    blocks: [{ id: "two", twoAnswers: true }],
  },
  {
    id: "atom",
    blocks: [
      { id: "plane", figure: "quad", isByHand: true, guess: { kind: "choice", options: ["up", "down", "both"], right: "both" } },
      { id: "inside", figure: "inside", code: "inside" },
      { id: "pixels", figure: "pixels" },
      { id: "weights", figure: "weights", isByHand: true, code: "blend" },
      { id: "tangent", figure: "tangent" },
      { id: "fan", figure: "fan", code: "fan" },
    ],
  },
  {
    id: "mesh",
    blocks: [
      {
        id: "indexed",
        figure: "indexed",
        state: { stop: 9 },
        guess: { kind: "number", answer: (facts) => facts.indexed.triangles_per_vertex },
        code: "buffers",
      },
      { id: "cross", figure: "cross", code: "normal" },
      {
        id: "normals",
        figure: "normals",
        state: { shape: "teapot", crease: 0, arrows: false, view: { azimuth: -58, elevation: 26, distance: 5, target: [0, 0, 0] } },
        guess: { kind: "choice", options: ["8", "24", "36"], right: "24" },
        code: "normals",
      },
      { id: "winding", figure: "culling", isByHand: true },
      { id: "manifold", figure: "doctor", code: "check" },
    ],
  },
  {
    id: "smooth",
    blocks: [
      { id: "bernstein", figure: "bernstein", state: { form: "spout" }, isByHand: true, code: "casteljau" },
      { id: "runge", figure: "runge", guess: { kind: "choice", options: ["near", "half", "everywhere"], right: "everywhere" } },
      { id: "spline", figure: "spline" },
      { id: "joins", figure: "joins" },
      { id: "ride", figure: "ride" },
      { id: "patch", figure: "patch", state: { control: SPOUT, chosen: 6, view: SPOUT_VIEW }, code: "patch" },
      { id: "cage", figure: "cage" },
      { id: "pull", figure: "pull" },
      {
        id: "segments",
        figure: "segments",
        guess: { kind: "number", answer: (facts) => facts.segments.seen },
        code: "segments",
      },
      { id: "cracks", figure: "cracks", state: { patches: "spout", view: SEAM_VIEW } },
    ],
  },
  {
    id: "field",
    blocks: [
      { id: "field", figure: "field", code: "field" },
      { id: "tracing", figure: "tracing", guess: { kind: "number", answer: (facts) => facts.tracing.steps }, code: "trace" },
      { id: "csg", figure: "csg", state: { operation: "difference" }, code: "csg" },
      { id: "blend", figure: "blend" },
      { id: "booleans", figure: "booleans" },
      { id: "squares", figure: "squares" },
      { id: "cubes", figure: "cubes" },
      { id: "network", figure: "network" },
      {
        id: "baking",
        figure: "baking",
        state: { shape: "teapot", cells: 20, view: { azimuth: -60, elevation: 22, distance: 5, target: [0, 0, 0] } },
        code: "baking",
      },
      { id: "table", table: true },
    ],
  },
  {
    id: "cost",
    blocks: [
      { id: "budget", figure: "budget", code: "budget" },
      { id: "overshade", figure: "overshade", guess: { kind: "number", answer: (facts) => facts.overshade.below } },
      { id: "shimmer", figure: "shimmer" },
      {
        id: "levels",
        figure: "levels",
        state: { stop: 0 },
        guess: { kind: "choice", options: ["teapot", "same", "mountain"], right: "teapot" },
        code: "levels",
      },
      { id: "adaptive", figure: "adaptive" },
      { id: "mountain", figure: "mountain" },
    ],
  },
] as const satisfies readonly SectionPlan[];

type Section = (typeof SECTIONS)[number];
export type SectionId = Section["id"];
export type Block = Section["blocks"][number];
export type BlockId = Block["id"];
export type GuessId = Extract<Block, { guess: unknown }>["id"];

/** The blocks of a section, with their optional parts. */
export const blocksOf = (section: Section): readonly BlockPlan[] => section.blocks;
export const BLOCKS: readonly BlockPlan[] = SECTIONS.flatMap((section) => blocksOf(section));

/** The words of the field, in the order of their first use. */
export const TERMS = [
  "explicit",
  "implicit",
  "planar",
  "normal",
  "convex",
  "edge-function",
  "rasterization",
  "barycentric",
  "uv",
  "tangent",
  "triangulation",
  "mesh",
  "vertex-buffer",
  "index-buffer",
  "cross-product",
  "shading",
  "winding",
  "culling",
  "manifold",
  "t-junction",
  "control-point",
  "bezier",
  "bernstein",
  "convex-hull",
  "de-casteljau",
  "runge",
  "spline",
  "continuity",
  "curvature",
  "tensor-product",
  "cage",
  "subdivision",
  "tessellation",
  "chord",
  "signed-distance",
  "gradient",
  "sphere-tracing",
  "csg",
  "marching-cubes",
  "occupancy",
  "baking",
  "overshading",
  "aliasing",
  "lod",
  "screen-space",
  "silhouette",
] as const;
export type TermId = (typeof TERMS)[number];

/** The six questions at the end. */
export const QUESTIONS = ["triangles", "normals", "winding", "joins", "fields", "cost"] as const;
export type QuestionId = (typeof QUESTIONS)[number];

/** Where a shape of the reader's own is shown beside the teapot, in the order of the page: below a block, or at the ending. */
export const STATIONS = [
  { id: "triangles", at: "fan" },
  { id: "buffers", at: "indexed" },
  { id: "normals", at: "normals" },
  { id: "sound", at: "manifold" },
  { id: "field", at: "baking" },
  { id: "levels", at: "levels" },
  { id: "bound", at: "ending" },
] as const satisfies readonly { id: string; at: BlockId | "ending" }[];
export type StationId = (typeof STATIONS)[number]["id"];
