// What is measured on triangles: the point under the pointer, snapped to what is near it, and lengths, angles and radii.
import type { Projector, Vec3 } from "../../viewer";
import { cross, dot, minus, plus, row, unit } from "../../viewer/view";
import { type Solid, hit, normalOf } from "./solid";

/** A point on the mesh, what it snapped to, and the triangle under it if there is one. */
export interface Spot {
  at: Vec3;
  on: "vertex" | "edge" | "face";
  face?: number;
  /** The index in `edges` of the edge that it is on. */
  edge?: number;
}

/** A spot snaps to corners and edges within so many pixels. */
const SNAP = { vertex: 11, edge: 8 };

export const distance = (a: Vec3, b: Vec3): number => Math.hypot(...minus(a, b));

/** The spot under a pixel: a corner of the shape, else a point of an edge, else of a face. `isShown` leaves out what a section cut away. */
export function spotAt(solid: Solid, at: Projector, x: number, y: number, isShown: (at: Vec3) => boolean): Spot | undefined {
  const under = faceAt(solid, at, x, y, isShown);
  const { edges, positions } = solid;
  let [best, away]: [Spot | undefined, number] = [undefined, Infinity];
  const near: { spot: Spot; away: number }[] = [];
  for (let edge = 0; 2 * edge < edges.length; edge++) {
    const [a, b] = [row(positions, edges[2 * edge]!), row(positions, edges[2 * edge + 1]!)];
    const [[ax, ay, da], [bx, by, db]] = [at.to(a), at.to(b)];
    if (da <= 0 || db <= 0) continue;
    const [dx, dy] = [bx - ax, by - ay];
    const share = Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1), 0), 1);
    const off = Math.hypot(ax + share * dx - x, ay + share * dy - y);
    if (off < SNAP.edge) near.push({ spot: { at: plus(a, minus(b, a), straight(share, da, db)), on: "edge", edge }, away: SNAP.vertex + off });
    for (const [end, ex, ey, vertex] of [[a, ax, ay, edges[2 * edge]!], [b, bx, by, edges[2 * edge + 1]!]] as const) {
      const far = Math.hypot(ex - x, ey - y);
      if (far < SNAP.vertex && isCorner(solid, vertex)) near.push({ spot: { at: end, on: "vertex", edge }, away: far });
    }
  }
  for (const one of near) {
    if (one.away >= away || !isShown(one.spot.at) || isHidden(solid, at, one.spot.at, isShown)) continue;
    [best, away] = [{ ...one.spot, ...(under ? { face: under.face } : {}) }, one.away];
  }
  return best ?? under;
}

/** The spot of a face under a pixel. */
export function faceAt(solid: Solid, at: Projector, x: number, y: number, isShown: (at: Vec3) => boolean): (Spot & { face: number }) | undefined {
  const under = hit(solid, at.origin(x, y), at.ray(x, y), 0, isShown);
  return under && { at: under.at, on: "face", face: under.face };
}

/** The share along an edge in space, from that on the screen: perspective shortens its far end. */
const straight = (share: number, near: number, far: number): number => (share * near) / (share * near + (1 - share) * far);

function isHidden(solid: Solid, at: Projector, point: Vec3, isShown: (at: Vec3) => boolean): boolean {
  const [x, y] = at.to(point);
  const origin = at.origin(x, y);
  const way = minus(point, origin);
  const first = hit(solid, origin, way, 0, isShown);
  // The triangles at the point itself are met at 1, up to rounding and the thickness of a pixel.
  return first !== undefined && first.way < 1 - 1e-4;
}

const around = new WeakMap<Solid, Map<number, number[]>>();

/** The other ends of the edges at a vertex. */
function ends(solid: Solid, vertex: number): number[] {
  let all = around.get(solid);
  if (!all) {
    all = new Map();
    const { edges } = solid;
    for (let i = 0; i < edges.length; i++) {
      const [here, there] = [edges[i]!, edges[i ^ 1]!];
      const known = all.get(here);
      if (known) known.push(there);
      else all.set(here, [there]);
    }
    around.set(solid, all);
  }
  return all.get(vertex) ?? [];
}

/** Edges that bend by more are two. Chosen: a fine circle bends by less at each vertex, and its own corners do not count. */
const BEND = Math.cos((35 * Math.PI) / 180);

/** Whether edges end or bend there. */
function isCorner(solid: Solid, vertex: number): boolean {
  const others = ends(solid, vertex);
  if (others.length !== 2) return true;
  const [a, b] = others.map((other) => unit(minus(row(solid.positions, other), row(solid.positions, vertex)))) as [Vec3, Vec3];
  return -dot(a, b) < BEND;
}

/** The whole edge of the shape along one edge of the mesh, from corner to corner or around. */
export function chainOf(solid: Solid, edge: number): { points: Vec3[]; length: number; isClosed: boolean } {
  const walk = (from: number, to: number): number[] => {
    const path = [to];
    let [before, now] = [from, to];
    while (now !== from && !isCorner(solid, now)) {
      const next = ends(solid, now).find((other) => other !== before);
      if (next === undefined) break;
      [before, now] = [now, next];
      path.push(now);
    }
    return path;
  };
  const [a, b] = [solid.edges[2 * edge]!, solid.edges[2 * edge + 1]!];
  const forth = walk(a, b);
  const isClosed = forth.at(-1) === a;
  const vertices = isClosed ? [a, ...forth] : [...walk(b, a).reverse(), ...forth];
  const points = vertices.map((vertex) => row(solid.positions, vertex));
  return { points, length: points.slice(1).reduce((sum, point, i) => sum + distance(points[i]!, point), 0), isClosed };
}

/** The angle between two faces as one turns from one to the other, in degrees: 0 if they are parallel, 90 for a box. */
export const angleBetween = (a: Vec3, b: Vec3): number => (Math.atan2(Math.hypot(...cross(a, b)), dot(a, b)) * 180) / Math.PI;

/** The way through the material from a point of a face, against its normal, to where it ends. */
export function thickness(solid: Solid, at: Vec3, face: number): { to: Vec3; size: number } | undefined {
  const inwards = minus([0, 0, 0], normalOf(solid, face));
  // Not the face itself: rounding may place the point a little before it.
  const { bounds } = solid;
  const least = 1e-6 * Math.hypot(bounds[3]! - bounds[0]!, bounds[4]! - bounds[1]!, bounds[5]! - bounds[2]!);
  const other = hit(solid, at, inwards, least);
  return other && { to: other.at, size: other.way };
}

export interface Circle {
  centre: Vec3;
  radius: number;
  axis: Vec3;
  /** How far the vertices are from the circle at most; 0 for three points. */
  off: number;
}

/** The circle through three points; `undefined` if they are on a line. */
export function circleThrough(a: Vec3, b: Vec3, c: Vec3): Circle | undefined {
  const [ab, ac] = [minus(b, a), minus(c, a)];
  const normal = cross(ab, ac);
  const sq = dot(normal, normal);
  if (sq <= 1e-18 * dot(ab, ab) * dot(ac, ac)) return undefined;
  const to = plus(plus([0, 0, 0], cross(normal, ab), dot(ac, ac) / (2 * sq)), cross(ac, normal), dot(ab, ab) / (2 * sq));
  return { centre: plus(a, to), radius: Math.hypot(...to), axis: unit(normal), off: 0 };
}

/** Normals of a cylinder are perpendicular to its axis up to this cosine. Chosen: a cone of one degree is a cone. */
const PERPENDICULAR = 0.017;
/** The most triangles of a face that is recognized. */
const MOST = 20_000;

/** The cylinder whose triangles begin at a face and end at creases; `undefined` if they are no cylinder to within `tolerance`. */
export function cylinderAt(solid: Solid, face: number, tolerance: number): Circle | undefined {
  const faces = smoothFace(solid, face);
  if (faces.length < 3) return undefined;
  const rows = [...new Set(faces.flatMap((one) => [0, 1, 2].map((k) => solid.indices[3 * one + k]!)))];
  // Those of the vertices are of the shape itself; a triangle of a coarse mesh may be tilted.
  const normals = solid.normals ? rows.map((i) => row(solid.normals!, i)) : faces.map((one) => normalOf(solid, one));
  const first = normals[0]!;
  const across = normals.map((normal) => cross(first, normal));
  const widest = across.reduce((best, one) => (dot(one, one) > dot(best, best) ? one : best));
  if (Math.hypot(...widest) < 0.1) return undefined;
  const axis = unit(widest);
  if (normals.some((normal) => Math.abs(dot(normal, axis)) > PERPENDICULAR)) return undefined;
  const u = unit(plus(first, axis, -dot(first, axis)));
  const v = cross(axis, u);
  const vertices = rows.map((i) => row(solid.positions, i));
  const middle = vertices.reduce((sum, point) => plus(sum, point, 1 / vertices.length), [0, 0, 0] as Vec3);
  const flat = vertices.map((point) => minus(point, middle)).map((point) => [dot(point, u), dot(point, v)] as const);
  // Kåsa's fit: x² + y² = 2ax + 2by + c, by least squares about the mean.
  const sum = (of: (x: number, y: number) => number) => flat.reduce((total, [x, y]) => total + of(x, y), 0);
  const [xx, xy, yy] = [sum((x) => x * x), sum((x, y) => x * y), sum((_, y) => y * y)];
  const [xz, yz] = [sum((x, y) => x * (x * x + y * y)), sum((x, y) => y * (x * x + y * y))];
  const det = xx * yy - xy * xy;
  if (det === 0) return undefined;
  const [a, b] = [(xz * yy - yz * xy) / (2 * det), (yz * xx - xz * xy) / (2 * det)];
  const away = flat.map(([x, y]) => Math.hypot(x - a, y - b));
  const radius = away.reduce((total, one) => total + one / away.length, 0);
  const off = Math.max(...away.map((one) => Math.abs(one - radius)));
  if (off > Math.max(tolerance, 1e-3 * radius)) return undefined;
  const along = dot(minus(vertices[0]!, middle), axis);
  return { centre: plus(plus(plus(middle, u, a), v, b), axis, along), radius, axis, off };
}

/** The triangles that are reached from one without crossing a crease. */
export function smoothFace(solid: Solid, face: number): number[] {
  const { indices, places, edges } = solid;
  const key = (a: number, b: number) => Math.min(a, b) * places.length + Math.max(a, b);
  const walls = new Set<number>();
  for (let i = 0; i < edges.length; i += 2) walls.add(key(places[edges[i]!]!, places[edges[i + 1]!]!));
  const beside = new Map<number, number[]>();
  const sides = (one: number) => [0, 1, 2].map((k) => key(places[indices[3 * one + k]!]!, places[indices[3 * one + ((k + 1) % 3)]!]!));
  for (let one = 0; 3 * one < indices.length; one++) {
    for (const side of sides(one)) {
      const known = beside.get(side);
      if (known) known.push(one);
      else beside.set(side, [one]);
    }
  }
  const seen = new Set([face]);
  const open = [face];
  while (open.length && seen.size < MOST) {
    for (const side of sides(open.pop()!)) {
      if (walls.has(side)) continue;
      for (const next of beside.get(side) ?? []) {
        if (seen.has(next)) continue;
        seen.add(next);
        open.push(next);
      }
    }
  }
  return [...seen];
}
