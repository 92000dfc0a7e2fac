// The viewer's input: a list of layers, which are plain arrays. A layer whose arrays are the same objects as before is not
// built again.

import type { FieldProgram } from "./field_program";

export type Vec3 = readonly [number, number, number];

/** A CSS colour, or the name of a custom property of the root, such as `--ink`. */
export type Paint = string;

interface Common {
  /** Identifies the layer from one list to the next. */
  id: string;
  /** Whether it is visible through layers in front of it, as a dimension in a drawing. */
  isOnTop?: boolean;
  /** Whether it marks a place on a body: faint where the body hides it. Only lines and points are marks. */
  isMark?: boolean;
  /** Whether all other layers cover it, as a ground. */
  isUnder?: boolean;
  /** Whether a section leaves it whole. */
  isWhole?: boolean;
}

/** Triangles. */
export interface MeshLayer extends Common {
  kind: "mesh";
  /** x, y, z of each vertex. */
  positions: Float32Array;
  /** Three vertex indices for each triangle; counter-clockwise is the front. */
  indices: Uint32Array;
  /** One for each vertex, for smooth shading. */
  normals?: Float32Array;
  /** Red, green, blue of each vertex, 0 to 1 in sRGB. */
  colors?: Float32Array;
  /** A number for each vertex, drawn with a colour ramp. */
  values?: { of: Float32Array; range: readonly [number, number]; ramp: RampName };
  /** The group of each triangle, and the paint of each group. Without groups, the layer's own paint is used. */
  groups?: { of: Uint32Array; paints: readonly Paint[] };
  /** The picture of each group, and each vertex's texture coordinates from the upper left. Groups must be contiguous. */
  pictures?: { uv: Float32Array; of: readonly (DecodedPicture | undefined)[] };
  paint: Paint;
  /** The paint of back faces, if it differs, to show the winding. */
  back?: Paint;
  /** One tone for each triangle, interpolated normals, or no lighting. */
  shading: "flat" | "smooth" | "none";
  /** Which sides are drawn; `front` is back-face culling. */
  sides: "both" | "front";
  opacity?: number;
}

/** A picture and its wrap modes in s and t, with glTF's numbers. */
export interface DecodedPicture {
  image: ImageBitmap;
  wrap: readonly [number, number];
}

/** Line segments, two points each. */
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

/** The edges between a front-facing and a back-facing triangle, and the open ones; computed for every view. */
export interface SilhouetteLayer extends Common {
  kind: "silhouette";
  positions: Float32Array;
  indices: Uint32Array;
  paint: Paint;
  width: number;
}

/** Directions drawn from points. */
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

/** A field, traced by the graphics card; nothing in still pictures and without WebGL. */
export interface FieldLayer extends Common {
  kind: "field";
  program: FieldProgram;
  paint: Paint;
  /** The paint of the surface from inside, if it differs. */
  back?: Paint;
  /** The light of the meshes (by default), that of the core's pictures, the normal as a colour, or the steps of each ray. */
  light?: "plain" | "studio" | "normals" | "steps";
  /** Called when the field is drawn, and when it cannot be drawn: the program does not compile, or the context is lost. */
  drawn?(isDrawn: boolean): void;
}

export type Layer = FieldLayer | MeshLayer | LineLayer | WireLayer | SilhouetteLayer | NormalLayer | PointLayer;

/** A clipping plane: points with normal · p > offset are cut away. */
export interface Section {
  normal: Vec3;
  offset: number;
  /** The paint of the inside of a closed mesh, visible in the cut. */
  paint: Paint;
}

export interface Picture {
  layers: readonly Layer[];
  section?: Section;
}

export type RampName = "deviation" | "heat" | "share";
