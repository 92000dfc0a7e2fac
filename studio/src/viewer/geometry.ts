// Geometry for drawing only: edges of triangles, silhouettes, strokes for normals.
import type { MeshLayer, Vec3 } from "./layers";
import { cross, dot, minus, row } from "./view";

export interface Edge {
  ends: readonly [number, number];
  /** The triangles along it. Vertices at the same position count as one. */
  faces: number[];
}

/** The edges of triangles, each once. Vertices are merged by position, so that a split vertex opens no edge. */
export function edgesOf(positions: Float32Array, indices: Uint32Array): Edge[] {
  const first = new Map<string, number>();
  const places = new Uint32Array(positions.length / 3);
  for (let i = 0; i < places.length; i++) {
    // As text, in which 0 and −0 are the same.
    const key = `${positions[3 * i]},${positions[3 * i + 1]},${positions[3 * i + 2]}`;
    const place = first.get(key) ?? i;
    if (place === i) first.set(key, i);
    places[i] = place;
  }
  const edges = new Map<number, Edge>();
  for (let corner = 0; corner < indices.length; corner++) {
    const next = corner % 3 === 2 ? corner - 2 : corner + 1;
    const [a, b] = [places[indices[corner]!]!, places[indices[next]!]!];
    if (a === b) continue;
    // One number for both ends. It is exact below 2^53, so for up to 94 million vertices.
    const key = Math.min(a, b) * places.length + Math.max(a, b);
    const edge = edges.get(key);
    const face = Math.floor(corner / 3);
    if (edge) edge.faces.push(face);
    else edges.set(key, { ends: [a, b], faces: [face] });
  }
  return [...edges.values()];
}

/** The ends of edges, six numbers each. */
export function segments(positions: Float32Array, edges: readonly Edge[]): Float32Array {
  const all = new Float32Array(6 * edges.length);
  edges.forEach(({ ends: [a, b] }, i) => {
    all.set(positions.subarray(3 * a, 3 * a + 3), 6 * i);
    all.set(positions.subarray(3 * b, 3 * b + 3), 6 * i + 3);
  });
  return all;
}

export function corners(positions: Float32Array, indices: Uint32Array, face: number): [Vec3, Vec3, Vec3] {
  return [0, 1, 2].map((k) => row(positions, indices[3 * face + k]!)) as [Vec3, Vec3, Vec3];
}

/** The normal of a triangle, with twice its area as length. */
export function across([a, b, c]: readonly [Vec3, Vec3, Vec3]): Vec3 {
  return cross(minus(b, a), minus(c, a));
}

/** For each triangle, whether its front faces the eye. */
export function seenFronts(positions: Float32Array, indices: Uint32Array, eye: Vec3): boolean[] {
  return Array.from({ length: indices.length / 3 }, (_, face) => {
    const triangle = corners(positions, indices, face);
    return dot(across(triangle), minus(eye, triangle[0])) > 0;
  });
}

/** The outline from an eye: the edges between a front and a back face, and the open ones. */
export function silhouette(positions: Float32Array, indices: Uint32Array, edges: readonly Edge[], eye: Vec3): Float32Array {
  const seen = seenFronts(positions, indices, eye);
  return segments(
    positions,
    edges.filter(({ faces }) => faces.length === 1 || faces.some((face) => seen[face] !== seen[faces[0]!])),
  );
}

/** Strokes from points along directions. */
export function strokes(at: Float32Array, directions: Float32Array, length: number): Float32Array {
  const all = new Float32Array(2 * at.length);
  for (let i = 0; 3 * i < at.length; i++) {
    for (let k = 0; k < 3; k++) {
      all[6 * i + k] = at[3 * i + k]!;
      all[6 * i + 3 + k] = at[3 * i + k]! + length * directions[3 * i + k]!;
    }
  }
  return all;
}

/** The centroids of triangles. */
export function middles(positions: Float32Array, indices: Uint32Array): Float32Array {
  const all = new Float32Array(indices.length);
  for (let face = 0; 3 * face < indices.length; face++) {
    const [a, b, c] = corners(positions, indices, face);
    for (let k = 0; k < 3; k++) all[3 * face + k] = (a[k]! + b[k]! + c[k]!) / 3;
  }
  return all;
}

/** Unshares the triangles' corners and shrinks each triangle towards its centroid by `share`. */
export function exploded({ positions, indices }: Pick<MeshLayer, "positions" | "indices">, share: number) {
  const apart = new Float32Array(3 * indices.length);
  const centres = middles(positions, indices);
  for (let corner = 0; corner < indices.length; corner++) {
    const face = Math.floor(corner / 3);
    for (let k = 0; k < 3; k++) {
      const [x, middle] = [positions[3 * indices[corner]! + k]!, centres[3 * face + k]!];
      apart[3 * corner + k] = x + share * (middle - x);
    }
  }
  return { positions: apart, indices: Uint32Array.from({ length: indices.length }, (_, i) => i) };
}
