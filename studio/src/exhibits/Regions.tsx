// Draws a function of the plane: the regions below its levels on top of each other, so that they darken inward.
import { longPath, toSvg } from "./Flat";

export type Loops = readonly Float32Array[];
export interface Region {
  level: number;
  loops: Loops;
}

/** Closed lines as one path. */
export function outline(loops: Loops): string {
  return loops
    .map((line) => longPath(Array.from({ length: line.length / 2 }, (_, i) => toSvg([line[2 * i]!, line[2 * i + 1]!])), true))
    .join("");
}

/** `regions` must be sorted from the highest level to the lowest. */
export function Regions({ regions, class: kind = "" }: { regions: readonly Region[]; class?: string }) {
  return (
    <g class={`regions ${kind}`}>
      {regions.map(({ level, loops }) => (
        <path
          key={level}
          class={level > 0 ? "out" : level < 0 ? "in" : "zero"}
          d={outline(loops)}
          fill-rule="evenodd"
        />
      ))}
    </g>
  );
}
