// Judges what the bench measures by the limits that the docs state, and prints it as tables that the docs can take. A value beyond
// its limit is wrong, unless it is a known miss; then it must not be worse than it was.
import { cpus, loadavg } from "node:os";
import { LARGER, hasOwnModules } from "../page/bytes";

interface Limit {
  limit: number;
  unit: string;
  /** Whether more is better. */
  isLeast?: true;
  /** How much worse than its known value a miss may be. Chosen: times differ by a sixth between two runs on a quiet machine. */
  margin: number;
  /** Whether the modules of the tests are too slow, or too large, to be judged. */
  isOfModules?: true;
}

const LIMITS = {
  /** From the move of a dragged number to the draft of its mesh, and from its release to the proof. */
  draft: { limit: 150, unit: "ms", margin: 1.25, isOfModules: true },
  proof: { limit: 1000, unit: "ms", margin: 1.25, isOfModules: true },
  /** Of a traced field while it turns. */
  frames: { limit: 60, unit: "/s", isLeast: true, margin: 1.25 },
  /** From the address to the first picture, on a processor slowed down four times. */
  picture: { limit: 1000, unit: "ms", margin: 1.25 },
  /** The longest task of the main thread, at full speed. */
  task: { limit: 50, unit: "ms", margin: 1.25 },
  /** The main thread for each move of a drag, in the middle: half of a frame, since the browser needs the other half for painting. */
  move: { limit: 8, unit: "ms", margin: 1.25 },
  /** Compressed, before the first picture and until the figure is live. */
  first: { limit: 150, unit: "kB", margin: 1 },
  live: { limit: 400, unit: "kB", margin: 1, isOfModules: true },
} satisfies Record<string, Limit>;
export type What = keyof typeof LIMITS;

interface Miss {
  value: number;
  why: string;
}
export type Misses = Partial<Record<What, Readonly<Record<string, Miss>>>>;

const TEXT = "every move writes the script anew, and asks for its draft";
const FIELD = "a proof may evaluate the field as often as its mesh did";
const CARD = "without a card the page waits for the processor to draw its first frame in space";
const FRAME = "without a card the processor draws its frames, too";
const valued = (why: string, values: Record<string, number>): Record<string, Miss> =>
  Object.fromEntries(Object.entries(values).map(([of, value]) => [of, { value, why }]));
/** What misses its limit today, as it was measured last on a quiet machine without a graphics card, and why. */
export const KNOWN: Misses = {
  draft: valued("its mesh takes as long: 150 ms of one thread, for walls that a coarser draft would lose", { vase: 286 }),
  proof: {
    ...valued(FIELD, { bracket: 1180, gear: 2170 }),
    ...valued("a twisted outline has no expression: the proof measures the whole mesh", { vase: 8380 }),
  },
  move: {
    ...valued(TEXT, { gear: 11, vase: 12, badge: 13 }),
    ...valued(FRAME, { quad: 8.6, tangent: 8.1, cross: 9.3, csg: 8.4, adaptive: 12, mountain: 9.5 }),
  },
  task: valued(CARD, {
    adaptive: 75,
    baking: 67,
    booleans: 61,
    cage: 52,
    cracks: 74,
    cross: 81,
    cubes: 93,
    culling: 63,
    doctor: 74,
    indexed: 59,
    lesson: 130,
    levels: 113,
    mountain: 182,
    network: 73,
    normals: 52,
    patch: 57,
    pull: 51,
    quad: 91,
    ride: 56,
    squares: 73,
    workbench: 192,
  }),
  live: {
    ...Object.fromEntries(Object.entries(LARGER).map(([id, bytes]) => [id, { value: bytes / 1000, why: "it meshes or simplifies in several ways, and measures that" }])),
    workbench: { value: 5_200, why: "it is the whole command" },
  },
};

export interface Verdict {
  isMiss: boolean;
  /** What is wrong. */
  wrong?: string;
  /** What is better than listed, or listed. */
  note?: string;
}

/** Judges a value. */
export function judged(what: What, of: string, value: number, known: Misses = KNOWN): Verdict {
  const { limit, unit, isLeast, margin }: Limit = LIMITS[what];
  const miss = known[what]?.[of];
  const said = (value: number) => `${rounded(value)} ${unit}`;
  const head = `${of}, ${what}: ${said(value)}`;
  // A time before its begin was taken of something else.
  if (!(Number.isFinite(value) && value >= 0)) return { isMiss: true, wrong: `${of}, ${what}: not measured` };
  /** How many times worse than another value. */
  const worse = (than: number) => (isLeast ? than / value : value / than);
  if (worse(limit) <= 1) return miss ? { isMiss: false, note: `${head} holds the limit of ${said(limit)} now: take it off the list of misses` } : { isMiss: false };
  if (!miss) return { isMiss: true, wrong: `${head}, beyond the limit of ${said(limit)}` };
  if (worse(miss.value) > margin) return { isMiss: true, wrong: `${head}, worse than the known miss of ${said(miss.value)}` };
  const isBetter = worse(miss.value) < 1 / Math.max(margin, 1.05);
  return { isMiss: true, note: isBetter ? `${head} is better than the known miss of ${said(miss.value)}: lower it in the list` : `${head} for ${said(limit)}, a known miss: ${miss.why}` };
}

const rounded = (value: number): string => (value >= 10 ? value.toFixed(0) : value.toFixed(1));

/** How long a table may take until nothing is measured again, so that the four of them take less than ten minutes. */
const REPEATED_MS = 120_000;

/** A cell of a table: a text, or what is judged. */
export type Cell = string | { what: What; value: number };

/** A table of one bench, in the form of the docs; a value beyond its limit is bold. */
export class Table {
  private readonly rows: string[][] = [];
  private readonly notes: string[] = [];
  private readonly from = loadavg()[0]!;
  private readonly begun = Date.now();
  constructor(
    private readonly title: string,
    private readonly columns: readonly string[],
    /** Whether values are judged. */
    private readonly judges: { isJudged: boolean; why?: string } = { isJudged: true },
  ) {}

  /** Adds a row, and returns what is wrong with it. */
  add(of: string, ...cells: Cell[]): string[] {
    const wrong: string[] = [];
    const row = cells.map((cell) => {
      if (typeof cell === "string") return cell;
      const { unit, isOfModules }: Limit = LIMITS[cell.what];
      const text = unit === "ms" && cell.value >= 1000 ? `${(cell.value / 1000).toFixed(1)} s` : `${rounded(cell.value)} ${unit}`.replace(" /s", "/s");
      if (!this.judges.isJudged || (isOfModules && !hasOwnModules)) return text;
      const verdict = judged(cell.what, of, cell.value);
      if (verdict.wrong) wrong.push(verdict.wrong);
      if (verdict.note) this.notes.push(verdict.note);
      return verdict.isMiss ? `**${text}**` : text;
    });
    this.rows.push([`\`${of}\``, ...row]);
    return wrong;
  }

  /** Whether some values are to be measured again: one of them is wrong, and there is time. */
  isDoubtful(of: string, values: Partial<Record<What, number>>): boolean {
    const isWrong = Object.entries(values).some(([what, value]) => judged(what as What, of, value).wrong !== undefined);
    return isWrong && Date.now() - this.begun < REPEATED_MS;
  }

  print(): void {
    const load = [this.from, loadavg()[0]!].map((load) => load.toFixed(1)).join(" to ");
    const line = (cells: readonly string[]) => `| ${cells.join(" | ")} |`;
    const minutes = ((Date.now() - this.begun) / 60_000).toFixed(1);
    const said = [
      "",
      `${this.title} (${cpus().length} processors, load ${load}, ${minutes} minutes; bold misses its limit)`,
      "",
      line(this.columns),
      `|---${"|---:".repeat(this.columns.length - 1)}|`,
      ...this.rows.map(line),
      "",
      ...this.notes.map((note) => `- ${note}`),
    ];
    if (this.from > 0.5) said.push(`OTHER WORK WAS RUNNING WHEN THIS BEGAN (load ${this.from.toFixed(1)}): these times are not to be kept.`);
    if (!hasOwnModules) said.push("THE MODULES ARE THOSE OF THE TESTS, larger and half as fast: drafts, proofs and kilobytes until live were NOT judged.");
    if (!this.judges.isJudged) said.push(`NOT JUDGED: ${this.judges.why ?? ""}`);
    console.log(said.join("\n"));
  }
}

/** The middle of some numbers. */
export const median = (all: readonly number[]): number => [...all].sort((a, b) => a - b)[Math.floor(all.length / 2)] ?? Number.NaN;
