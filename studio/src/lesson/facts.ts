// The numbers in the lesson's text: computed by the core when the page is built, for the states that its figures open with.
import TEAPOT from "../../../examples/teapot.bpt?raw";
import { STOPS as DISTANCES } from "../exhibits/levels";
import { STOPS as SIDES } from "../exhibits/overshade";
import { loaded } from "./figures";
import { DISTANCES as HERO_DISTANCES, levelAt, REST, widthAt } from "./Hero";
import { BLOCKS } from "./outline";
import { levelsOf, type TeapotLevel } from "./teapot_levels";

export interface Facts {
  /** The file that the teapot is read from: its patches, and the bytes of its text. */
  teapot: { patches: number; bytes: number };
  hero: readonly TeapotLevel[];
  /** Triangles of the first picture where its play comes to rest. */
  rest: number;
  indexed: { triangles: number; vertices: number; triangles_per_vertex: number; bytes: number; unindexed_bytes: number; times: number };
  /** Vertices of a cube with hard edges, and with none. */
  cube: { hard: number; soft: number };
  culling: { back_share: number; triangles: number; holes: number };
  bulge: number;
  /** Through so many points: how far the two move if the middle one is lifted by that. */
  runge: { points: number; lift: number; polynomial: number; spline: number };
  /** How much of a corner's way the surface moves where it moves most. */
  pull: number;
  /** How many segments have a gap of at most half a pixel; how many it takes to prove it, in equal steps and at best. */
  segments: { seen: number; evenly: number; fewest: number; gaps: ReadonlyMap<number, number> };
  field: { edges: number };
  tracing: { steps: number; most: number };
  baking: { triangles: number; samples: number; back: number; measured: number };
  /** What half the error takes, as a factor: segments of a curve; triangles of a surface, at least and at most. */
  budget: { curve: number; surfaces: readonly [number, number] };
  overshade: { above: number; below: number };
  levels: {
    near: Both;
    far: Both;
    small: Both;
    smallPixels: number;
    /** The length of a pixel on each, from near, in metres. */
    pixel: Both;
    /** How far the mountain is behind the teapot, in metres, and how many times as wide it is. */
    behind: number;
    wider: number;
  };
  /** Both in one picture, within so many pixels, the teapot so many metres away. */
  mountain: Both & { pixels: number; distance: number };
  rivals: Rivals;
}

/** A block with a hole, as a mesh and as a field. */
interface Rivals {
  triangles: number;
  bytes: number;
  bound: number;
  /** Vertices with a normal each. */
  normals: number;
  /** Triangles of the block and of the hole, and the pairs of them. */
  operands: readonly [number, number];
  pairs: number;
  /** Operations of the field for one point. */
  operations: number;
  /** Of a ray that meets it: on average, and the most. */
  steps: number;
  most_steps: number;
}

interface Both {
  teapot: number;
  mountain: number;
}

// Each exhibit defines its answer.
type Answer = any;
export type Ask = (question: { exhibit: string } & Record<string, unknown>) => Answer;

/** The answer to a figure in a state. */
export async function answerOf(ask: Ask, figure: string, state: object = {}): Promise<Answer> {
  const exhibit = await loaded(figure);
  return ask({ exhibit: figure, ...exhibit.question({ ...(exhibit.defaults as object), ...state }) });
}

/** What a figure's state is as the lesson opens it. */
const stateOf = async (figure: string) => ({ ...(await loaded(figure)).defaults, ...BLOCKS.find((block) => block.figure === figure)?.state });

/** The answer to a figure as the lesson opens it. */
const opened = async (ask: Ask, figure: string) => answerOf(ask, figure, await stateOf(figure));

/** By what a number grows from one step to the next, on average over all steps. */
const growth = (counts: readonly number[]) => (counts.at(-1)! / counts[0]!) ** (1 / (counts.length - 1));

/** The size of a mesh along x. */
function width({ positions }: { positions: Float32Array }): number {
  const xs = positions.filter((_, i) => i % 3 === 0);
  return xs.reduce((most, x) => Math.max(most, x)) - xs.reduce((least, x) => Math.min(least, x));
}

export async function factsOf(ask: Ask): Promise<Facts> {
  const [indexed, quad, culling, runge, pull, segments, field, tracing, baking, budget, mountain, near] = await Promise.all(
    ["indexed", "quad", "culling", "runge", "pull", "segments", "field", "tracing", "baking", "budget", "mountain", "levels"].map((id) => opened(ask, id)),
  );
  const atOnce = (await loaded("mountain")).question(await stateOf("mountain")) as { px: number; distance: number };
  const cube = async (crease: number) => (await answerOf(ask, "normals", { shape: "cube", crease })).vertices as number;
  const gap = async (count: number) => [count, 60 * (await answerOf(ask, "segments", { count })).gap] as const;
  let seen = 1;
  while ((await gap(seen))[1] > 0.5) seen++;
  const shaded = async (stop: number) => (await answerOf(ask, "overshade", { stop })).ratio as number;
  const triangles = async (stop: number): Promise<Both> => {
    const { teapot, mountain } = await answerOf(ask, "levels", { stop });
    return { teapot: teapot.triangles, mountain: mountain.triangles };
  };
  const grown = (...names: string[]): number[] =>
    budget.series.filter(({ name }: { name: string }) => names.includes(name)).map(({ steps }: { steps: [number, number, number][] }) => growth(steps.map(([, count]) => count)));
  const surfaces = grown("patch", "cage", "field");
  const pixelOf = ({ error, pixels }: { error: number; pixels: number }) => error / pixels;
  const hero = levelsOf(ask);
  const fan = tracing.fan.map(([, steps]: [number, number]) => steps);
  return {
    teapot: { patches: Number(TEAPOT.split("\n", 1)[0]), bytes: TEAPOT.length },
    hero,
    rest: levelAt(hero, HERO_DISTANCES[REST]!).triangles,
    indexed,
    cube: { hard: await cube(60), soft: await cube(180) },
    culling,
    bulge: Math.abs(quad.bulge),
    runge: { points: runge.points.length, lift: (await stateOf("runge")).lift, polynomial: runge.moves.polynomial.by, spline: runge.moves.spline.by },
    pull: pull.largest,
    segments: { ...segments, seen, gaps: new Map(await Promise.all([8, 16, 32].map(gap))) },
    field: { edges: field.mesh.edges },
    tracing: { steps: tracing.steps.length, most: Math.max(...fan) },
    baking: { triangles: baking.triangles[0], samples: baking.samples, back: baking.triangles[1], measured: baking.measured },
    budget: { curve: grown("curve")[0]!, surfaces: [Math.min(...surfaces), Math.max(...surfaces)] },
    overshade: { above: await shaded(0), below: await shaded(SIDES.length - 1) },
    levels: {
      near: await triangles(0),
      far: await triangles(4),
      small: await triangles(6),
      smallPixels: widthAt(DISTANCES[6]!),
      pixel: { teapot: pixelOf(near.teapot), mountain: pixelOf(near.mountain) },
      behind: near.mountain.distance - near.teapot.distance,
      wider: Number((width(near.mountain.mesh) / width(near.teapot.mesh)).toPrecision(3)),
    },
    mountain: { teapot: mountain.teapot.triangles, mountain: mountain.mountain.triangles, pixels: atOnce.px, distance: atOnce.distance },
    rivals: ask({ exhibit: "rivals" }),
  };
}

