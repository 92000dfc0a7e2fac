// The viewer's interface: arrays in, pictures out. The WebGL part is loaded when a viewer is created; the rest is small, and
// draws still pictures without WebGL.
export { type Camera, control } from "./controls";
export { rampStops } from "./color";
export { type FieldProgram, fieldProgram } from "./field_program";
export { edgesOf, exploded, middles, segments } from "./geometry";
export type { DecodedPicture, FieldLayer, Layer, MeshLayer, Paint, Picture, RampName, Section, Vec3 } from "./layers";
export { type Shape, painted, still } from "./still";
export { type Projector, type Size, type View, eyeOf, facing, pick, projector, row } from "./view";

/** Creates a viewer in an element. Rejects if the browser has no WebGL 2; the still picture stays then. */
export async function createViewer(root: HTMLElement): Promise<import("./viewer").Viewer> {
  const { Viewer } = await import("./viewer");
  return new Viewer(root);
}
