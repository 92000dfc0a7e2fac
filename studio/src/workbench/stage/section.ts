// The section plane: where it is, how its handles move it, and what it cuts away.
import { PAINT } from "../../exhibits/paint";
import type { Section, Vec3 } from "../../viewer";
import { dot, plus } from "../../viewer/view";
import type { Box } from "../pixels";

export interface Cut {
  /** Turned from +x around z, and then up, in degrees: points on the side of this direction are cut away. */
  azimuth: number;
  elevation: number;
  /** From the side that stays (0) to the side that is cut away (1) of the shape's box. */
  share: number;
}

/** Across y, in the middle: the half nearer to the first view is cut away. */
export const FIRST: Cut = { azimuth: -90, elevation: 0, share: 0.5 };
export const ALIGNED = { x: { azimuth: 0, elevation: 0 }, y: { azimuth: -90, elevation: 0 }, z: { azimuth: 0, elevation: 90 } } as const;

export function normalOf({ azimuth, elevation }: Pick<Cut, "azimuth" | "elevation">): Vec3 {
  const [a, e] = [(azimuth * Math.PI) / 180, (elevation * Math.PI) / 180];
  // Exactly along an axis if it is aligned: the cosine of 90 degrees is not 0 in binary.
  const snapped = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)].map((x) => (Math.abs(x) < 1e-15 ? 0 : x));
  return snapped as unknown as Vec3;
}

/** The other side is cut away. */
export const flipped = ({ azimuth, elevation, share }: Cut): Cut => ({
  azimuth: azimuth > 0 ? azimuth - 180 : azimuth + 180,
  elevation: -elevation,
  share: 1 - share,
});

/** The least and the greatest offset of the box along a normal. */
function extent([low, high]: Box, normal: Vec3): readonly [number, number] {
  const [from, to] = [[0, 0, 0], [0, 0, 0]];
  for (let k = 0; k < 3; k++) {
    const [a, b] = [normal[k]! * low[k]!, normal[k]! * high[k]!];
    [from[k], to[k]] = [Math.min(a, b), Math.max(a, b)];
  }
  return [from[0]! + from[1]! + from[2]!, to[0]! + to[1]! + to[2]!];
}

export interface CutPlane {
  section: Section;
  /** The middle of the box, on the plane; and where it would be at shares 0 and 1. */
  at: Vec3;
  low: Vec3;
  high: Vec3;
}

export function planeOf(cut: Cut, box: Box): CutPlane {
  const normal = normalOf(cut);
  const [least, most] = extent(box, normal);
  const offset = least + cut.share * (most - least);
  const middle = box[0].map((x, k) => (x + box[1][k]!) / 2) as unknown as Vec3;
  const along = (to: number) => plus(middle, normal, to - dot(normal, middle));
  return { section: { normal, offset, paint: PAINT.mark }, at: along(offset), low: along(least), high: along(most) };
}

/** The axis that a plane stands across, and where; `undefined` if it is tilted. */
export function placeOf({ section: { normal }, at }: CutPlane): { axis: "x" | "y" | "z"; value: number } | undefined {
  const k = normal.findIndex((x) => Math.abs(x) > 1 - 1e-9);
  return k < 0 ? undefined : { axis: "xyz"[k] as "x" | "y" | "z", value: at[k]! };
}

/** Whether a section leaves a point. */
export const isKept = (section: Section | undefined, at: Vec3): boolean => !section || dot(section.normal, at) <= section.offset;

