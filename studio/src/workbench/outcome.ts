// Reads the outcome of a run: its report, its error with the place in the script, and samples of a field.
import type { Vec3 } from "../viewer";
import type { Files, Outcome } from "../core/command";
import type { Report } from "./report";

export interface Fault {
  text: string;
  /** The command's code for it, by which it is translated. */
  code?: string;
  /** The place in the script, counted from 1. */
  line?: number;
  column?: number;
  /** The line of a bracket that is still open at that place. */
  openedIn?: number;
}

/** The samples of a baked field, from which slices are drawn. */
export interface Slice {
  size: readonly [number, number, number];
  origin: Vec3;
  spacing: number;
  samples: Float64Array;
}

/** The exit code of a budget that was missed. */
const UNMET = 5;
/** The option by which a line asks for the best result of a missed budget. */
export const KEEP_BEST = "--keep-best";

/** The files that a run has made. `null` if it failed, whatever it has left behind: its exit code says so, its files do not. */
export function madeBy({ exit, outputs }: Outcome, line: readonly string[]): Files | null {
  const isBest = exit === UNMET && line.includes(KEEP_BEST);
  const contents = Object.values(outputs);
  return (exit === 0 || isBest) && contents.length > 0 && contents.every(({ length }) => length > 0) ? outputs : null;
}

export function reportOf({ stdout }: Outcome): Report {
  try {
    return JSON.parse(stdout) as Report;
  } catch {
    return {};
  }
}

const PLACE = /^[^:]*: line (\d+)(?:, column (\d+))?: ([^]*)$/;

/** The error in the command's words: the first message, with its place in the script. */
export function faultOf(outcome: Outcome): Fault {
  const { error } = reportOf(outcome);
  const message = error?.messages[0] ?? outcome.stderr.split("\nchordal: ")[0]!.replace(/^chordal: /, "").trim();
  const coded = error ? { code: error.code } : {};
  const match = PLACE.exec(message);
  if (!match) return { text: message, ...coded };
  const [, line, column, text] = match;
  return { text: text!.split("\n")[0]!, line: Number(line), ...(column ? { column: Number(column) } : {}), ...coded };
}

/** Reads a NumPy file of doubles in Fortran order. */
export function sliceOf(bytes: Uint8Array, report: Report): Slice | null {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  // Six bytes of magic, two of version, and two with the length of the header.
  const start = 10 + view.getUint16(8, true);
  const header = new TextDecoder().decode(bytes.subarray(10, start));
  const baked = report.certificate?.baked;
  if (!baked || !header.includes("<f8") || !header.includes("'fortran_order': True")) return null;
  // A copy, since an array of doubles begins at a multiple of eight bytes.
  const samples = new Float64Array(bytes.slice(start).buffer);
  return { size: baked.size, origin: baked.origin, spacing: baked.spacing, samples };
}
