// The viewer for whoever shows something in space: arrays in, pictures out. The part that needs a graphics processor is
// loaded when it is asked for; the rest is small, and draws still pictures without one.
export { type Camera, control } from "./controls";
export { rampStops } from "./color";
export { edgesOf, exploded, middles, segments } from "./geometry";
export type { LaidPicture, Layer, MeshLayer, Paint, Picture, RampName, Section, Vec3 } from "./layers";
export { type Shape, painted, still } from "./still";
export { type Projector, type Size, type View, eyeOf, pick, projector, row } from "./view";

/** A viewer in an element. Refused where the browser has no WebGL 2: then the still picture stays. */
export async function createViewer(root: HTMLElement): Promise<import("./viewer").Viewer> {
  const { Viewer } = await import("./viewer");
  return new Viewer(root);
}
