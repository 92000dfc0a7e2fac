// Triangles that can be asked: a tree of boxes for rays, and the edges that a reader sees. Built in a worker, asked on the page.
import type { Vec3 } from "../../viewer";
import { corners, across, edgesOf } from "../../viewer/geometry";
import { cross, dot, minus, plus, row, unit } from "../../viewer/view";
import type { Part } from "../glb";

/** The triangles of all parts as one list. */
export interface Triangles {
  positions: Float32Array;
  indices: Uint32Array;
  normals?: Float32Array;
}

/** Triangles with a tree of their boxes. */
export interface Solid extends Triangles {
  /** Six numbers for each node: the low corner of its box and the high one. */
  bounds: Float32Array;
  /** For a leaf its first place in `order`; for any other node its second child, as a negative number. The first one follows it. */
  nodes: Int32Array;
  /** The number of triangles of a leaf, or 0. */
  counts: Uint32Array;
  order: Uint32Array;
  /** Two vertices for each edge that a reader sees: creases and borders. */
  edges: Uint32Array;
  /** For each vertex the first one at the same position. */
  places: Uint32Array;
}

/** Triangles of a leaf. Measured: with fewer the tree is larger and no faster. */
const LEAF = 4;
/** Normals that differ by more are a crease: in the normals of a mesh, and between its triangles if it has none. Chosen. */
const CREASE = { normals: Math.cos((8 * Math.PI) / 180), triangles: Math.cos((30 * Math.PI) / 180) };
/** For more triangles there are no edges, since finding them would take longer than a proof. */
const MOST_FOR_EDGES = 600_000;

export function joined(parts: readonly Part[]): Triangles {
  const count = (of: (part: Part) => number) => parts.reduce((sum, part) => sum + of(part), 0);
  const positions = new Float32Array(count((part) => part.positions.length));
  const indices = new Uint32Array(count((part) => part.indices.length));
  const normals = parts.every((part) => part.normals) ? new Float32Array(positions.length) : undefined;
  let [vertex, corner] = [0, 0];
  for (const part of parts) {
    positions.set(part.positions, 3 * vertex);
    normals?.set(part.normals!, 3 * vertex);
    for (let i = 0; i < part.indices.length; i++) indices[corner + i] = part.indices[i]! + vertex;
    vertex += part.positions.length / 3;
    corner += part.indices.length;
  }
  return { positions, indices, ...(normals ? { normals } : {}) };
}

export function solidOf(triangles: Triangles): Solid {
  const tree = treeOf(triangles);
  return { ...triangles, ...tree, ...creases(triangles) };
}

function treeOf({ positions, indices }: Triangles): Pick<Solid, "bounds" | "nodes" | "counts" | "order"> {
  const faces = indices.length / 3;
  const order = Uint32Array.from({ length: faces }, (_, face) => face);
  const middles = new Float64Array(3 * faces);
  for (let face = 0; face < faces; face++) {
    for (let k = 0; k < 3; k++) {
      for (let corner = 0; corner < 3; corner++) middles[3 * face + k]! += positions[3 * indices[3 * face + corner]! + k]!;
    }
  }
  const [bounds, nodes, counts]: [number[], number[], number[]] = [[], [], []];
  const add = (from: number, to: number): void => {
    const node = nodes.length;
    nodes.push(from);
    counts.push(to - from);
    const box = [Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity];
    const among = [...box];
    for (let i = from; i < to; i++) {
      const face = order[i]!;
      for (let k = 0; k < 3; k++) {
        for (let corner = 0; corner < 3; corner++) {
          const value = positions[3 * indices[3 * face + corner]! + k]!;
          if (value < box[k]!) box[k] = value;
          if (value > box[3 + k]!) box[3 + k] = value;
        }
        const middle = middles[3 * face + k]!;
        if (middle < among[k]!) among[k] = middle;
        if (middle > among[3 + k]!) among[3 + k] = middle;
      }
    }
    bounds.push(...box);
    if (to - from <= LEAF) return;
    const sides = [0, 1, 2].map((k) => among[3 + k]! - among[k]!);
    const axis = sides.indexOf(Math.max(...sides));
    const split = (among[axis]! + among[3 + axis]!) / 2;
    let middle = from;
    for (let i = from; i < to; i++) {
      if (middles[3 * order[i]! + axis]! >= split) continue;
      [order[i], order[middle]] = [order[middle]!, order[i]!];
      middle += 1;
    }
    // Many triangles around one point cannot be split by place; halves in any order still bound the depth.
    if (middle === from || middle === to) middle = (from + to) >> 1;
    counts[node] = 0;
    add(from, middle);
    nodes[node] = -nodes.length;
    add(middle, to);
  };
  if (faces > 0) add(0, faces);
  return { bounds: Float32Array.from(bounds), nodes: Int32Array.from(nodes), counts: Uint32Array.from(counts), order };
}

function creases({ positions, indices, normals }: Triangles): Pick<Solid, "edges" | "places"> {
  const count = positions.length / 3;
  const places = new Uint32Array(count);
  if (indices.length / 3 > MOST_FOR_EDGES) return { edges: new Uint32Array(), places: places.map((_, i) => i) };
  const first = new Map<string, number>();
  for (let i = 0; i < count; i++) {
    const key = `${positions[3 * i]},${positions[3 * i + 1]},${positions[3 * i + 2]}`;
    const place = first.get(key) ?? i;
    if (place === i) first.set(key, i);
    places[i] = place;
  }
  const flat = (face: number) => unit(across(corners(positions, indices, face)));
  /** The normal of a triangle at one of its corners. */
  const normalAt = (face: number, place: number): Vec3 => {
    const corner = [0, 1, 2].find((k) => places[indices[3 * face + k]!] === place)!;
    return row(normals!, indices[3 * face + corner]!);
  };
  const edges: number[] = [];
  for (const { ends, faces } of edgesOf(positions, indices)) {
    const [f, g] = faces as [number, number];
    const isCrease =
      faces.length !== 2 ||
      (normals
        ? ends.every((end) => dot(normalAt(f, end), normalAt(g, end)) < CREASE.normals)
        : dot(flat(f), flat(g)) < CREASE.triangles);
    if (isCrease) edges.push(...ends);
  }
  return { edges: Uint32Array.from(edges), places };
}

/** Where a ray meets a triangle. */
export interface Hit {
  at: Vec3;
  face: number;
  /** The way along the ray, in lengths of its direction. */
  way: number;
}

/** The first triangle along a ray, by Möller and Trumbore's test, that is farther than `least`. */
export function hit(solid: Solid, from: Vec3, towards: Vec3, least = 0, isShown: (at: Vec3) => boolean = () => true): Hit | undefined {
  const { bounds, nodes, counts, order, positions, indices } = solid;
  let best: Hit | undefined;
  if (!nodes.length) return undefined;
  const inverse = towards.map((x) => 1 / x);
  const enters = (node: number): boolean => {
    let [near, far] = [least, best ? best.way : Infinity];
    for (let k = 0; k < 3; k++) {
      const [a, b] = [(bounds[6 * node + k]! - from[k]!) * inverse[k]!, (bounds[6 * node + 3 + k]! - from[k]!) * inverse[k]!];
      // A ray within a side of the box gives 0 · ∞, which is no number and no limit.
      if (Math.min(a, b) > near) near = Math.min(a, b);
      if (Math.max(a, b) < far) far = Math.max(a, b);
    }
    return near <= far * (1 + 1e-12);
  };
  const open = [0];
  while (open.length) {
    const node = open.pop()!;
    if (!enters(node)) continue;
    if (!counts[node]) {
      open.push(-nodes[node]!, node + 1);
      continue;
    }
    for (let i = nodes[node]!; i < nodes[node]! + counts[node]!; i++) {
      const face = order[i]!;
      const [a, b, c] = corners(positions, indices, face);
      const [ab, ac, to] = [minus(b, a), minus(c, a), minus(from, a)];
      const p = cross(towards, ac);
      const det = dot(ab, p);
      if (det === 0) continue;
      const u = dot(to, p) / det;
      const q = cross(to, ab);
      const v = dot(towards, q) / det;
      const way = dot(ac, q) / det;
      if (!(u >= 0 && v >= 0 && u + v <= 1 && way > least && (!best || way < best.way))) continue;
      const at = plus(from, towards, way);
      if (isShown(at)) best = { at, face, way };
    }
  }
  return best;
}

/** The unit normal of a triangle. */
export const normalOf = ({ positions, indices }: Triangles, face: number): Vec3 => unit(across(corners(positions, indices, face)));
