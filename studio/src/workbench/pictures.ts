// Pictures that the command renders of the input, from the reader's viewpoint.
import type { Size, Vec3, View } from "../viewer";
import { eyeOf, fovOf } from "../viewer/view";
import { type Bench, type Line, hasField, isScript, reading } from "./document";
import { type Part, fromZUp, partFromZUp } from "./glb";
import { plyOf } from "./ply";
import type { Report } from "./report";

/** The pictures beside the mesh: rendered by the command, or a slice that the page draws. */
export type Beside = "traced" | "sliced" | "distance" | "overshade";
export type PictureKind = Exclude<Beside, "sliced">;

export interface PictureOf {
  kind: PictureKind;
  png: Uint8Array;
  report: Report;
  /** What it shows, and from where. */
  bench: Bench;
  view: View;
}

/** The pictures that an input can have. Distances are measured between triangles, so for a field only the bound is known. */
export function besides(bench: Bench): readonly Beside[] {
  if (isScript(bench)) return ["traced", "sliced", "overshade"];
  return hasField(bench) || bench.combine ? ["sliced", "overshade"] : ["sliced", "distance", "overshade"];
}

/** The picture to show: the chosen one if the input can have it. */
export const besideOf = (bench: Bench, chosen: Beside): Beside => (besides(bench).includes(chosen) ? chosen : besides(bench)[0]!);

/** The subject of a picture. */
interface Subject {
  bench: Bench;
  /** The triangles that are shown, with z up, and the up axis of the file. */
  parts: readonly Part[];
  up: string | null;
  /** An upper bound of their distance, if known, for the darkest colour. */
  atMost: number | null;
}

/** The command line that renders a picture, and its input files. */
export function pictureLine(kind: PictureKind, { bench, parts, up, atMost }: Subject, view: View, size: Size): { line: Line; files: Bench["files"] } {
  // Only for distances are the triangles turned back into the axes of the file that they are
  // compared with. Those for overshading keep z up.
  const camera = cameraText(view, size, kind === "distance" ? up : null);
  const viewAndOutput = ["--view", camera, "-o", "picture.png"];
  const shown = "the-triangles-that-are-shown.ply";
  switch (kind) {
    case "traced":
      return { line: ["render", ...reading(bench), ...viewAndOutput], files: bench.files };
    case "overshade":
      return { line: ["render", shown, "--show", "overshade", ...viewAndOutput], files: { [shown]: plyOf(parts) } };
    case "distance": {
      const [name, ...options] = reading(bench);
      const darkest = atMost ? ["--darkest", String(atMost)] : [];
      const line = ["render", shown, "--show", "deviation", "--against", name!, ...options, ...darkest, ...viewAndOutput];
      return { line, files: { ...bench.files, [shown]: plyOf(parts.map((part) => partFromZUp(part, up))) } };
    }
  }
}

/** A view as the command's option, in the file's coordinates. */
export function cameraText(view: View, { width, height }: Size, up: string | null): string {
  const numbers = (v: Vec3) => fromZUp(v, up).map((value) => Number(value.toPrecision(7))).join(",");
  const eye = `eye=${numbers(eyeOf(view))} target=${numbers(view.target)} up=${numbers([0, 0, 1])}`;
  return `${width}x${height} fov=${fovOf({ width, height }).toFixed(3)} ${eye}`;
}
