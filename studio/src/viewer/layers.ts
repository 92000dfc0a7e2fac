// What the viewer draws: layers of plain arrays. Whoever shows something hands over a list of them; a layer whose arrays
// are the same objects as before is not built again.

export type Vec3 = readonly [number, number, number];

/** A colour as CSS writes it, or the name of a custom property of the root, such as `--ink`. */
export type Paint = string;

interface Common {
  /** Names the layer from one list to the next. */
  id: string;
  /** Whether it shows through what stands before it. */
  isOnTop?: boolean;
  /** Whether everything else covers it: a ground to stand on. */
  isUnder?: boolean;
}

/** Triangles. */
export interface MeshLayer extends Common {
  kind: "mesh";
  /** x, y, z of each vertex. */
  positions: Float32Array;
  /** Three rows for each triangle; counter-clockwise is the front. */
  indices: Uint32Array;
  /** One for each vertex, for smooth shading. */
  normals?: Float32Array;
  /** Red, green, blue of each vertex, 0 to 1 as a screen has them. */
  colors?: Float32Array;
  /** A number for each vertex, drawn by a ramp of colours. */
  values?: { of: Float32Array; range: readonly [number, number]; ramp: RampName };
  /** A group for each triangle, and the paint of each group; the layer's own where it has none. */
  groups?: { of: Uint32Array; paints: readonly Paint[] };
  /** The picture of each group, and where each vertex is in it, from its upper left corner. Groups stand in runs. */
  pictures?: { uv: Float32Array; of: readonly (LaidPicture | undefined)[] };
  paint: Paint;
  /** What the backs are painted with, where they differ: so winding shows. */
  back?: Paint;
  /** One tone for each triangle, blended normals, or no light at all. */
  shading: "flat" | "smooth" | "none";
  /** Which sides are drawn: `front` is what culling leaves. */
  sides: "both" | "front";
  opacity?: number;
}

/** A picture, and what is beyond its ends, as glTF numbers it. */
export interface LaidPicture {
  image: ImageBitmap;
  wrap: readonly [number, number];
}

/** Segments: two points each. */
export interface LineLayer extends Common {
  kind: "lines";
  positions: Float32Array;
  paint: Paint;
  /** In CSS pixels. */
  width: number;
}

/** The edges of triangles, each once. */
export interface WireLayer extends Common {
  kind: "wire";
  positions: Float32Array;
  indices: Uint32Array;
  paint: Paint;
  width: number;
}

/** The edges between a triangle that faces the eye and one that does not, and the open ones; new for every view. */
export interface SilhouetteLayer extends Common {
  kind: "silhouette";
  positions: Float32Array;
  indices: Uint32Array;
  paint: Paint;
  width: number;
}

/** Directions that stand on points. */
export interface NormalLayer extends Common {
  kind: "normals";
  at: Float32Array;
  directions: Float32Array;
  length: number;
  paint: Paint;
  width: number;
}

export interface PointLayer extends Common {
  kind: "points";
  positions: Float32Array;
  paint: Paint;
  /** The diameter in CSS pixels. */
  size: number;
}

export type Layer = MeshLayer | LineLayer | WireLayer | SilhouetteLayer | NormalLayer | PointLayer;

/** What lies in front of the plane is cut away: normal · p > offset. */
export interface Section {
  normal: Vec3;
  offset: number;
  /** What the inside of a closed mesh is painted with where it is cut. */
  paint: Paint;
}

export interface Picture {
  layers: readonly Layer[];
  section?: Section;
}

export type RampName = "deviation" | "heat";
