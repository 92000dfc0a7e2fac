// The state of the workbench page.
import type { Progress } from "../core/command";
import type { Size, Vec3, View } from "../viewer";
import type { Bench, Line } from "./document";
import type { Carried } from "./carried";
import type { Exported } from "./exports";
import type { Part } from "./glb";
import type { Fault, Slice } from "./outcome";
import type { Trace } from "./trace/faces";
import type { Beside, PictureOf } from "./pictures";
import type { Certificate, Inspection, LevelFacts } from "./report";

/** The progress of a run, when its stage began, and the seconds that it probably still takes, if that can be told. */
export interface Running extends Progress {
  since: { at: number; percent: number };
  left: number | null;
}

export type LaneName =
  | "draft" | "proof" | "inspect" | "picture" | "field" | "slice" | "levels" | "step" | "export" | "verify" | "language" | "trace" | "faults";

/**
 * What works on several threads. The other lanes take a tenth of a second, are soon ended by a newer run, or start just before
 * the proof, which would find no free thread.
 */
export const THREADED: readonly LaneName[] = ["proof", "levels", "step", "export", "verify"];

/** The mesh that is shown. */
export interface Shown {
  /** The input from which it was made. */
  bench: Bench;
  parts: readonly Part[];
  certificate: Certificate;
  bytes: Uint8Array;
  seconds: number;
  /** Its error is unknown; the proved mesh soon replaces it. */
  isDraft: boolean;
  /** The budget was not met: this is the best mesh that was reached. */
  isShort: boolean;
  /** Options of the bench that meshing does not know. */
  leftOut: Line;
}

export interface Levels {
  parts: readonly (readonly Part[])[];
  facts: readonly LevelFacts[];
  bytes: Uint8Array;
  line: Line;
}

export interface State {
  bench: Bench;
  past: readonly Bench[];
  future: readonly Bench[];
  shown: Shown | null;
  fault: Fault | null;
  /** Further mistakes of the same script. */
  moreFaults: readonly Fault[];
  inspection: Inspection | null;
  /** The places of defects, by the name of the finding. */
  witnesses: readonly { of: string; at: Vec3 }[];
  progress: Partial<Record<LaneName, Running>>;
  running: readonly LaneName[];
  /** The chosen picture beside the mesh, and its pixels. */
  beside: Beside;
  picture: PictureOf | null;
  /** The script's field in GLSL, if it has one; it may be of an older script while the newest is evaluated. */
  field: { bench: Bench; source: string } | null;
  slice: Slice | null;
  levels: Levels | null;
  /** The faces by the calls of the script that made them, if that was asked. */
  trace: Trace | null;
  view: View;
  home: View;
  size: Size;
  notice: Notice | null;
  /** The latest export; `null` before the first, and after one that was stopped. */
  exported: Exported | null;
  /** The file that was opened as the script it carries. */
  carried: Carried | null;
  /** The link of this bench; `null` if it is too large for one. */
  link: string | null;
  /** Whether a run is scheduled after a pause. */
  isWaiting: boolean;
  /** The bench whose proof has ended, successfully or not; `null` while one runs. */
  ended: Bench | null;
}

export type Notice = "damaged" | "too-large" | "stopped" | "trapped" | "unloaded" | "unread" | "undrawn";
