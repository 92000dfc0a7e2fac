// What the bench shows and does at a moment.
import type { Size, Vec3, View } from "../viewer";
import type { Progress } from "./command";
import type { Bench, Line } from "./document";
import type { Part } from "./glb";
import type { Fault, Slice } from "./outcome";
import type { Beside, PictureOf } from "./pictures";
import type { Certificate, Inspection, LevelFacts } from "./report";

export type LaneName = "draft" | "proof" | "inspect" | "picture" | "slice" | "levels" | "step" | "export" | "language";

/** A mesh that is shown. */
export interface Shown {
  /** What was on the bench when it was made. */
  of: Bench;
  parts: readonly Part[];
  certificate: Certificate;
  bytes: Uint8Array;
  seconds: number;
  /** Its distance is not known; the proved one soon takes its place. */
  isDraft: boolean;
  /** The budget was not met: this is the best that was reached. */
  isShort: boolean;
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
  inspection: Inspection | null;
  /** Where defects are, by the name of the finding. */
  witnesses: readonly { of: string; at: Vec3 }[];
  progress: Partial<Record<LaneName, Progress>>;
  running: readonly LaneName[];
  /** What was chosen to stand beside the mesh, and the picture of it. */
  beside: Beside;
  picture: PictureOf | null;
  slice: Slice | null;
  levels: Levels | null;
  view: View;
  home: View;
  size: Size;
  notice: Notice | null;
  /** The link of this bench; `null` where it is too large for one. */
  link: string | null;
  /** Something begins once the hand has rested. */
  isWaiting: boolean;
  /** The bench whose proof has ended, in whatever way; `null` while one is under way. */
  ended: Bench | null;
}

export type Notice = "damaged" | "too-large" | "stopped" | "trapped" | "unloaded" | "unread" | "undrawn";
