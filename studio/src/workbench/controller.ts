// What may be done on the workbench: it replaces the input, and decides which runs of the command that starts and whether their
// results are still wanted. The state is in store.ts, a run in runs.ts, the view in sight.ts, what is run only when asked for in
// on_demand.ts.
import type { Files } from "../core/command";
import type { Jobs } from "../core/jobs";
import type { Size, View } from "../viewer";
import { framed } from "../viewer/view";
import { type Bench, type Line, bench, isMesh, isScript, meshLine, outputOf, reading, stem, textOf, withText, without } from "./document";
import { carriedBy, verifyCarried } from "./carried";
import { partToZUp, parts as partsOf, readOrUndefined, upOf, withPictures } from "./glb";
import { MOST_FAULTS, inScript, isFurther, isMendable, withCause, withoutFault } from "./faults";
import type { Cupboard } from "./cupboard";
import { FieldSource } from "./field_source";
import { OnDemand } from "./on_demand";
import { opened } from "./opened";
import { type Fault, faultOf, madeBy, reportOf } from "./outcome";
import { type Beside, besideOf, cameraText, pictureLine } from "./pictures";
import { Runs, keepingBest } from "./runs";
import { pack } from "./share";
import { type Lack, lackOf, suits, supplied } from "./lack";
import type { Shelf } from "./shelf";
import { Sight } from "./sight";
import type { LaneName, Notice, Shown, State } from "./state";
import { Store } from "./store";

/** The pause after the last change before the proof starts, and after a turn before a picture is rendered. */
const REST_MS = 250;
/** The tolerance of a draft, and so its cells, relative to the diagonal. Chosen: a smaller one takes visibly long. */
const DRAFT = "1.5%";
const MOST_STEPS = 100;
/** Typing without a longer pause than this is one step of undo. */
const PAUSE_MS = 1000;
/** A mesh file of more bytes is shown as it is before its own mesh is made. Chosen: a smaller one takes less than a second. */
const SHOWN_FIRST = 1e6;
/** Pixels of a ray-traced picture: as many as take about a second. */
const MOST_DOTS = 120_000;

export class Controller {
  private timers = new Map<string, ReturnType<typeof setTimeout>>();
  readonly store: Store;
  readonly runs: Runs;
  readonly sight: Sight;
  readonly onDemand: OnDemand;
  private readonly fieldSource: FieldSource;
  /** The scripts that this browser keeps; `null` while pages are written. */
  shelf: Shelf | null = null;
  /** The files that scripts were given in this browser; `null` while pages are written, and in tests. */
  cupboard: Cupboard | null = null;

  constructor(jobs: Jobs<LaneName>, first: Bench, notify: () => void) {
    this.store = new Store(first, notify);
    this.runs = new Runs(jobs, this.store);
    this.sight = new Sight(this.store);
    this.onDemand = new OnDemand(this.store, this.runs, this.sight);
    this.fieldSource = new FieldSource({
      state: () => this.state,
      update: (change) => this.update(change),
      run: (line, files) => this.runs.run("field", line, files, true),
    });
  }

  get state(): State {
    return this.store.state;
  }
  private update(change: Partial<State>): void {
    this.store.update(change);
  }
  /** Resolves as soon as the state is as a test asks. */
  until(test: (state: State) => boolean): Promise<void> {
    return this.store.until(test);
  }

  /** Starts the runs for the first input. */
  start(): void {
    this.restart(false);
  }

  /** The command line for the current mesh; with `--keep-best` if the budget was not met. */
  line(output = `${stem(this.state.bench.name)}.glb`): Line {
    const { bench: current, shown } = this.state;
    const isShort = shown?.isShort && this.provedOf === current;
    const known = (shown?.bench === current ? shown.leftOut : []).reduce(without, meshLine(current, this.sight.screen, outputOf(current, output)));
    return isShort ? keepingBest(known) : known;
  }

  /** The command line for the picture from the current view. */
  pictureLine(): Line {
    const { bench: current, view, size } = this.state;
    return ["render", ...reading(current), "--view", cameraText(view, size, this.sight.framed?.up ?? null), "-o", outputOf(current, `${stem(current.name)}.png`)];
  }

  /** Replaces the input, as a step of undo. */
  put(next: Bench, isDragging = false): void {
    const { bench: current, past } = this.state;
    // During a drag, or while typing without a pause, only the state before it is a step.
    if (!this.dragged && !this.isTyping) this.update({ past: [...past, current].slice(-MOST_STEPS), future: [] });
    this.dragged = isDragging;
    if (next.name !== current.name) this.clearResults();
    this.update({ bench: next });
    this.restart(isDragging);
  }
  private dragged = false;
  private isTyping = false;
  private lastTyped = -Infinity;

  /** The same shape under another name, as when it is put on the shelf: what is known of it stays, and nothing runs again. */
  adopt(named: Bench): void {
    const { bench: current, shown, ended } = this.state;
    const { [current.name]: _, ...beside } = current.files;
    const next = { ...named, files: { ...beside, ...named.files } };
    void this.cupboard?.keep(next, beside);
    const isSettled = ended === current && shown?.bench === current && !this.timers.has("proof");
    if (!isSettled) return this.put(next);
    if (this.provedOf === current) this.provedOf = next;
    if (this.drawnOf === current) this.drawnOf = next;
    this.sight.rename(next.name);
    this.update({ bench: next, ended: next, shown: { ...shown, bench: next } });
    this.schedule("link", () => void pack(next).then((link) => next === this.state.bench && this.update({ link })));
  }

  /** Clears the results of the previous file, so that they are not shown under the name of another. */
  private clearResults(): void {
    this.runs.cancel("draft");
    this.update({ shown: null, fault: null, inspection: null, witnesses: [], picture: null });
  }

  /** Ends a drag. */
  rest(): void {
    // The same input once more, now not as a part of a drag: this starts the proof, which drags
    // leave out.
    if (this.dragged) this.put(this.state.bench);
  }

  undo(): void {
    const { past, bench: current, future } = this.state;
    const before = past.at(-1);
    if (!before) return;
    // Whatever comes next is a step of its own, even if a drag goes on.
    this.dragged = false;
    if (before.name !== current.name) this.clearResults();
    this.update({ bench: before, past: past.slice(0, -1), future: [current, ...future] });
    this.restart(false);
  }

  redo(): void {
    const { past, bench: current, future } = this.state;
    const after = future[0];
    if (!after) return;
    this.dragged = false;
    if (after.name !== current.name) this.clearResults();
    this.update({ bench: after, past: [...past, current], future: future.slice(1) });
    this.restart(false);
  }

  /** Replaces the script's text. */
  write(text: string, isDragging = false): void {
    const now = performance.now();
    this.isTyping = !isDragging && now - this.lastTyped < PAUSE_MS;
    this.put(withText(this.state.bench, text), isDragging);
    this.isTyping = false;
    if (!isDragging) this.lastTyped = now;
  }

  /** Opens files: one is the shape, the others are referenced by it. Returns whether there is a shape. */
  async open(list: readonly File[]): Promise<boolean> {
    if (!list.length) return false;
    const { bench: before } = this.state;
    const lack = lackOf(this.state);
    const number = ++this.openCount;
    const file = await opened(list);
    if (typeof file === "string") {
      this.update({ notice: file });
      return false;
    }
    // Other files were opened while these were read; those are shown.
    if (number !== this.openCount) return true;
    if (lack && before === this.state.bench && suits(lack, Object.keys(file.files))) {
      this.supply(lack, file.files);
      return true;
    }
    // A file of the same name may be another shape, so nothing of the old one is kept.
    const script = await carriedBy(this, file);
    if (number !== this.openCount) return true;
    this.clearResults();
    this.sight.forget();
    this.update({ notice: null, exported: null, carried: null });
    this.put(script ?? file);
    if (script) void verifyCarried(this, file, script);
    return true;
  }
  private openCount = 0;

  /** Gives the script what it lacks. If it is carried by a file, that can be proved again now. */
  supply(lack: Lack, given: Files): void {
    const { bench: before, carried } = this.state;
    const next = supplied(before, lack, given);
    const { [next.name]: _, ...beside } = next.files;
    this.put(next);
    void this.cupboard?.keep(next, beside);
    if (carried?.verdict === null && carried.script.name === before.name) void verifyCarried(this, carried.file, next);
  }

  /** Looks for a file that the script lacks among those that this browser keeps. */
  private async seek(): Promise<void> {
    const { bench: current } = this.state;
    const lack = lackOf(this.state);
    const bytes = lack?.name ? await this.cupboard?.find(current, lack.name) : null;
    if (!lack || !bytes || current !== this.state.bench) return;
    // No step of undo, which would only lead back to here.
    this.update({ bench: supplied(current, lack, { [lack.name!]: bytes }), fault: null });
    this.restart(false);
  }

  /** Replaces the input by the result of a verb. */
  async step(verb: string, options: Line, output: string): Promise<void> {
    const { bench: current } = this.state;
    const name = outputOf(current, output);
    const run = await this.runs.runSupported("step", [verb, ...reading(current), ...options, "-o", name], current.files, false);
    // The input may have changed while the command ran.
    if (!run || current !== this.state.bench) return;
    const { outcome, line } = run;
    const made = madeBy(outcome, line);
    if (!made?.[name]) return this.update({ fault: faultOf(outcome) });
    this.put({ ...bench(name, made, [...current.before, line]), budget: current.budget });
  }

  /** Shows the mesh instead of the levels. */
  withoutLevels(): void {
    this.update({ levels: null });
  }

  look(view: View): void {
    this.update({ view });
    this.schedule("picture", () => void this.draw());
    // A pixel budget depends on this distance.
    if (this.state.bench.budget.by === "px") this.schedule("proof", () => void this.prove());
  }

  resize(size: Size): void {
    if (size.width === this.state.size.width && size.height === this.state.size.height) return;
    this.update({ size });
    this.schedule("picture", () => void this.draw());
    if (this.state.bench.budget.by === "px") this.schedule("proof", () => void this.prove());
  }

  cancel(lane: LaneName): void {
    this.runs.cancel(lane);
    this.update({ notice: "stopped" });
  }

  say(notice: Notice): void {
    this.update({ notice });
  }

  dismiss(): void {
    this.update({ notice: null });
  }

  private restart(isDragging: boolean): void {
    const { bench: current } = this.state;
    this.update({ levels: null, slice: null, trace: null, moreFaults: [], notice: null, exported: null });
    for (const lane of ["levels", "slice", "step", "trace", "faults"] as const) this.runs.cancel(lane);
    if (isScript(current)) void this.draft();
    else {
      this.runs.cancel("draft");
      if (isMesh(current) && (current.files[current.name]?.length ?? 0) > SHOWN_FIRST) void this.showFirst(current);
    }
    if (this.isBesideShown) void this.fieldSource.follow();
    // During a drag there are only drafts: a proof would be of an older number before it ends.
    if (isDragging) {
      this.runs.cancel("proof");
      this.runs.cancel("picture");
      clearTimeout(this.timers.get("proof"));
      this.timers.delete("proof");
    } else {
      this.schedule("proof", () => void this.prove());
      void this.inspect();
      this.schedule("picture", () => void this.draw());
      this.schedule("link", () => void pack(current).then((link) => current === this.state.bench && this.update({ link })));
    }
  }

  /** Shows a large file as it is, which takes a moment; its mesh within the budget may take minutes. */
  private async showFirst(current: Bench): Promise<void> {
    // The options are those of the mesh, which this verb may not know; and a changed budget changes nothing here.
    if (this.state.shown?.bench.name === current.name) return;
    await this.showMesh("draft", ["convert", current.name, "as-it-is.glb"], "as-it-is.glb", current);
  }

  /** Drafts run one after the other and are never cancelled, so that some are shown during a drag. */
  private draft(): Promise<void> {
    this.isDraftDue = true;
    this.drafting ??= this.runDrafts();
    return this.drafting;
  }
  private drafting: Promise<void> | null = null;
  private isDraftDue = false;

  private async runDrafts(): Promise<void> {
    try {
      // Lets the caller set `drafting` first: it must not still be null when the loop ends synchronously.
      await null;
      while (this.isDraftDue && isScript(this.state.bench)) {
        // Before the run, so that a change during it makes another draft due.
        this.isDraftDue = false;
        const { bench: current } = this.state;
        const words = keepingBest(["mesh", ...reading(current), "--tol", DRAFT, "--require", "estimated", "-o", "draft.glb"]);
        await this.showMesh("draft", words, "draft.glb", current);
      }
    } finally {
      this.drafting = null;
    }
    // The proof of a faulty script may have ended before the draft of the last working one was ready.
    const { ended, bench: current } = this.state;
    if (ended === current) void this.proveOlder(current);
  }

  private async prove(): Promise<void> {
    const { bench: current } = this.state;
    const number = ++this.proofCount;
    this.update({ ended: null });
    // A pixel budget needs the box of the shape, which the draft shows first.
    if (current.budget.by === "px" && this.drafting) {
      await this.drafting;
      if (number !== this.proofCount || current !== this.state.bench) return;
    }
    this.sight.keepScreen();
    const isMade = await this.runProof(current);
    if (isMade === false && number === this.proofCount) await this.proveOlder(current);
    if (isMade === false && number === this.proofCount) await this.findFaults(current);
    if (number === this.proofCount) this.update({ ended: current });
  }
  private proofCount = 0;

  /** Looks for mistakes after the first one. */
  private async findFaults(current: Bench): Promise<void> {
    const script = isScript(current) ? textOf(current) : "";
    let [copy, fault]: [string | null, Fault | null] = [script, this.state.fault];
    const more: Fault[] = [];
    while (copy !== null && fault && isMendable(fault) && more.length < MOST_FAULTS) {
      copy = withoutFault(copy, fault);
      if (copy === null) break;
      const outcome = await this.runs.run("faults", ["inspect", ...reading(current)], withText(current, copy).files, true);
      if (!outcome || current !== this.state.bench) return;
      fault = outcome.exit === 0 ? null : inScript(faultOf(outcome), copy, script);
      if (!fault || !isMendable(fault) || !isFurther(fault, [this.state.fault!, ...more])) break;
      more.push(fault);
      this.update({ moreFaults: more.slice() });
    }
  }

  private runProof(input: Bench): Promise<boolean | null> {
    const output = outputOf(input, `${stem(input.name)}.glb`);
    return this.showMesh("proof", keepingBest(meshLine(input, this.sight.lastScreen, output)), output, input);
  }

  /** If the script is faulty, the last working shape may be shown only as a draft: its proof is run then. */
  private async proveOlder(current: Bench): Promise<void> {
    const { bench: newest, shown } = this.state;
    if (current === newest && shown?.isDraft && shown.bench !== current) await this.runProof(shown.bench);
  }

  /** Runs a line and shows its mesh. Returns whether there is one; `null` if it is not needed any more. */
  private async showMesh(lane: "draft" | "proof", words: Line, output: string, input: Bench): Promise<boolean | null> {
    const begun = performance.now();
    // Options are for all verbs: one that only tiles have must not keep the shape from being shown.
    const run = await this.runs.runSupported(lane, words, input.files, true);
    if (!run || !this.isWanted(lane, input)) return null;
    const { outcome, line } = run;
    const leftOut = words.filter((word) => /^--?[a-z]/i.test(word) && !line.includes(word));
    const { certificate } = reportOf(outcome);
    const bytes = madeBy(outcome, words)?.[output];
    const isNewest = input === this.state.bench;
    if (!bytes || !certificate) {
      const fault = faultOf(outcome);
      if (lane === "draft" || isNewest) this.update({ fault: isScript(input) ? withCause(fault, textOf(input)) : fault });
      if (isNewest) void this.seek();
      return false;
    }
    const up = upOf(input.name, certificate.frame);
    const read = await readOrUndefined(() => withPictures(partsOf(bytes, certificate.frame)));
    const parts = (read ?? []).map((part) => partToZUp(part, up));
    // Decoding the pictures takes time as well, in which the input may have changed.
    if (!this.isWanted(lane, input)) return null;
    if (lane === "proof") this.provedOf = input;
    const seconds = (performance.now() - begun) / 1000;
    const isShort = outcome.exit !== 0;
    const isMoved = this.sight.frame(input, parts, up, this.dragged);
    // The pixels were counted from the previous position.
    if (isMoved && input.budget.by === "px") this.schedule("proof", () => void this.prove());
    const shown: Shown = { bench: input, parts, certificate, bytes, seconds, isDraft: lane === "draft", isShort, leftOut };
    // If an older input is proved in place of a faulty one, the error of the newest input must stay visible.
    const isOld = lane === "proof" && !isNewest;
    const fault = isOld ? this.state.fault : isShort && lane === "proof" ? faultOf(outcome) : null;
    this.update({ shown, fault, ...(read ? {} : { notice: "undrawn" }) });
    // A traced picture is of the input's field, so it stays when the draft is replaced by the
    // proof.
    if (!isOld && this.drawnOf !== input && this.drawnOf !== shown) this.schedule("picture", () => void this.draw());
    return true;
  }

  /** A proof must be of the current or the shown input. A draft may be older during a drag, until the proof is shown. */
  private isWanted(lane: "draft" | "proof", input: Bench): boolean {
    const { bench: current } = this.state;
    if (lane === "proof") return input === current || input === this.state.shown?.bench;
    return input.name === current.name && this.provedOf !== current && this.provedOf !== input;
  }
  private provedOf: Bench | null = null;
  /** The subject of the last picture: an input's field, or triangles. */
  private drawnOf: Bench | Shown | null = null;

  private async inspect(): Promise<void> {
    const { bench: current } = this.state;
    const run = await this.runs.runSupported("inspect", ["inspect", ...reading(current)], current.files, true);
    if (!run || current !== this.state.bench) return;
    const { outcome } = run;
    const { inspection, certificate } = reportOf(outcome);
    this.update({ inspection: inspection ?? null, witnesses: certificate?.valid?.witnesses ?? [] });
    if (!inspection) this.update({ fault: isScript(current) ? withCause(faultOf(outcome), textOf(current)) : faultOf(outcome) });
  }

  /** The picture beside the mesh is rendered only while it is seen. */
  showBeside(isShown: boolean): void {
    if (this.isBesideShown === isShown) return;
    this.isBesideShown = isShown;
    if (!isShown) return;
    void this.fieldSource.follow();
    this.schedule("picture", () => void this.draw());
  }
  private isBesideShown = false;

  /** Chooses the picture beside the mesh. */
  besides(beside: Beside): void {
    this.update({ beside, picture: null });
    void this.draw();
  }

  /** Renders the picture beside the mesh, from the same view. */
  private async draw(): Promise<void> {
    const { bench: current, beside, view, size, shown } = this.state;
    const kind = besideOf(current, beside);
    // Only a traced picture is of the input itself. The others are of triangles, and those of a
    // draft are soon replaced by the proof's.
    if (!this.isBesideShown || kind === "sliced" || !shown || (kind !== "traced" && shown.isDraft)) return;
    // Overshading is counted per pixel of this screen, so its picture must not be smaller.
    const seen = kind === "overshade" ? size : framed(size);
    const ratio = kind === "overshade" ? globalThis.devicePixelRatio || 1 : Math.min(1, Math.sqrt(MOST_DOTS / (seen.width * seen.height)));
    const dots = { width: Math.round(seen.width * ratio), height: Math.round(seen.height * ratio) };
    const { parts, certificate } = shown;
    const subject = { bench: current, parts, up: this.sight.framed?.up ?? null, atMost: certificate.bound?.at_most ?? null };
    const { line, files } = pictureLine(kind, subject, view, dots);
    const run = await this.runs.runSupported("picture", line, files, true);
    if (!run || current !== this.state.bench || beside !== this.state.beside) return;
    const { outcome } = run;
    const png = madeBy(outcome, run.line)?.["picture.png"];
    this.drawnOf = kind === "traced" ? current : shown;
    if (!png) return this.update({ fault: faultOf(outcome) });
    this.update({ picture: { kind, png, report: reportOf(outcome), bench: current, view } });
  }

  private schedule(name: string, act: () => void): void {
    clearTimeout(this.timers.get(name));
    const timer = setTimeout(() => {
      this.timers.delete(name);
      this.update({ isWaiting: this.timers.size > 0 });
      act();
    }, REST_MS);
    this.timers.set(name, timer);
    this.update({ isWaiting: true });
  }

  /** Changes a part of the state that no run depends on. */
  change(change: Partial<Pick<State, "exported" | "carried">>): void {
    this.update(change);
  }

}
