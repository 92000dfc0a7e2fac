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
}

/** The vertical field of view of a picture of aspect `ASPECT` or wider. Chosen small, so that parallels look parallel. */
const FOV_DEG = 28;
/** A narrower picture gets a wider field of view, so that everything in a picture of this aspect stays visible. */
const ASPECT = 1.5;

export interface Size {
  width: number;
  height: number;
}

/** The largest elevation: at 90 degrees the up direction is undefined. */
export const STEEPEST = 89;

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
  const right = unit(cross([0, 0, 1], back));
  return [right, cross(back, right), back];
}

/** Pixels per unit of length at distance 1. */
const focal = ({ width, height }: Size) => Math.min(height, width / ASPECT) / 2 / Math.tan(radians(FOV_DEG) / 2);

/** The vertical field of view, in degrees. */
export const fovOf = (size: Size) => (2 * Math.atan(size.height / 2 / focal(size)) * 180) / Math.PI;

export interface Projector {
  /** The position of a point in the picture, in pixels from the upper left, and its depth. */
  to(point: Vec3): readonly [x: number, y: number, depth: number];
  /** The direction of the ray from the eye through a pixel. */
  ray(x: number, y: number): Vec3;
  eye: Vec3;
}

export function projector(view: View, size: Size): Projector {
  const [right, up, back] = axesOf(view);
  const eye = eyeOf(view);
  const f = focal(size);
  return {
    eye,
    to(point) {
      const from = minus(point, eye);
      const depth = -dot(from, back);
      // Behind the eye the scale would be negative and mirror the point.
      const scale = f / Math.max(depth, 1e-9);
      return [size.width / 2 + dot(from, right) * scale, size.height / 2 - dot(from, up) * scale, depth];
    },
    ray: (x, y) => unit(plus(plus(plus([0, 0, 0], right, (x - size.width / 2) / f), up, (size.height / 2 - y) / f), back, -1)),
  };
}

/** The view after the pointer moved by `dx` and `dy` pixels. */
export const turned = (view: View, dx: number, dy: number): View => ({
  ...view,
  azimuth: wrapped(view.azimuth - 0.4 * dx),
  elevation: Math.min(Math.max(view.elevation + 0.4 * dy, -STEEPEST), STEEPEST),
});

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
