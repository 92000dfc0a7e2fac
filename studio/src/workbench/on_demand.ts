// What is run only when somebody asks for it: levels of detail, a slice, the line of each face, the words of the language.
import { type Bench, isScript, meshLine, outputOf, reading, stem, textOf, viewText, withText } from "./document";
import type { FunctionRow } from "./editor";
import { levels as levelsOf, parts as partsOf, partToZUp, readOrUndefined, upOf, withPictures } from "./glb";
import { faultOf, madeBy, reportOf, sliceOf } from "./outcome";
import { type Runs, keepingBest } from "./runs";
import type { Sight } from "./sight";
import type { Store } from "./store";
import type { Trace } from "./trace/faces";
import { shadowOf } from "./trace/shadow";

/** A part of docs/schema/language.schema.json. */
interface LanguageTable {
  functions: readonly (Omit<FunctionRow, "worth"> & { worth: string | null })[];
  constants?: readonly (string | { name: string })[];
  keywords?: readonly string[];
}

/** Cells along the longest side of a slice; each is shown as one or two pixels. */
const SLICE_CELLS = "96";

export class OnDemand {
  constructor(
    private readonly store: Store,
    private readonly runs: Runs,
    private readonly sight: Sight,
  ) {}

  private get state() {
    return this.store.state;
  }

  async levels(): Promise<void> {
    const { bench: current } = this.state;
    const name = outputOf(current, `${stem(current.name)}-levels.glb`);
    const screen = viewText(this.sight.screenOfLevels);
    const run = await this.runs.runSupported("levels", ["lod", ...reading(current), "--px", "1", "--view", screen, "-o", name], current.files, true);
    if (!run || current !== this.state.bench) return;
    const { outcome, line } = run;
    const bytes = madeBy(outcome, line)?.[name];
    const report = reportOf(outcome);
    if (!bytes || !report.certificate?.levels) return this.store.update({ fault: faultOf(outcome) });
    const { frame } = report.certificate;
    const up = upOf(current.name, frame);
    const parts = await readOrUndefined(() =>
      Promise.all(levelsOf(bytes, frame).map(async (level) => (await withPictures(level)).map((part) => partToZUp(part, up)))),
    );
    if (current !== this.state.bench) return;
    if (!parts) return this.store.update({ notice: "undrawn" });
    this.store.update({ levels: { parts, facts: report.certificate.levels.levels, bytes, line } });
  }

  /** Samples the field for slices. */
  async bake(): Promise<void> {
    const { bench: current } = this.state;
    const run = await this.runs.runSupported("slice", ["bake", ...reading(current), "--cells", SLICE_CELLS, "-o", "slice.npy"], current.files, true);
    if (!run || current !== this.state.bench) return;
    const { outcome } = run;
    const bytes = madeBy(outcome, run.line)?.["slice.npy"];
    if (!bytes) return this.store.update({ fault: faultOf(outcome) });
    this.store.update({ slice: sliceOf(bytes, reportOf(outcome)) });
  }

  /** Finds which call of the script made which face, once for each input. A script that has no such mesh has no answer. */
  trace(): Promise<Trace | null> {
    const { bench: current } = this.state;
    if (!isScript(current)) return Promise.resolve(null);
    if (this.tracing?.bench !== current) this.tracing = { bench: current, found: this.runTrace(current) };
    return this.tracing.found;
  }
  private tracing: { bench: Bench; found: Promise<Trace | null> } | null = null;

  private async runTrace(current: Bench): Promise<Trace | null> {
    const { text, sites } = shadowOf(textOf(current));
    // Within the same budget, so that its faces lie on those that are shown.
    const words = keepingBest([...meshLine({ ...current, combine: null }, this.sight.screen, "trace.glb"), "--require", "estimated"]);
    const outcome = await this.runs.run("trace", words, withText(current, text).files, true);
    const [bytes, certificate] = outcome ? [madeBy(outcome, words)?.["trace.glb"], reportOf(outcome).certificate] : [];
    if (!bytes || !certificate || current !== this.state.bench) return null;
    const parts = await readOrUndefined(async () => partsOf(bytes, certificate.frame));
    const trace = { bench: current, sites, parts: (parts ?? []).map((part) => partToZUp(part, upOf(current.name, certificate.frame))) };
    this.store.update({ trace });
    return trace;
  }

  /** The functions and words of the script language, for the editor. */
  async language(): Promise<{ functions: readonly FunctionRow[]; words: readonly string[] } | null> {
    const outcome = await this.runs.run("language", ["language"], {}, true);
    if (!outcome || outcome.exit !== 0) return null;
    const { functions, constants, keywords } = JSON.parse(outcome.stdout) as LanguageTable;
    const rows = functions.map(({ worth, ...row }) => (worth === null ? row : { ...row, worth }));
    return { functions: rows, words: [...(constants ?? []), ...(keywords ?? [])].map((word) => (typeof word === "string" ? word : word.name)) };
  }
}
