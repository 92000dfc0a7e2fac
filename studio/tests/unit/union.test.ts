// The outline of many faces: what it covers is what they cover, each judged by counting windings.
import { expect, test } from "vitest";
import { unionPath } from "../../src/exhibits/union";

type Point = readonly [number, number];

/** The loops of a path of M, l and z. */
function loopsOf(d: string): Point[][] {
  return d.split("M").slice(1).map((part) => {
    const [x, y, ...steps] = part.replace(/[lz]/g, " ").trim().split(/\s+/).map(Number) as [number, number, ...number[]];
    const loop: [number, number][] = [[x, y]];
    for (let i = 0; i < steps.length; i += 2) loop.push([loop.at(-1)![0] + steps[i]!, loop.at(-1)![1] + steps[i + 1]!]);
    return loop;
  });
}

/** How often loops go around a point that is on none of them. */
function windings(loops: readonly (readonly Point[])[], [x, y]: Point): number {
  let sum = 0;
  for (const loop of loops) {
    loop.forEach(([ax, ay], i) => {
      const [bx, by] = loop[(i + 1) % loop.length]!;
      if (ay <= y === by <= y) return;
      const isRight = ax + ((y - ay) / (by - ay)) * (bx - ax) > x;
      if (isRight) sum += by > ay ? 1 : -1;
    });
  }
  return sum;
}

/** Numbers between 0 and 1 from a seed: mulberry32 by T. Ettinger. */
function randoms(seed: number): () => number {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

const same = (x: number, y: number) => [x, y] as const;

test("a grid of squares is its rim, whichever way each of them turns", () => {
  const squares: number[] = [];
  for (let x = 0; x < 10; x++) {
    for (let y = 0; y < 10; y++) {
      const corners: Point[] = [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]];
      squares.push(...((x + y) % 2 ? corners : corners.reverse()).flat());
    }
  }
  const d = unionPath(new Float32Array(squares), 4, same);
  const loops = loopsOf(d);
  expect(loops.length).toBe(1);
  expect(loops[0]!.length).toBe(41);
  expect(loops[0]!.at(-1)).toEqual(loops[0]![0]);
});

test("overlapping, crossed and flat faces cover what they cover", () => {
  for (let seed = 1; seed <= 40; seed++) {
    const random = randoms(seed);
    // On a lattice, so that corners and edges coincide often.
    const faces = new Float32Array(Array.from({ length: 8 * 12 }, () => Math.floor(6 * random())));
    const loops = loopsOf(unionPath(faces, 4, same));
    for (let k = 0; k < 60; k++) {
      const point: Point = [6 * random() + 1e-3 * Math.SQRT2, 6 * random() + 1e-3 * Math.LN2];
      let isCovered = false;
      for (let i = 0; i < faces.length; i += 8) {
        const corner = (n: number): Point => [faces[i + 2 * n]!, faces[i + 2 * n + 1]!];
        isCovered ||= [[0, 1, 2], [0, 2, 3]].some((three) => windings([three.map(corner)], point) !== 0);
      }
      expect(windings(loops, point) !== 0, `seed ${seed}, at ${point}`).toBe(isCovered);
    }
  }
});
