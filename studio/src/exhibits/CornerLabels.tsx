// The names of a triangle's corners in space, beside them and away from its middle.
import type { Projector, Vec3 } from "../viewer";

/** From a corner to the middle of its name, in pixels. */
const AWAY = 27;
/** Half the height of a letter. */
const HALF = 6;

export function CornerLabels({ at, corners, middle, names }: { at: Projector; corners: readonly Vec3[]; middle: Vec3; names: readonly string[] }) {
  const [mx, my] = at.to(middle);
  return corners.map((corner, i) => {
    const [x, y] = at.to(corner);
    const far = Math.hypot(x - mx, y - my) || 1;
    return (
      <text key={i} class="label" x={x + (AWAY * (x - mx)) / far} y={y + (AWAY * (y - my)) / far + HALF}>
        {names[i]}
      </text>
    );
  });
}
