// Lengths in pixels of a screen, as the command counts them: in its corners, where a picture is stretched the most.
import type { Vec3, View } from "../viewer";
import { STEEPEST, eyeOf } from "../viewer/view";
import type { Screen } from "./document";

export type Box = readonly [low: Vec3, high: Vec3];

/** Nearer than this share of the way to the target counts as this near: within the box every distance is near. */
const NEAREST = 1e-3;

/** From the eye to the nearest point of a box. */
export function awayFrom([low, high]: Box, view: View): number {
  const beyond = eyeOf(view).map((x, k) => Math.max(low[k]! - x, x - high[k]!, 0));
  return Math.max(Math.hypot(...beyond), NEAREST * view.distance);
}

/** Before a place, on the side where it lies, outside of the box: from behind one would look through the shape. */
export function towards(at: Vec3, view: View, home: View): View {
  const [x, y, z] = at.map((value, k) => value - home.target[k]!) as [number, number, number];
  const [flat, distance] = [Math.hypot(x, y), home.distance / 3];
  // What is nearly in the middle has no side.
  if (Math.hypot(flat, z) < NEAREST * home.distance) return { ...view, target: at, distance };
  const degrees = (radians: number) => (radians * 180) / Math.PI;
  const elevation = Math.max(-STEEPEST, Math.min(STEEPEST, degrees(Math.atan2(z, flat))));
  return { azimuth: flat > 0 ? degrees(Math.atan2(y, x)) : view.azimuth, elevation, distance, target: at };
}

const halfTan = (fovDeg: number): number => Math.tan((fovDeg * Math.PI) / 360);

/** The distance at which the diagonal of a box is as long as a picture is high. */
export const fillingDistance = ([low, high]: Box, fovDeg: number): number =>
  Math.hypot(...low.map((x, k) => high[k]! - x)) / (2 * halfTan(fovDeg));

/** The scale of the screen's corners, and how much longer the way to them is than the way to the middle. */
function corners({ width, height, fovDeg }: Screen): { scale: number; secant: number } {
  const up = halfTan(fovDeg);
  const secant = Math.hypot(1, up, (up * width) / height);
  return { scale: (height / 2 / up) * secant, secant };
}

/** No point that is off by this length moves farther on the screen; without a limit where the eye is as near as that. */
export function pixelsOf(error: number, screen: Screen): number {
  const { scale, secant } = corners(screen);
  const room = screen.distance / secant - error;
  return error === 0 ? 0 : room > 0 ? (scale * error) / room : Infinity;
}

/** The distance from which on a length is no more than so many pixels. */
export function distanceOf(error: number, pixels: number, screen: Screen): number {
  const { scale, secant } = corners(screen);
  return secant * error * (1 + scale / pixels);
}
