// Half of the teapot's spout, one of Newell's 32 patches, and the curve along its lower side: the control points of the example's
// file, moved and enlarged to fill a figure.
import PATCH from "../../../examples/teapot.bpt?patch=16";
import type { Vec3, View } from "../viewer";
import type { Point } from "./Flat";

/** Where the file's points are in a figure: in hundredths, as an address stores them, which is exact at these scales. */
const placed = (value: number, scale: number, shift: number) => Math.round(100 * (scale * value + shift)) / 100;

/** In space: twice as large, around the origin. */
const TO_SPACE = { scale: 2, shifts: [-5, 0.6, -3] } as const;
export const SPOUT: readonly Vec3[] = PATCH.flat().map((point) => point.map((x, k) => placed(x, TO_SPACE.scale, TO_SPACE.shifts[k]!)) as unknown as Vec3);
/** Seen so that no two of its points are close together in the picture. */
export const SPOUT_VIEW: View = { azimuth: -62, elevation: 38, distance: 8.8, target: [0, -0.05, -0.05] };
/** From below, where its halves meet: the background is behind the crack between them. The core places them so. */
export const SEAM_VIEW: View = { azimuth: -125, elevation: -26, distance: 9.8, target: [0, 0, -0.1] };

/** In the plane, x to the right and z up: as large as leaves room for the names of its points. */
export const TO_PLANE = { scale: 3.2, shifts: [-2, -0.8] } as const;
/** The last points of the rows: they lie in the plane that cuts the teapot in half. */
const side = PATCH.map((row): Point => {
  const [x, , z] = row.at(-1)!;
  return [placed(x, TO_PLANE.scale, TO_PLANE.shifts[0]), placed(z, TO_PLANE.scale, TO_PLANE.shifts[1])];
});
export const SIDE = side as unknown as readonly [Point, Point, Point, Point];
