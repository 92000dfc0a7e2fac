// The camera: an eye that orbits a target, with z up. Plain numbers, so that the page, the still picture and the viewer share
// one view.
import type { Vec3 } from "./layers";

export interface View {
  /** Around z, in degrees; 0 looks from +x, 90 from +y. */
  azimuth: number;
  /** Above the horizon, in degrees. */
  elevation: number;
  /** From the target to the eye. */
  distance: number;
  target: Vec3;
  /** Parallel projection, in which lengths at the target have the same size as in perspective. */
  isParallel?: boolean;
}

/** The vertical field of view of a picture of aspect `ASPECT` or wider. Chosen small, so that parallels look parallel. */
const FOV_DEG = 28;
/** A narrower picture gets a wider field of view, so that everything in a picture of this aspect stays visible. */
const ASPECT = 1.5;

export interface Size {
  width: number;
  height: number;
  /** Where the target is drawn, in pixels to the right of the middle and below it; in the middle if left out. */
  shift?: readonly [right: number, down: number];
}

/** The largest elevation: at 90 degrees the up direction is undefined. */
export const STEEPEST = 89;

/** The smallest distance from the centre of a body that has a side, as a share of the distance to the eye. */
const NEAREST = 1e-3;

const radians = (degrees: number) => (degrees * Math.PI) / 180;
export const dot = (a: Vec3, b: Vec3) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const plus = (a: Vec3, b: Vec3, t = 1): Vec3 => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
export const minus = (a: Vec3, b: Vec3): Vec3 => plus(a, b, -1);
export const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const unit = (a: Vec3): Vec3 => {
  const length = Math.hypot(...a) || 1;
  return [a[0] / length, a[1] / length, a[2] / length];
};
/** The point at a row. */
export const row = (of: Float32Array, i: number): Vec3 => [of[3 * i]!, of[3 * i + 1]!, of[3 * i + 2]!];

/** The unit vector from the target towards the eye. */
export function towardsEye({ azimuth, elevation }: View): Vec3 {
  const [a, e] = [radians(azimuth), radians(elevation)];
  return [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
}

export function eyeOf(view: View): Vec3 {
  return plus(view.target, towardsEye(view), view.distance);
}

/** Right, up, and back towards the eye. */
export function axesOf(view: View): readonly [Vec3, Vec3, Vec3] {
  const back = towardsEye(view);
  // From the azimuth alone, so that it is defined for an eye straight above.
  const right: Vec3 = [-Math.sin(radians(view.azimuth)), Math.cos(radians(view.azimuth)), 0];
  return [right, cross(back, right), back];
}

/** Pixels per unit of length at distance 1. */
export const focal = ({ width, height }: Size) => Math.min(height, width / ASPECT) / 2 / Math.tan(radians(FOV_DEG) / 2);

/** The vertical field of view, in degrees. */
export const fovOf = (size: Size) => (2 * Math.atan(size.height / 2 / focal(size)) * 180) / Math.PI;

/** The part of a picture of that size in which everything has the same size as in all of it. */
export const framed = ({ width, height }: Size): Size => ({ width: Math.min(width, ASPECT * height), height: Math.min(height, width / ASPECT) });

export interface Projector {
  /** The position of a point in the picture, in pixels from the upper left, and its depth. */
  to(point: Vec3): readonly [x: number, y: number, depth: number];
  /** The direction of the ray from the eye through a pixel. */
  ray(x: number, y: number): Vec3;
  /** The point at which that ray begins: the eye, except in parallel projection. */
  origin(x: number, y: number): Vec3;
  /** A point after a move in the plane of the view by pixels to the right and down, and by a length away from the eye. */
  moved(point: Vec3, dx: number, dy: number, away?: number): Vec3;
  eye: Vec3;
  /** Pixels per unit of length at a depth. */
  scale(depth: number): number;
}

export function projector(view: View, size: Size): Projector {
  const [right, up, back] = axesOf(view);
  const eye = eyeOf(view);
  const f = focal(size);
  const [x0, y0] = [size.width / 2 + (size.shift?.[0] ?? 0), size.height / 2 + (size.shift?.[1] ?? 0)];
  const { isParallel, distance } = view;
  // Behind the eye the scale would be negative and mirror the point.
  const scale = (depth: number) => f / (isParallel ? distance : Math.max(depth, 1e-9));
  const across = (x: number, y: number, s: number) => plus(plus([0, 0, 0], right, (x - x0) * s), up, (y0 - y) * s);
  return {
    eye,
    scale,
    to(point) {
      const from = minus(point, eye);
      const depth = -dot(from, back);
      return [x0 + dot(from, right) * scale(depth), y0 - dot(from, up) * scale(depth), depth];
    },
    moved: (point, dx, dy, away = 0) => {
      const depth = -dot(minus(point, eye), back);
      return plus(plus(plus(point, right, dx / scale(depth)), up, -dy / scale(depth)), back, -away);
    },
    ray: (x, y) => (isParallel ? plus([0, 0, 0], back, -1) : unit(plus(across(x, y, 1 / f), back, -1))),
    origin: (x, y) => (isParallel ? plus(eye, across(x, y, distance / f)) : eye),
  };
}

/** The view after the pointer moved by `dx` and `dy` pixels. */
export const turned = (view: View, dx: number, dy: number): View => ({
  ...view,
  azimuth: wrapped(view.azimuth - 0.4 * dx),
  elevation: Math.min(Math.max(view.elevation + 0.4 * dy, -STEEPEST), STEEPEST),
});

/** The view turned so that a point on a body's surface faces the eye; `centre` is inside the body. */
export function facing(at: Vec3, view: View, centre: Vec3): View {
  const [x, y, z] = minus(at, centre);
  const flat = Math.hypot(x, y);
  // A point near the centre has no side.
  if (Math.hypot(flat, z) < NEAREST * view.distance) return view;
  const degrees = (angle: number) => (angle * 180) / Math.PI;
  const elevation = Math.max(-STEEPEST, Math.min(STEEPEST, degrees(Math.atan2(z, flat))));
  return { ...view, azimuth: flat > 0 ? degrees(Math.atan2(y, x)) : view.azimuth, elevation };
}

const wrapped = (degrees: number) => degrees - 360 * Math.floor((degrees + 180) / 360);

export function shifted(view: View, size: Size, dx: number, dy: number): View {
  const [right, up] = axesOf(view);
  const scale = view.distance / focal(size);
  return { ...view, target: plus(plus(view.target, right, -dx * scale), up, dy * scale) };
}

export function zoomed(view: View, factor: number, range: readonly [number, number]): View {
  return { ...view, distance: Math.min(Math.max(view.distance * factor, range[0]), range[1]) };
}

/** The nearest triangle under a pixel, by Möller and Trumbore's test; `undefined` if there is none. */
export function pick(projection: Projector, x: number, y: number, positions: Float32Array, indices: Uint32Array): number | undefined {
  const ray = projection.ray(x, y);
  let best: number | undefined;
  let nearest = Infinity;
  for (let face = 0; 3 * face < indices.length; face++) {
    const [a, b, c] = [0, 1, 2].map((k) => row(positions, indices[3 * face + k]!)) as [Vec3, Vec3, Vec3];
    const [ab, ac, from] = [minus(b, a), minus(c, a), minus(projection.eye, a)];
    const p = cross(ray, ac);
    const det = dot(ab, p);
    if (Math.abs(det) < 1e-12) continue;
    const u = dot(from, p) / det;
    const q = cross(from, ab);
    const v = dot(ray, q) / det;
    const t = dot(ac, q) / det;
    if (u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < nearest) {
      nearest = t;
      best = face;
    }
  }
  return best;
}
