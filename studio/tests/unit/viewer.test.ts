// The viewer without WebGL: the camera, edges, picking, still pictures, colours.
import { expect, test } from "vitest";
import { onRamp, vertexColors } from "../../src/viewer/color";
import { edgesOf, exploded, middles, segments, silhouette } from "../../src/viewer/geometry";
import type { MeshLayer, Vec3 } from "../../src/viewer/layers";
import { still } from "../../src/viewer/still";
import { type View, eyeOf, pick, projector, shifted, turned, zoomed } from "../../src/viewer/view";

const SIZE = { width: 600, height: 400 };
const VIEW: View = { azimuth: 30, elevation: 20, distance: 6, target: [0, 0, 0] };
// A cube of edge 2, with its corners numbered by bits.
const positions = new Float32Array(Array.from({ length: 8 }, (_, i) => [0, 1, 2].map((k) => ((i >> k) & 1) * 2 - 1)).flat());
const quads = [
  [0, 2, 3, 1],
  [4, 5, 7, 6],
  [0, 1, 5, 4],
  [2, 6, 7, 3],
  [0, 4, 6, 2],
  [1, 3, 7, 5],
] as const;
const indices = new Uint32Array(quads.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]));
const cube: MeshLayer = { kind: "mesh", id: "cube", positions, indices, paint: "#808080", shading: "flat", sides: "both" };

test("the target is in the middle, z is up, and a ray through a projected point hits it", () => {
  const at = projector(VIEW, SIZE);
  expect(at.to([0, 0, 0]).slice(0, 2)).toEqual([300, 200]);
  expect(at.to([0, 0, 1])[1]).toBeLessThan(200);
  expect(at.to([0, 0, 0])[2]).toBeCloseTo(6, 9);
  for (const point of [
    [0.3, -0.4, 0.5],
    [-1, 1, 0.2],
  ] as Vec3[]) {
    const [x, y, depth] = at.to(point);
    const ray = at.ray(x, y);
    const eye = eyeOf(VIEW);
    const along = (depth / -(ray[0] * -eye[0] + ray[1] * -eye[1] + ray[2] * -eye[2])) * -6;
    const hit = ray.map((r, k) => eye[k]! + r * along);
    hit.forEach((x, k) => expect(x).toBeCloseTo(point[k]!, 6));
  }
});

test("a point moved in the plane of the view is under the pointer, as deep as before, and deepens along the line of sight", () => {
  const at = projector(VIEW, SIZE);
  const [x, y, depth] = at.to([0.4, -0.7, 0.3]);
  const [mx, my, still] = at.to(at.moved([0.4, -0.7, 0.3], 35, -12));
  expect([mx, my, still]).toEqual([expect.closeTo(x + 35, 9), expect.closeTo(y - 12, 9), expect.closeTo(depth, 9)]);
  expect(at.to(at.moved([0.4, -0.7, 0.3], 0, 0, 0.5))[2]).toBeCloseTo(depth + 0.5, 9);
});

test("turning keeps the distance and stops before the poles; zoom keeps its range; a pan follows the pointer", () => {
  const high = turned(VIEW, 10, 10_000);
  expect(high.elevation).toBe(89);
  expect(Math.hypot(...eyeOf(high))).toBeCloseTo(6, 9);
  expect(turned({ ...VIEW, azimuth: 179 }, -10, 0).azimuth).toBeCloseTo(-177, 9);
  expect(zoomed(VIEW, 100, [2, 20]).distance).toBe(20);
  const moved = projector(shifted(VIEW, SIZE, 40, -25), SIZE).to([0, 0, 0]);
  expect(moved[0]).toBeCloseTo(340, 6);
  expect(moved[1]).toBeCloseTo(175, 6);
});

test("a cube has 18 edges, even if its corners are split, and two triangles at each", () => {
  const apart = exploded({ positions, indices }, 0);
  for (const mesh of [{ positions, indices }, apart]) {
    const edges = edgesOf(mesh.positions, mesh.indices);
    expect(edges.length).toBe(18);
    expect(edges.every(({ faces }) => faces.length === 2)).toBe(true);
    expect(segments(mesh.positions, edges).length).toBe(18 * 6);
  }
});

test("the silhouette of a cube seen from a corner is a hexagon; an open edge is one, too", () => {
  const eye = eyeOf({ ...VIEW, azimuth: 45, elevation: 35 });
  expect(silhouette(positions, indices, edgesOf(positions, indices), eye).length).toBe(6 * 6);
  const open = indices.subarray(0, 3);
  expect(silhouette(positions, open, edgesOf(positions, open), eye).length).toBe(3 * 6);
});

test("the nearest triangle is picked, and none outside of the body", () => {
  const at = projector({ ...VIEW, azimuth: 0, elevation: 0 }, SIZE);
  // From +x the last quad is visible.
  expect([10, 11]).toContain(pick(at, 300, 200, positions, indices));
  expect(pick(at, 5, 5, positions, indices)).toBeUndefined();
});

test("shrunk triangles keep their centroids", () => {
  const apart = exploded({ positions, indices }, 0.3);
  const [a, b] = [middles(positions, indices), middles(apart.positions, apart.indices)];
  a.forEach((x, i) => expect(b[i]).toBeCloseTo(x, 5));
});

/** Shapes that follow each other and look alike are one path. */
const triangles = (shapes: readonly { d: string }[]) => shapes.flatMap(({ d }) => d.match(/z/g) ?? []).length;

test("a still picture draws far triangles first, and culling omits back faces", () => {
  const shapes = still({ layers: [cube] }, VIEW, SIZE);
  const fronts = still({ layers: [{ ...cube, sides: "front" }] }, VIEW, SIZE);
  expect([triangles(shapes), triangles(fronts)]).toEqual([12, 6]);
  expect(shapes.map(({ depth }) => depth)).toEqual(shapes.map(({ depth }) => depth).sort((a, b) => b - a));
  const backs = still({ layers: [{ ...cube, back: "#ff0000", shading: "none" }] }, VIEW, SIZE);
  expect(triangles(backs.filter(({ fill }) => fill === "#ff0000"))).toBe(6);
});

test("values become colours of a ramp between its ends", () => {
  expect(onRamp("heat", -1)).toEqual(onRamp("heat", 0));
  const layer: MeshLayer = {
    ...cube,
    values: { of: new Float32Array([0, 1, 2, 3, 4, 5, 6, 7]), range: [0, 7], ramp: "deviation" },
  };
  const colors = vertexColors(layer)!;
  onRamp("deviation", 1).forEach((x, k) => expect(colors[21 + k]).toBeCloseTo(x, 6));
  onRamp("deviation", 0).forEach((x, k) => expect(colors[k]).toBeCloseTo(x, 6));
});
