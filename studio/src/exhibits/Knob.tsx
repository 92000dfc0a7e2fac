// A point in space that can be dragged over a 3D figure: in the plane of the view, or along a line. Arrow keys move it in the
// same way, Page Up and Page Down away from the eye and towards it. It goes into the overlay of a `Scene`.
import type { Projector, Vec3 } from "../viewer";
import { dot, minus, plus, unit } from "../viewer/view";
import { Grip, px } from "./Grip";

/** The step of an arrow key, as a share of the distance to the eye: about seven pixels. */
const STEP = 0.01;
/** Where handles are close together, as on a net of control points: 32 pixels across. */
const CLOSE = 16;

interface KnobProps {
  name: string;
  place: Vec3;
  /** The projection of the figure. */
  at: Projector;
  isStill: boolean;
  /** The position in words, after the name. */
  spoken: string;
  /** The coordinates are kept within ± this. */
  within: number;
  /** Called for drags and keys; `change` takes the newest position, since keys may be faster than frames. */
  move(change: (from: Vec3) => Vec3): void;
  /** The only line on which it moves. */
  along?: Vec3;
  /** Whether others are near, so that it can be grabbed only close by. */
  isClose?: boolean;
  isFaint?: boolean;
  /** Shows the height above this plane while the point is held. */
  ground?: number;
  chosen?(): void;
}

export function Knob({ name, place, at, isStill, spoken, within, move, along, isClose, isFaint, ground, chosen }: KnobProps) {
  const [x, y, depth] = at.to(place);
  const kept = (point: Vec3) => point.map((c) => rounded(Math.min(Math.max(c, -within), within))) as unknown as Vec3;
  /** The point after a move by pixels and a length away from the eye. */
  const shifted = (from: Vec3, dx: number, dy: number, away = 0): Vec3 => {
    if (!along) return kept(at.moved(from, dx, dy, away));
    const line = unit(along);
    // The line as the figure shows it, over a length in which perspective hardly bends.
    const [ax, ay] = at.to(plus(from, line, 0.01));
    const [fx, fy] = at.to(from);
    const [wx, wy] = [(ax - fx) * 100, (ay - fy) * 100];
    // A line towards the eye is very short in the figure, hence the lower limit.
    const length = (dx * wx + dy * wy) / Math.max(wx * wx + wy * wy, 400);
    return kept(plus(from, line, length + away * Math.sign(dot(line, minus(from, at.eye)))));
  };
  const step = STEP * depth;
  // Pixels of a step, as the figure is scaled.
  const pixels = step / Math.hypot(...minus(at.moved(place, 1, 0), place));
  const foot = ground === undefined ? undefined : at.to([place[0], place[1], ground]);
  return (
    <g class="knob">
      <Grip
        name={name}
        spoken={spoken}
        now={place[0]}
        low={-within}
        high={within}
        at={[x, y]}
        isStill={isStill}
        reach={isClose ? CLOSE : 24}
        isFaint={isFaint ?? false}
        grab={() => (dx, dy) => move(() => shifted(place, dx, dy))}
        step={(right, up) => {
          // Home and End have no meaning in space.
          if (Number.isFinite(right) && Number.isFinite(up)) move((from) => shifted(from, right * pixels, -up * pixels));
        }}
        deepen={(away) => move((from) => shifted(from, 0, 0, away * step))}
        {...(chosen ? { chosen } : {})}
      />
      {foot && !isStill && <path class="drop" d={`M${px(x)} ${px(y)}L${px(foot[0])} ${px(foot[1])}m-5 0h10`} />}
    </g>
  );
}

/** In hundredths, as the address stores it. */
const rounded = (value: number) => Math.round(value * 100) / 100;
