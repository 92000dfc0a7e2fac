// Draws a function of the plane: the regions below its levels on top of each other, so that they darken inward.
import { toSvg } from "./Flat";
import { px } from "./Grip";

export type Loops = readonly Float32Array[];
export interface Region {
  level: number;
  loops: Loops;
}

/** Closed lines as one path. */
export function outline(loops: Loops): string {
  return loops
    .map((line) => {
      const points: string[] = [];
      for (let i = 0; i < line.length; i += 2) {
        const [x, y] = toSvg([line[i]!, line[i + 1]!]);
        const text = `${px(x)} ${px(y)}`;
        if (text !== points.at(-1)) points.push(text);
      }
      return `M${points.join("L")}z`;
    })
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
