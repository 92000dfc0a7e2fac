// What a run of the command said, read: its report, what went wrong and where, samples.
import type { Vec3 } from "../viewer";
import type { Outcome } from "./command";
import type { Report } from "./report";

export interface Fault {
  text: string;
  /** Where in the script, from 1. */
  line?: number;
  column?: number;
}

/** A slice through a baked field. */
export interface Slice {
  size: readonly [number, number, number];
  origin: Vec3;
  spacing: number;
  samples: Float64Array;
}

export function reportOf({ stdout }: Outcome): Report {
  try {
    return JSON.parse(stdout) as Report;
  } catch {
    return {};
  }
}

const PLACE = /^[^:]*: line (\d+)(?:, column (\d+))?: ([^]*)$/;

/** What went wrong, as the command says it; the first sentence, with its place in the script. */
export function faultOf(outcome: Outcome): Fault {
  const { error } = reportOf(outcome);
  const said = error?.messages[0] ?? outcome.stderr.split("\nchordal: ")[0]!.replace(/^chordal: /, "").trim();
  const found = PLACE.exec(said);
  if (!found) return { text: said };
  const [, line, column, text] = found;
  return { text: text!.split("\n")[0]!, line: Number(line), ...(column ? { column: Number(column) } : {}) };
}

/** numpy's format, of doubles, the first index running fastest. */
export function sliceOf(bytes: Uint8Array, report: Report): Slice | null {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const start = 10 + view.getUint16(8, true);
  const header = new TextDecoder().decode(bytes.subarray(10, start));
  const baked = report.certificate?.baked;
  if (!baked || !header.includes("<f8") || !header.includes("'fortran_order': True")) return null;
  const samples = new Float64Array(bytes.slice(start).buffer);
  return { size: baked.size, origin: baked.origin, spacing: baked.spacing, samples };
}
