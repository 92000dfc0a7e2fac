// Writes gem.obj, a round brilliant of 57 facets and a girdle, and sphere.obj, an icosahedron cut three times, into the
// folder that is named: the two shapes of docs/pictures/gem.png and sphere.png.
//
//   node examples/make_gem.mjs .
//   chordal mesh gem.obj --tol 1 --normals flat -o gem.glb
//   chordal mesh sphere.obj --tol 1 --normals smooth -o sphere.glb
//   chordal render gem.glb -o gem.png --view "480x360 fov=28 eye=2.6,-3.2,1.6 target=0,0,-0.25"
//   chordal render sphere.glb -o sphere.png --view "480x360 fov=30 eye=2.6,-3.2,2.2 target=0,0,0"
//
// Made for this project; the proportions are those of M. Tolkowsky, Diamond Design, 1919, rounded.
import { writeFileSync } from "node:fs";
import { join } from "node:path";

const folder = process.argv[2] ?? ".";
const write = (name, rows, faces) => {
  const lines = [`# ${name}: made by examples/make_gem.mjs`];
  lines.push(...rows.map((p) => `v ${p.join(" ")}`), ...faces.map((f) => `f ${f.map((i) => i + 1).join(" ")}`));
  writeFileSync(join(folder, name), lines.join("\n") + "\n");
};

// The gem: rings of corners, an eighth of a turn after the other. A kite lies in one plane if the middle between its
// two side corners is on the line between its tips; that gives the height of the rings between.
const rows = [];
const add = (r, z, eighths) => {
  const angle = (eighths * Math.PI) / 4;
  rows.push([r * Math.cos(angle), r * Math.sin(angle), z]);
  return rows.length - 1;
};
const ring = (n, r, z, first = 0) => Array.from({ length: n }, (_, i) => add(r, z, first + (8 * i) / n));
const between = ([r0, z0], [r1, z1], r) => [r / Math.cos(Math.PI / 8), z0 + ((r - r0) / (r1 - r0)) * (z1 - z0)];
const [tip, rim, under, point] = [[0.53, 0.32], [1, 0.03], [1, -0.03], [0, -0.86]];
const table = ring(8, ...tip);
const crown = ring(8, ...between(tip, rim, 0.75), 0.5);
const girdle = ring(16, ...rim);
const lower = ring(16, ...under);
const pavilion = ring(8, ...between(under, point, 0.25), 0.5);
const culet = add(...point, 0);
const faces = [table];
for (let i = 0; i < 8; i++) {
  const [before, after, a, b, c] = [(i + 7) % 8, (i + 1) % 8, 2 * i, 2 * i + 1, (2 * i + 2) % 16];
  faces.push([table[i], crown[i], table[after]], [table[i], crown[before], girdle[a], crown[i]]);
  faces.push([crown[i], girdle[a], girdle[b]], [crown[i], girdle[b], girdle[c]]);
  faces.push([girdle[a], lower[a], lower[b], girdle[b]], [girdle[b], lower[b], lower[c], girdle[c]]);
  faces.push([pavilion[i], lower[b], lower[a]], [pavilion[i], lower[c], lower[b]]);
  faces.push([culet, pavilion[i], lower[a], pavilion[before]]);
}
write("gem.obj", rows, faces);

// The sphere: each triangle cut into four, new corners moved out.
const golden = (1 + Math.sqrt(5)) / 2;
const unit = (p) => p.map((x) => x / Math.hypot(...p));
const points = [];
for (const [s, t] of [[1, 1], [-1, 1], [1, -1], [-1, -1]]) {
  points.push(...[[0, s, t * golden], [s, t * golden, 0], [t * golden, 0, s]].map(unit));
}
const near = (i, j) => Math.hypot(...points[i].map((x, k) => x - points[j][k])) < 1.1;
const dot = (p, q) => p.reduce((sum, x, k) => sum + x * q[k], 0);
const cross = (p, q) => p.map((_, k) => p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3]);
let triangles = [];
for (let i = 0; i < 12; i++) {
  for (let j = i + 1; j < 12; j++) {
    for (let k = j + 1; k < 12; k++) {
      if (!near(i, j) || !near(j, k) || !near(k, i)) continue;
      const out = dot(cross(points[i], points[j]), points[k]) > 0;
      triangles.push(out ? [i, j, k] : [i, k, j]);
    }
  }
}
for (let level = 0; level < 3; level++) {
  const middles = new Map();
  const middle = (i, j) => {
    const key = i < j ? `${i} ${j}` : `${j} ${i}`;
    if (!middles.has(key)) middles.set(key, points.push(unit(points[i].map((x, k) => x + points[j][k]))) - 1);
    return middles.get(key);
  };
  triangles = triangles.flatMap(([a, b, c]) => {
    const [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
    return [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
  });
}
write("sphere.obj", points, triangles);
