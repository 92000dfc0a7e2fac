// Measuring on the triangles of parts whose sizes are known.
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { beforeAll, describe, expect, test } from "vitest";
import { run } from "../../src/core/command";
import { parts } from "../../src/workbench/glb";
import { angleBetween, chainOf, circleThrough, cylinderAt, spotAt, thickness } from "../../src/workbench/measure/measures";
import { type Solid, hit, joined, normalOf, solidOf } from "../../src/workbench/measure/solid";
import { flipped, isKept, planeOf } from "../../src/workbench/stage/section";
import { gridStep } from "../../src/workbench/stage/ground";
import { fitted, zoomedTo } from "../../src/workbench/stage/orbit";
import { unitOf } from "../../src/workbench/stage/unit";
import { type Vec3, type View, pick, projector } from "../../src/viewer";

let module: WebAssembly.Module;
beforeAll(async () => {
  const path = join(import.meta.dirname, "../../wasm/command.wasm");
  expect(existsSync(path), "make studio-page builds the module").toBe(true);
  module = await WebAssembly.compile(readFileSync(path));
}, 60_000);

/** The mesh of a script, and what its points are off by. */
async function solid(script: string, tol: string): Promise<{ solid: Solid; atMost: number }> {
  const words = ["mesh", "a.star", "--tol", tol, "-o", "a.glb", "--json"];
  const outcome = await run(module, words, { "a.star": new TextEncoder().encode(script) });
  const { certificate } = JSON.parse(outcome.stdout);
  return { solid: solidOf(joined(parts(outcome.outputs["a.glb"]!, certificate.frame))), atMost: certificate.bound.at_most };
}

const VIEW: View = { azimuth: -56, elevation: 22, distance: 12, target: [0, 0, 0] };
const SIZE = { width: 900, height: 600, shift: [120, -30] } as const;
const everywhere = () => true;

describe("a box with a hole", () => {
  let block: Solid;
  let atMost: number;
  beforeAll(async () => {
    ({ solid: block, atMost } = await solid("box(4, 3, 1) - cylinder(0.4, 2)", "0.1%"));
  }, 60_000);

  test("has its corners, edges, walls and angles", () => {
    const at = projector(VIEW, SIZE);
    const corner: Vec3 = [2, -1.5, 0.5];
    const [x, y] = at.to(corner);
    const spot = spotAt(block, at, x + 5, y + 3, everywhere)!;
    expect(spot.on).toBe("vertex");
    spot.at.forEach((value, k) => expect(Math.abs(value - corner[k]!)).toBeLessThanOrEqual(atMost));
    // The middle of the upper edge in front, and the whole edge from it.
    const [ex, ey] = at.to([0.3, -1.5, 0.5]);
    const edge = spotAt(block, at, ex, ey, everywhere)!;
    expect(edge.on).toBe("edge");
    const chain = chainOf(block, edge.edge!);
    expect([chain.isClosed, Math.abs(chain.length - 4) <= 2 * atMost]).toEqual([false, true]);
    const front = hit(block, [1.3, -9, 0.1], [0, 1, 0])!;
    expect(thickness(block, front.at, front.face)!.size).toBeCloseTo(3, 5);
    const top = hit(block, [1.5, 1, 9], [0, 0, -1])!;
    expect(thickness(block, top.at, top.face)!.size).toBeCloseTo(1, 5);
    expect(angleBetween(normalOf(block, front.face), normalOf(block, top.face))).toBeCloseTo(90, 5);
  });

  test("has a hole of its radius, a round edge, and a circle through three of its points", () => {
    // From the middle of the hole outwards.
    const wall = hit(block, [0, 0, 0.1], [1, 0.1, 0])!;
    const cylinder = cylinderAt(block, wall.face, atMost)!;
    expect(Math.abs(cylinder.radius - 0.4)).toBeLessThanOrEqual(atMost);
    expect(Math.abs(cylinder.axis[2])).toBeCloseTo(1, 6);
    expect(Math.hypot(cylinder.centre[0], cylinder.centre[1])).toBeLessThanOrEqual(2 * atMost);
    const flat = hit(block, [1.5, 1, 9], [0, 0, -1])!;
    expect(cylinderAt(block, flat.face, atMost)).toBeUndefined();
    const at = projector({ ...VIEW, elevation: 70 }, SIZE);
    const [x, y] = at.to([0.4, 0, 0.5]);
    const edge = spotAt(block, at, x, y, everywhere)!;
    const chain = chainOf(block, edge.edge!);
    expect(chain.isClosed).toBe(true);
    expect(chain.length / (2 * Math.PI * 0.4)).toBeCloseTo(1, 1);
    const [a, b, c] = [chain.points[0]!, chain.points[chain.points.length >> 2]!, chain.points[chain.points.length >> 1]!];
    expect(circleThrough(a, b, c)!.radius).toBeCloseTo(0.4, 2);
    expect(circleThrough([0, 0, 0], [1, 1, 1], [2, 2, 2])).toBeUndefined();
  });

  test("is met by rays where the slow test meets it, in both projections", () => {
    for (const view of [VIEW, { ...VIEW, isParallel: true }, { ...VIEW, azimuth: 10, elevation: 90 }]) {
      const at = projector(view, SIZE);
      for (let i = 0; i < 400; i++) {
        const [x, y] = [(i * 37.3) % SIZE.width, (i * 91.7) % SIZE.height];
        const slow = pick({ ...at, eye: at.origin(x, y) }, x, y, block.positions, block.indices);
        const fast = hit(block, at.origin(x, y), at.ray(x, y));
        // Where two triangles meet either is right, at the same place.
        expect(fast === undefined).toBe(slow === undefined);
        if (!fast) continue;
        const [px, py] = at.to(fast.at);
        expect(Math.hypot(px - x, py - y)).toBeLessThan(1e-6);
      }
    }
  });

  test("does not snap to what is hidden or cut away", () => {
    const at = projector(VIEW, SIZE);
    const [x, y] = at.to([-2, 1.5, -0.5]);
    expect(spotAt(block, at, x, y, everywhere)?.on).not.toBe("vertex");
    const { section } = planeOf({ azimuth: -90, elevation: 0, share: 0.5 }, [[-2, -1.5, -0.5], [2, 1.5, 0.5]]);
    const [cx, cy] = at.to([2, -1.5, 0.5]);
    const spot = spotAt(block, at, cx, cy, (point) => isKept(section, point));
    expect(spot === undefined || isKept(section, spot.at)).toBe(true);
  });
});

test("a section cuts the same plane from the other side after a flip", () => {
  const box = [[-2, -1.5, -0.5], [2, 1.5, 0.5]] as const;
  const cut = { azimuth: 30, elevation: 40, share: 0.3 };
  const [one, other] = [planeOf(cut, box).section, planeOf(flipped(cut), box).section];
  one.normal.forEach((x, k) => expect(x).toBeCloseTo(-other.normal[k]!, 12));
  expect(one.offset).toBeCloseTo(-other.offset, 12);
});

test("the wheel keeps the point under the pointer, without a limit that a reader meets", () => {
  let view = VIEW;
  const point: Vec3 = [1.2, -1.5, 0.3];
  const [x, y] = projector(view, SIZE).to(point);
  for (let i = 0; i < 60; i++) view = zoomedTo(view, point, 0.85, VIEW);
  expect(view.distance).toBeLessThan(1e-3);
  const [nx, ny] = projector(view, SIZE).to(point);
  expect([nx, ny].map((value) => Math.round(value * 10))).toEqual([x, y].map((value) => Math.round(value * 10)));
  expect(fitted(view, VIEW)).toEqual(VIEW);
});

test("squares of the grid are 1, 2 or 5 times a power of ten, and units have their symbols", () => {
  for (const distance of [0.003, 1, 13.4, 77, 1e6]) {
    const digits = Number(gridStep(distance).toExponential().split("e")[0]);
    expect([1, 2, 5]).toContain(Math.round(digits * 1e6) / 1e6);
  }
  expect([unitOf(0.001), unitOf(0.0254), unitOf(1), unitOf(null), unitOf(0.7)]).toEqual(["mm", "in", "m", "", ""]);
});
