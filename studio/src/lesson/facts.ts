// The numbers in the lesson's text: computed by the core when the page is built, for the states that its figures open with.
import TEAPOT from "../../../examples/teapot.bpt?raw";
import { STOPS as DISTANCES } from "../exhibits/levels";
import { loaded } from "./figures";
import { DISTANCES as HERO_DISTANCES, levelAt, REST, widthAt } from "./Hero";
import { BLOCKS } from "./outline";
import { levelsOf, type TeapotLevel } from "./teapot_levels";

export interface Facts {
  hero: readonly TeapotLevel[];
  /** The file that the teapot is read from: its patches, and the bytes of its text. */
  teapot: { patches: number; bytes: number };
  /** Triangles of the first picture where its play comes to rest. */
  rest: number;
  indexed: { triangles: number; vertices: number; triangles_per_vertex: number; bytes: number; unindexed_bytes: number; times: number };
  /** Vertices of a cube with hard edges, and with none. */
  cube: { hard: number; soft: number };
  culling: { back_share: number; triangles: number };
  bulge: number;
  runge: { polynomial: number; spline: number };
  /** How many segments have a gap of at most half a pixel; how many it takes to prove it, in equal steps and at best. */
  segments: { seen: number; evenly: number; fewest: number; gaps: ReadonlyMap<number, number> };
  cage: { faces: number; errors: readonly number[] };
  field: { edges: number };
  tracing: { steps: number; most: number };
  csg: { share: number };
  baking: { triangles: number; samples: number; back: number; measured: number };
  budget: { slope: number };
  overshade: { above: number; below: number };
  levels: { near: Both; far: Both; small: Both; smallPixels: number };
  mountain: Both;
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

/** The answer to a figure as the lesson opens it. */
const opened = (ask: Ask, figure: string) => answerOf(ask, figure, BLOCKS.find((block) => block.figure === figure)?.state);

export async function factsOf(ask: Ask): Promise<Facts> {
  const [indexed, quad, culling, runge, segments, cage, field, tracing, csg, baking, budget, mountain] = await Promise.all(
    ["indexed", "quad", "culling", "runge", "segments", "cage", "field", "tracing", "csg", "baking", "budget", "mountain"].map((id) => opened(ask, id)),
  );
  const cube = async (crease: number) => (await answerOf(ask, "normals", { shape: "cube", crease })).vertices as number;
  const gap = async (count: number) => [count, 60 * (await answerOf(ask, "segments", { count })).gap] as const;
  let seen = 1;
  while ((await gap(seen))[1] > 0.5) seen++;
  const shaded = async (stop: number) => (await answerOf(ask, "overshade", { stop })).ratio as number;
  const triangles = async (stop: number): Promise<Both> => {
    const { teapot, mountain } = await answerOf(ask, "levels", { stop });
    return { teapot: teapot.triangles, mountain: mountain.triangles };
  };
  const hero = levelsOf(ask);
  const fan = tracing.fan.map(([, steps]: [number, number]) => steps);
  return {
    hero,
    rest: levelAt(hero, HERO_DISTANCES[REST]!).triangles,
    indexed,
    cube: { hard: await cube(60), soft: await cube(180) },
    culling,
    bulge: Math.abs(quad.bulge),
    runge: { polynomial: runge.moves.polynomial.by, spline: runge.moves.spline.by },
    segments: { ...segments, seen, gaps: new Map(await Promise.all([8, 16, 32].map(gap))) },
    cage,
    field: { edges: field.mesh.edges },
    tracing: { steps: tracing.steps.length, most: Math.max(...fan) },
    csg: { share: csg.share ?? 0 },
    baking: { triangles: baking.triangles[0], samples: baking.samples, back: baking.triangles[1], measured: baking.measured },
    budget,
    overshade: { above: await shaded(0), below: await shaded(26) },
    levels: { near: await triangles(0), far: await triangles(4), small: await triangles(6), smallPixels: widthAt(DISTANCES[6]!) },
    mountain: { teapot: mountain.teapot.triangles, mountain: mountain.mountain.triangles },
    rivals: ask({ exhibit: "rivals" }),
  };
}

    teapot: { patches: Number(TEAPOT.split("\n", 1)[0]), bytes: TEAPOT.length },
