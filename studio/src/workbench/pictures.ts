// Pictures that the command takes of what is on the bench, from where the reader looks.
import type { Size, Vec3, View } from "../viewer";
import { eyeOf, fovOf } from "../viewer/view";
import { type Bench, type Line, hasField, isScript, reading } from "./document";
import { type Part, lain, lying } from "./glb";
import { plyOf } from "./ply";
import type { Report } from "./report";

/** What stands beside the mesh: pictures of the command, and a slice that the page draws itself. */
export type Beside = "traced" | "sliced" | "distance" | "overshade";
export type PictureKind = Exclude<Beside, "sliced">;

export interface PictureOf {
  of: PictureKind;
  png: Uint8Array;
  report: Report;
}

/** What can stand beside a shape. A distance is measured between triangles: the bound says what is known of a field's. */
export function besides(of: Bench): readonly Beside[] {
  if (isScript(of)) return ["traced", "sliced", "overshade"];
  return hasField(of) || of.combine ? ["sliced", "overshade"] : ["sliced", "distance", "overshade"];
}

/** What stands beside it: what was chosen where the shape has that. */
export const besideOf = (of: Bench, chosen: Beside): Beside => (besides(of).includes(chosen) ? chosen : besides(of)[0]!);

/** What is pictured. */
interface Subject {
  bench: Bench;
  /** The triangles that are shown, with z up, and the axis that is up in the file. */
  parts: readonly Part[];
  up: string | null;
  /** No triangle is farther away, as far as is known. */
  atMost: number | null;
}

/** The line that takes a picture, and the files that it reads. */
export function pictureLine(what: PictureKind, { bench, parts, up, atMost }: Subject, view: View, size: Size): { line: Line; files: Bench["files"] } {
  const camera = cameraText(view, size, what === "distance" ? up : null);
  const last = ["--view", camera, "-o", "picture.png"];
  const shown = "the-triangles-that-are-shown.ply";
  switch (what) {
    case "traced":
      return { line: ["render", ...reading(bench), ...last], files: bench.files };
    case "overshade":
      return { line: ["render", shown, "--show", "overshade", ...last], files: { [shown]: plyOf(parts) } };
    case "distance": {
      const [name, ...options] = reading(bench);
      const darkest = atMost ? ["--darkest", String(atMost)] : [];
      const line = ["render", shown, "--show", "deviation", "--against", name!, ...options, ...darkest, ...last];
      return { line, files: { ...bench.files, [shown]: plyOf(parts.map((part) => lying(part, up))) } };
    }
  }
}

/** The eye of a view, as the command takes it, in a file's own coordinates. */
export function cameraText(view: View, { width, height }: Size, up: string | null): string {
  const numbers = (of: Vec3) => lain(of, up).map((value) => Number(value.toPrecision(7))).join(",");
  const eye = `eye=${numbers(eyeOf(view))} target=${numbers(view.target)} up=${numbers([0, 0, 1])}`;
  return `${width}x${height} fov=${fovOf({ width, height }).toFixed(3)} ${eye}`;
}
