// The view of a shape: where the whole of it is seen, and whether the view follows a shape that changed.
import type { Size, Vec3, View } from "../../viewer";
import { focal } from "../../viewer/view";
import type { Box } from "../pixels";

export const HOME: View = { azimuth: -56, elevation: 22, distance: 6, target: [0, 0, 0] };
/** The distance from the centre of the box to the eye, in diagonals. */
const AWAY = 2.4;
/** If the size changes by this factor, the view is set anew. Chosen: up to it the eye stays outside of the shape. */
const OTHER_SIZE = 3;
/** The same for a view that was only turned since: there is nothing to keep. Chosen: a smaller growth is best seen as such. */
const OUTGROWN = 1.25;
/** A shape that moved by this share of its diagonal is looked for by such a view. */
const MOVED = 0.25;

interface Framed {
  view: View;
  home: View;
  /** The view as it was set last; `null` for another shape. */
  before: View | null;
  /** The distance for what the panels leave, as a multiple of that for the whole picture. */
  room: number;
}

/** Around the shape there are its sizes. */
const MARGIN = 1.15;
/** Not farther than so many times: between two wide panels in a small window a part of the shape says more than all of it. */
const FARTHEST = 1.5;

/** How much farther away a shape has to be so that it fits into a part of the picture. */
export function roomFor(size: Size, free: Size): number {
  // The box's diagonal from there, in pixels.
  const diagonal = focal(size) / AWAY;
  const room = (MARGIN * diagonal) / Math.max(Math.min(free.width, free.height), 1);
  return Math.min(Math.max(room, 1), FARTHEST);
}

const isAt = (view: View, place: View): boolean => view.distance === place.distance && view.target.every((x, k) => x === place.target[k]);

/** The view that shows the whole box, and that to take now; without one the view stays. */
export function framing([low, high]: Box, { view, home: oldHome, before, room }: Framed, isDragged: boolean): { home: View; view?: View } {
  const diagonal = Math.hypot(...low.map((x, k) => high[k]! - x)) || 1;
  const target = low.map((x, k) => (x + high[k]!) / 2) as unknown as Vec3;
  const home = { ...HOME, target, distance: room * AWAY * diagonal };
  const { azimuth, elevation } = before ? view : HOME;
  const next = { ...view, ...home, azimuth, elevation };
  if (!before) return { home, view: next };
  // Whoever has come nearer, or looks at a place, is left there; and so is a hand that drags a number.
  const isUntouched = isAt(view, before) || isAt(view, oldHome);
  const grown = home.distance / (isUntouched ? view : before).distance;
  const isMoved = isUntouched && Math.hypot(...target.map((x, k) => x - view.target[k]!)) > MOVED * diagonal;
  const isFitting = Math.max(grown, 1 / grown) < (isUntouched ? OUTGROWN : OTHER_SIZE) && !isMoved;
  return isDragged || isFitting ? { home } : { home, view: next };
}
