// The shape of a reader's own, and the runs of the command that the stations of the lesson show of it. It computes nothing: each
// run is a line of the command, and what a station shows of it is in its report.
import type { Files } from "../../core/command";
import { commandJobs } from "../../core/command_module";
import { Stopped } from "../../core/jobs";
import { keepShape, keptShape } from "../../core/kept_shape";
import type { View } from "../../viewer";
import { type Bench, type Line, bench, reading } from "../../workbench/document";
import { type Part, boxOf, levels as levelsOf, partToZUp, parts as partsOf, upOf, withPictures } from "../../workbench/glb";
import { type Fault, KEEP_BEST, faultOf, madeBy, reportOf } from "../../workbench/outcome";
import type { Certificate, Report } from "../../workbench/report";
import { pack } from "../../workbench/share";
import { isMarked, mark } from "./mark";

/** What may be lost, as shares of the diagonal of the shape's box: the budgets among which readers choose. */
export const BUDGETS = ["2%", "1%", "0.5%", "0.2%", "0.1%"] as const;
export type BudgetShare = (typeof BUDGETS)[number];
export const SHADINGS = ["flat", "smooth", "crease=30deg"] as const;
export type Shading = (typeof SHADINGS)[number];
/** Cells along the longest side of the shape. */
export const CELLS = [12, 20, 32] as const;

/** Why there is no result: an error of the command, or one of the page. */
export type Why = { fault: Fault } | { notice: "trapped" | "unloaded" | "too-large" | "unread" | "no-triangles" };

/** The result of a run. */
export interface Made {
  report: Report;
  certificate: Certificate;
  files: Files;
  /** The budget was not met: this is the best that was reached. */
  isShort: boolean;
  /** The triangles with z up; of levels, those of each level, the finest first. */
  levels: readonly (readonly Part[])[];
}

/** A run of the command. */
export interface Run {
  line: Line;
  files: Files;
  stage: string | null;
  percent: number;
  made: Made | null;
  why: Why | null;
  ended: Promise<void>;
}

/** The names of files that the runs write. They are unlike those of readers. */
const OUTPUT = { mesh: "lesson-mesh.glb", plain: "lesson-mesh.ply", field: "lesson-field.nrrd", back: "lesson-back.glb", levels: "lesson-levels.glb" } as const;

/** From the eye to the middle of the shape, in diagonals of its box. */
const AWAY = 2.1;
const HOME: View = { azimuth: -56, elevation: 22, distance: AWAY, target: [0, 0, 0] };
/** The distances at which levels are asked for, in diagonals: from where it fills a screen to where it is a dot. */
const DISTANCES = Array.from({ length: 31 }, (_, i) => 10 ** (i / 12));

export class OwnShape {
  /** The shape that travels along; `null` for the teapot alone. */
  shape: Bench | null = null;
  /** Whether a reload has it again; `null` while it is being kept. */
  isKept: boolean | null = null;
  /** What is tried in its place, and why the last one was not taken. */
  taking: { name: string; run: Run | null } | null = null;
  why: Why | null = null;
  budget: BudgetShare = "0.5%";
  view = HOME;
  home = HOME;
  /** What is behind the file of the workbench to open the shape there; `null` if nothing can carry it. */
  address: string | null = null;

  private readonly jobs = commandJobs<string>();
  private readonly runs = new Map<string, { key: string; run: Run }>();
  private takes = 0;
  private framed: Bench | null = null;
  /** The diagonal of the shape's box, which says how far away is far. */
  diagonal = 1;

  constructor(private readonly notify: () => void) {}

  /** The shape that this browser keeps, if it does. */
  async again(): Promise<void> {
    if (!isMarked()) return;
    const number = ++this.takes;
    const kept = await keptShape();
    if (number !== this.takes) return;
    if (!kept) return mark(false);
    this.isKept = true;
    this.adopt(bench(kept.name, kept.files));
  }

  /** Takes a shape along if the command makes triangles of it; else what was there stays, and `why` says why not. */
  async take(of: Bench | (() => Promise<Bench | "too-large" | "unread">), name: string): Promise<boolean> {
    const number = ++this.takes;
    this.update({ taking: { name, run: null }, why: null });
    const next = typeof of === "function" ? await of() : of;
    if (number !== this.takes) return false;
    if (typeof next === "string") return this.refuse({ notice: next });
    const run = this.start("taken", this.meshLine(next), next.files, next);
    this.update({ taking: { name, run } });
    await run.ended;
    if (number !== this.takes) return false;
    if (!run.made) return this.refuse(run.why!);
    this.adopt(next);
    // What was tried is its first run.
    this.runs.set("mesh", { key: keyOf(run), run });
    this.frame(run.made);
    this.isKept = null;
    void keepShape({ name: next.name, files: next.files }).then((isKept) => {
      if (this.shape !== next) return;
      mark(isKept);
      this.update({ isKept });
      void this.findAddress();
    });
    return true;
  }

  private refuse(why: Why): boolean {
    this.update({ taking: null, why });
    return false;
  }

  /** Stops what is being taken. */
  stop(): void {
    this.takes += 1;
    this.jobs.cancel("taken");
    this.update({ taking: null, why: null });
  }

  /** Back to the teapot. */
  leave(): void {
    this.stop();
    this.adopt(null);
    mark(false);
    void keepShape(null);
  }

  choose(budget: BudgetShare): void {
    this.update({ budget });
    void this.findAddress();
  }

  look(view: View): void {
    this.update({ view });
  }

  private adopt(shape: Bench | null): void {
    for (const lane of this.runs.keys()) this.jobs.cancel(lane);
    this.runs.clear();
    this.update({ shape, taking: null, why: null });
    void this.findAddress();
  }

  /** A link has it all, with the budget; what is too large for one is taken from where this browser keeps it. */
  private async findAddress(): Promise<void> {
    const { shape, budget } = this;
    const link = shape && (await pack({ ...shape, budget: { ...shape.budget, by: "tol", tol: budget } }));
    if (shape !== this.shape || budget !== this.budget) return;
    this.update({ address: link ? `#s=${link}` : shape && this.isKept ? "?own" : null });
  }

  /** The triangles within the budget. */
  get mesh(): Run {
    const { shape } = this;
    return this.run("mesh", this.meshLine(shape!), shape!.files, shape!);
  }

  /** The same triangles in a file that stores positions and indices alone: normals of the shape would double vertices. */
  get plain(): Run {
    const { shape } = this;
    return this.run("plain", this.meshLine(shape!, OUTPUT.plain), shape!.files, shape!);
  }

  /** What the triangles of the file are; of a shape that has none, those of its mesh. `null` until it is known which. */
  get inspection(): Run | null {
    const { facts } = this;
    if (!facts.made || facts.made.certificate.valid) return facts;
    return this.ofPlain("inspect-mesh", (mesh) => ["inspect", mesh]);
  }

  /** What the shape is before anything is made of it. */
  get facts(): Run {
    const { shape } = this;
    return this.run("inspect", ["inspect", ...reading(shape!)], shape!.files, shape!);
  }

  /** The same triangles, with normals. */
  normals(shading: Shading): Run | null {
    return this.ofPlain(`normals ${shading}`, (mesh) => ["mesh", mesh, "--normals", shading, "-o", `lesson-${shading.replace(/=.*/, "")}.glb`]);
  }

  /** The shape as distances on a lattice. */
  field(cells: number): Run {
    const { shape } = this;
    return this.run("field", ["bake", ...reading(shape!), "--cells", String(cells), "--bound", "-o", OUTPUT.field], shape!.files, shape!);
  }

  /** That field as triangles again. */
  back(cells: number): Run | null {
    const { made, why } = this.field(cells);
    if (why || !made) return null;
    // Without a budget: what the cells give, as in the teapot's figure.
    const line = ["mesh", OUTPUT.field, "-o", OUTPUT.back];
    return this.run("back", line, { [OUTPUT.field]: made.files[OUTPUT.field]! }, this.shape!, `${cells}`);
  }

  /** Its levels of detail. */
  get levels(): Run | null {
    const { shape, mesh } = this;
    if (!mesh.made) return null;
    const distances = DISTANCES.map((share) => Number((share * this.diagonal).toPrecision(2)));
    const line = ["lod", ...reading(shape!), "--px", "1", "--distances", distances.join(","), KEEP_BEST, "-o", OUTPUT.levels];
    return this.run("levels", line, shape!.files, shape!);
  }

  private meshLine(of: Bench, output: string = OUTPUT.mesh): Line {
    return ["mesh", ...reading(of), "--tol", this.budget, KEEP_BEST, "-o", output];
  }

  /** A run on those triangles, once there are some. */
  private ofPlain(lane: string, line: (mesh: string) => Line): Run | null {
    const { plain, budget, shape } = this;
    const bytes = plain.made?.files[OUTPUT.plain];
    return bytes ? this.run(lane, line(OUTPUT.plain), { [OUTPUT.plain]: bytes }, shape!, budget) : null;
  }

  /** The run of a line: the one that was started last in this lane if it is the same. `of` tells inputs of one name apart. */
  private run(lane: string, line: Line, files: Files, shape: Bench, of = ""): Run {
    const last = this.runs.get(lane);
    const key = `${line.join(" ")} ${of}`;
    if (last?.key === key) return last.run;
    const run = this.start(lane, line, files, shape);
    this.runs.set(lane, { key, run });
    if (lane === "mesh") void run.ended.then(() => run.made && this.runs.get(lane)?.run === run && this.frame(run.made));
    return run;
  }

  private start(lane: string, line: Line, files: Files, shape: Bench): Run {
    const run: Run = { line, files, stage: null, percent: 0, made: null, why: null, ended: Promise.resolve() };
    run.ended = this.jobs
      .run(lane, [...line, "--json"], files, ({ stage, percent }) => {
        Object.assign(run, { stage, percent });
        this.notify();
      })
      .then(async (outcome) => {
        const report = reportOf(outcome);
        const made = line[0] === "inspect" ? (outcome.exit === 0 ? {} : null) : madeBy(outcome, line);
        if (!made || !report.certificate) run.why = { fault: faultOf(outcome) };
        else run.made = { ...(await read(line, made, report, report.certificate, shape)), isShort: outcome.exit !== 0 };
        if (run.made && line.includes(OUTPUT.mesh) && !run.made.levels[0]?.length) Object.assign(run, { made: null, why: { notice: "no-triangles" } });
      })
      .catch((error: unknown) => {
        if (!(error instanceof Stopped)) throw error;
        // What a newer run or a reader has ended is shown nowhere.
        if (error.why === "trapped" || error.why === "unloaded") run.why = { notice: error.why };
      })
      .then(() => this.notify());
    return run;
  }

  /** Sets the view for a new shape, by the first mesh of it. */
  private frame(made: Made): void {
    const box = boxOf(made.levels[0]!);
    if (!box || this.framed === this.shape) return;
    this.framed = this.shape;
    const [low, high] = box;
    this.diagonal = Math.hypot(...low.map((x, k) => high[k]! - x)) || 1;
    const target = [0, 1, 2].map((k) => (low[k]! + high[k]!) / 2) as unknown as View["target"];
    const home = { ...HOME, target, distance: AWAY * this.diagonal };
    this.update({ home, view: home });
  }

  private update(change: Partial<Pick<OwnShape, "shape" | "isKept" | "taking" | "why" | "budget" | "view" | "home" | "address">>): void {
    Object.assign(this, change);
    this.notify();
  }
}

const keyOf = ({ line }: Run): string => `${line.join(" ")} `;

/** Reads the triangles of an output that is a GLB, with z up. */
async function read(line: Line, files: Files, report: Report, certificate: Certificate, shape: Bench): Promise<Omit<Made, "isShort">> {
  const bytes = Object.entries(files).find(([name]) => name.endsWith(".glb"))?.[1];
  const { frame } = certificate;
  const up = upOf(shape.name, frame);
  const all = !bytes ? [] : line[0] === "lod" ? levelsOf(bytes, frame) : [partsOf(bytes, frame)];
  const levels = await Promise.all(all.map(async (parts) => (await withPictures(parts)).map((part) => partToZUp(part, up))));
  return { report, certificate, files, levels };
}
