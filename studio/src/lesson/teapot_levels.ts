// The levels of the teapot for the first picture, in one small file: a line of JSON, then the arrays. Written at build time from
// the core's answers, so that the page needs no core for its first picture.

/** The teapot's width, in metres: the core's exhibit scales it so. */
export const WIDTH = 0.26;
/** Steps of positions in a metre: an eighth of the finest level's error. */
const GRID = 32_000;
/** How far rounding to that moves a point at most: half a step along each axis. */
export const ROUNDED = Math.sqrt(3) / 2 / GRID;

/** Levels with larger errors would be shown smaller than the smallest picture here. */
export const MOST_LEVELS = 7;

export interface TeapotLevel {
  positions: Float32Array;
  indices: Uint32Array;
  triangles: number;
  /** The proved error with that of rounding, in metres. */
  error: number;
  /** The distance at which that is a pixel of a screen of 1920 by 1080, in metres. */
  from: number;
}

/** The part of the answer of the exhibit `levels` that is used. */
interface LevelsAnswer {
  teapot: {
    mesh: { positions: Float32Array; indices: Uint32Array };
    level: number;
    levels: [from: number, triangles: number, error: number][];
  };
}

/** The levels, by the core's exhibit, not yet rounded. */
export function levelsOf(ask: (question: { exhibit: string; distance: number }) => LevelsAnswer): TeapotLevel[] {
  const { levels } = ask({ exhibit: "levels", distance: 1 }).teapot;
  return levels.slice(0, MOST_LEVELS).map(([from, triangles, error], i) => {
    // A little farther than where it begins; the finest is shown from any distance below that of the next.
    const { mesh, level } = ask({ exhibit: "levels", distance: Math.max(1.01 * from, 0.6) }).teapot;
    if (level !== i) throw new Error(`level ${i} of the teapot is not shown where it begins`);
    const off = error + ROUNDED;
    return { ...mesh, triangles, error: off, from: (from * off) / error };
  });
}

interface Head {
  triangles: number;
  vertices: number;
  error: number;
  from: number;
}

export function packed(levels: readonly TeapotLevel[]): Uint8Array {
  const heads: Head[] = levels.map(({ positions, triangles, error, from }) => ({ triangles, vertices: positions.length / 3, error, from }));
  const head = new TextEncoder().encode(`${JSON.stringify(heads)}\n`);
  const parts = levels.flatMap(({ positions, indices }) => [Int16Array.from(positions, (x) => Math.round(x * GRID)), Uint16Array.from(indices)]);
  const bytes = new Uint8Array(head.length + parts.reduce((sum, { byteLength }) => sum + byteLength, 0));
  bytes.set(head);
  let at = head.length;
  for (const { buffer, byteLength } of parts) {
    bytes.set(new Uint8Array(buffer), at);
    at += byteLength;
  }
  return bytes;
}

export function unpacked(bytes: ArrayBuffer): TeapotLevel[] {
  const all = new Uint8Array(bytes);
  const end = all.indexOf(10);
  const heads = JSON.parse(new TextDecoder().decode(all.subarray(0, end))) as Head[];
  let at = end + 1;
  // Copied, because an array of 16-bit numbers cannot begin at an odd byte.
  const take = (length: number) => bytes.slice(at, (at += length));
  return heads.map(({ triangles, vertices, error, from }) => ({
    triangles,
    error,
    from,
    positions: Float32Array.from(new Int16Array(take(6 * vertices)), (x) => x / GRID),
    indices: Uint32Array.from(new Uint16Array(take(6 * triangles))),
  }));
}
