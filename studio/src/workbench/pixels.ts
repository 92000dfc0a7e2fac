// Lengths in pixels, counted as the command does: in the corners of the screen, where perspective stretches the most.
import type { Vec3, View } from "../viewer";
import { eyeOf, facing } from "../viewer/view";
import type { Screen } from "./document";

export type Box = readonly [low: Vec3, high: Vec3];

/** The smallest distance, as a share of the distance to the target; used inside the box, where the true distance is 0. */
const NEAREST = 1e-3;

/** From the eye to the nearest point of a box. */
export function awayFrom([low, high]: Box, view: View): number {
  const beyond = eyeOf(view).map((x, k) => Math.max(low[k]! - x, x - high[k]!, 0));
  return Math.max(Math.hypot(...beyond), NEAREST * view.distance);
}

/** A view of a point from outside the box, on the point's side: from behind, the shape would hide it. */
export function towards(at: Vec3, view: View, home: View): View {
  return { ...facing(at, { ...view, distance: home.distance }, home.target), target: at, distance: home.distance / 4 };
}

const halfTan = (fovDeg: number): number => Math.tan((fovDeg * Math.PI) / 360);

/** The distance at which the box's diagonal is as long as the picture is high. */
export const fillingDistance = ([low, high]: Box, fovDeg: number): number =>
  Math.hypot(...low.map((x, k) => high[k]! - x)) / (2 * halfTan(fovDeg));

/** The scale in the corners of the screen, and the secant of their angle from the view axis. */
function corners({ width, height, fovDeg }: Screen): { scale: number; secant: number } {
  const up = halfTan(fovDeg);
  const secant = Math.hypot(1, up, (up * width) / height);
  return { scale: (height / 2 / up) * secant, secant };
}

/** The largest movement on the screen of a point that is off by `error`; infinite if the eye is that near. */
export function pixelsOf(error: number, screen: Screen): number {
  const { scale, secant } = corners(screen);
  // A point at this distance has the least depth if it is seen in a corner, and the error may bring
  // it nearer still.
  const clearance = screen.distance / secant - error;
  return error === 0 ? 0 : clearance > 0 ? (scale * error) / clearance : Infinity;
}

/** The smallest distance from which an error is at most so many pixels. */
export function distanceOf(error: number, pixels: number, screen: Screen): number {
  const { scale, secant } = corners(screen);
  // `pixelsOf`, solved for the distance.
  return secant * error * (1 + scale / pixels);
}
