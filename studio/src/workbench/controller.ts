// What the bench does: it keeps the state, orders runs of the command, and tells whoever draws. It computes nothing itself.
import type { Size, Vec3, View } from "../viewer";
import { fovOf } from "../viewer/view";
import type { Files, Outcome } from "./command";
import {
  type Bench,
  type Line,
  type Screen,
  bench,
  isScript,
  meshLine,
  reading,
  stem,
  viewText,
  withText,
  without,
} from "./document";
import type { FunctionRow } from "./editor";
import { type Part, boxOf, levels as levelsOf, parts as partsOf, standing, stood, withPictures } from "./glb";
import { type Jobs, Stopped } from "./jobs";
import { faultOf, reportOf, sliceOf } from "./outcome";
import { type Box, awayFrom, fillingDistance } from "./pixels";
import { type Beside, besideOf, cameraText, pictureLine } from "./pictures";
import { pack } from "./share";
import type { LaneName, Notice, Shown, State } from "./state";

/** A part of docs/schema/language.schema.json. */
interface LanguageTable {
  functions: readonly (Omit<FunctionRow, "worth"> & { worth: string | null })[];
  constants?: readonly (string | { name: string })[];
  keywords?: readonly string[];
}

const HOME: View = { azimuth: -56, elevation: 22, distance: 6, target: [0, 0, 0] };
/** How long the hand rests before the proof begins, and before a picture is taken from a new place. */
const REST_MS = 250;
/** The cells of a draft, as a share of the diagonal: seen at once, and coarse enough to be there at once. */
const DRAFT = "1.5%";
const MOST_STEPS = 100;
/** What is typed without a pause of this length is one step. */
const PAUSE_MS = 1000;
/**
 * Pixels are counted no nearer than at these shares of the distance at which the shape is as high as the picture. Chosen: the
 * budget follows a look from near only to twice its triangles, for it is met without having been asked for; levels are asked for.
 */
const NEAREST = { budget: 1 / 2, levels: 1 / 8 };
/** How the command ends when it does not know an option, and when a budget was not met. */
const USAGE = 2;
const UNMET = 5;
/** With it the best that was reached is written all the same. */
const KEEP_BEST = "--keep-best";
/** What a browser can hold several times over. */
const MOST_BYTES = 600e6;
/** From the middle of a box to the eye, in diagonals. */
const AWAY = 2.4;
/** A shape that many times as large or as small is another one. Chosen: the eye is still outside of it. */
const OTHER_SIZE = 3;
/** Dots of a picture that is traced: as many as take about a second. */
const MOST_DOTS = 120_000;
/** Cells along the longest side of a slice: a pixel or two each. */
const SLICE_CELLS = "96";

export class Controller {
  private timers = new Map<string, ReturnType<typeof setTimeout>>();
  private seen: { name: string; up: string | null } | null = null;
  state: State;

  constructor(
    private readonly jobs: Jobs<LaneName>,
    first: Bench,
    private readonly changed: () => void,
  ) {
    this.state = {
      bench: first,
      past: [],
      future: [],
      shown: null,
      fault: null,
      inspection: null,
      witnesses: [],
      progress: {},
      running: [],
      beside: "traced",
      picture: null,
      slice: null,
      levels: null,
      view: HOME,
      home: HOME,
      size: { width: 720, height: 480 },
      notice: null,
      link: null,
      isWaiting: false,
      ended: null,
    };
  }

  /** Begins with the first shape. */
  start(): void {
    this.work(false);
  }

  get screen(): Screen {
    const { bench: now, size, view } = this.state;
    const { counted } = this;
    // Those of the proof that is shown, which was made before its box was known.
    if (counted && counted.bench === now && counted.view === view && counted.size === size) return counted.screen;
    return this.screenBy(NEAREST.budget);
  }

  private counted: { bench: Bench; view: View; size: Size; screen: Screen } | null = null;

  private screenBy(nearest: number): Screen {
    const { size } = this.state;
    const ratio = globalThis.devicePixelRatio || 1;
    const [fovDeg, { box }] = [fovOf(size), this];
    const least = box ? nearest * fillingDistance(box, fovDeg) : 0;
    return { width: size.width * ratio, height: size.height * ratio, fovDeg, distance: Math.max(this.away, least) };
  }

  /** From the eye to the nearest point of the shape's box. */
  get away(): number {
    const { box } = this;
    return box ? awayFrom(box, this.state.view) : this.state.view.distance;
  }

  /** Whether the eye is nearer than the budget's pixels are counted. */
  get isNear(): boolean {
    return this.away < this.screen.distance;
  }

  private get box(): Box | undefined {
    const parts = this.state.shown?.parts ?? [];
    if (this.boxed?.parts !== parts) this.boxed = { parts, box: boxOf(parts) };
    return this.boxed.box;
  }
  private boxed: { parts: readonly Part[]; box: Box | undefined } | null = null;

  /** The line that makes the mesh that is asked for; of one that was not met, the best there is. */
  line(output = `${stem(this.state.bench.name)}.glb`): Line {
    const { bench: now, shown } = this.state;
    const isShort = shown?.isShort && this.provedOf === now;
    const line = meshLine(now, this.screen, this.outputOf(output));
    return isShort ? keepingBest(line) : line;
  }

  /** The line that takes the picture that is seen. */
  pictureLine(): Line {
    const { bench: now, view, size } = this.state;
    return ["render", ...reading(now), "--view", cameraText(view, size, this.seen?.up ?? null), "-o", this.outputOf(`${stem(now.name)}.png`)];
  }

  /** An output never has the input's name. */
  private outputOf(output: string): string {
    const { files } = this.state.bench;
    return output in files ? output.replace(/(\.[^.]*)$/, "-out$1") : output;
  }

  /** Puts something else on the bench; it can be taken back. */
  put(next: Bench, isDragging = false): void {
    const { bench: now, past } = this.state;
    // While something is dragged, or typed without a pause, the state before it is one step.
    if (!this.dragged && !this.isTyping) this.update({ past: [...past, now].slice(-MOST_STEPS), future: [] });
    this.dragged = isDragging;
    if (next.name !== now.name) this.forget();
    this.update({ bench: next });
    this.work(isDragging);
  }
  private dragged = false;
  private isTyping = false;
  private typed = -Infinity;

  /** What is known of one file is not shown beside the name of another. */
  private forget(): void {
    this.jobs.cancel("draft");
    this.update({ shown: null, fault: null, inspection: null, witnesses: [], picture: null });
  }

  /** The hand is off what it dragged. */
  rest(): void {
    if (this.dragged) this.put(this.state.bench);
  }

  undo(): void {
    const { past, bench: now, future } = this.state;
    const before = past.at(-1);
    if (!before) return;
    this.dragged = false;
    if (before.name !== now.name) this.forget();
    this.update({ bench: before, past: past.slice(0, -1), future: [now, ...future] });
    this.work(false);
  }

  redo(): void {
    const { past, bench: now, future } = this.state;
    const after = future[0];
    if (!after) return;
    this.dragged = false;
    if (after.name !== now.name) this.forget();
    this.update({ bench: after, past: [...past, now], future: future.slice(1) });
    this.work(false);
  }

  /** A new text of the script. */
  write(text: string, isDragging = false): void {
    const now = performance.now();
    this.isTyping = !isDragging && now - this.typed < PAUSE_MS;
    this.put(withText(this.state.bench, text), isDragging);
    this.isTyping = false;
    if (!isDragging) this.typed = now;
  }

  /** Files that were dropped or opened. One of them is the shape, and others are what it names. Whether there is one. */
  async open(list: readonly File[]): Promise<boolean> {
    const total = list.reduce((sum, file) => sum + file.size, 0);
    const main = list.find((file) => !/\.(bin|mtl|png|jpe?g|webp|raw|img)$/i.test(file.name)) ?? list[0];
    if (!main) return false;
    if (total > MOST_BYTES) {
      this.update({ notice: "too-large" });
      return false;
    }
    const number = ++this.opened;
    const files: Files = {};
    try {
      for (const file of list) files[nameOf(file)] = new Uint8Array(await file.arrayBuffer());
    } catch {
      // A folder has no bytes.
      this.update({ notice: "unread" });
      return false;
    }
    if (number !== this.opened) return true;
    // Another file of the same name is another shape.
    this.forget();
    this.seen = null;
    this.update({ notice: null });
    this.put(bench(nameOf(main), files));
    return true;
  }
  private opened = 0;

  /** Puts the result of a verb in the place of the shape. */
  async step(verb: string, options: Line, output: string): Promise<void> {
    const { bench: now } = this.state;
    const name = this.outputOf(output);
    const done = await this.reads("step", [verb, ...reading(now), ...options, "-o", name], now.files, false);
    if (!done || now !== this.state.bench) return;
    const { outcome, line } = done;
    const made = outcome.made[name];
    if (!made || outcome.exit !== 0) return this.update({ fault: faultOf(outcome) });
    this.put({ ...bench(name, outcome.made, [...now.before, line]), budget: now.budget });
  }

  async levels(): Promise<void> {
    const { bench: now } = this.state;
    const name = this.outputOf(`${stem(now.name)}-levels.glb`);
    const screen = viewText(this.screenBy(NEAREST.levels));
    const done = await this.reads("levels", ["lod", ...reading(now), "--px", "1", "--view", screen, "-o", name], now.files, true);
    if (!done || now !== this.state.bench) return;
    const { outcome, line } = done;
    const bytes = outcome.made[name];
    const report = reportOf(outcome);
    if (!bytes || !report.certificate?.levels) return this.update({ fault: faultOf(outcome) });
    const { frame } = report.certificate;
    const up = this.upOf(now, frame.up);
    const parts = await drawn(() =>
      Promise.all(levelsOf(bytes, frame).map(async (level) => (await withPictures(level)).map((part) => standing(part, up)))),
    );
    if (now !== this.state.bench) return;
    if (!parts) return this.update({ notice: "undrawn" });
    this.update({ levels: { parts, facts: report.certificate.levels.levels, bytes, line } });
  }

  /** Shows the mesh again. */
  withoutLevels(): void {
    this.update({ levels: null });
  }

  /** Samples the field for slices. */
  async bake(): Promise<void> {
    const { bench: now } = this.state;
    const done = await this.reads("slice", ["bake", ...reading(now), "--cells", SLICE_CELLS, "-o", "slice.npy"], now.files, true);
    if (!done || now !== this.state.bench) return;
    const { outcome } = done;
    const bytes = outcome.made["slice.npy"];
    if (!bytes) return this.update({ fault: faultOf(outcome) });
    this.update({ slice: sliceOf(bytes, reportOf(outcome)) });
  }

  /** What scripts are written with, for the editor. */
  async language(): Promise<{ functions: readonly FunctionRow[]; words: readonly string[] } | null> {
    const outcome = await this.run("language", ["language"], {}, true);
    if (!outcome || outcome.exit !== 0) return null;
    const { functions, constants, keywords } = JSON.parse(outcome.stdout) as LanguageTable;
    const rows = functions.map(({ worth, ...row }) => (worth === null ? row : { ...row, worth }));
    return { functions: rows, words: [...(constants ?? []), ...(keywords ?? [])].map((one) => (typeof one === "string" ? one : one.name)) };
  }

  /** Files for the disk: those that a line makes. */
  async export(line: Line): Promise<Files | null> {
    const done = await this.reads("export", line, this.state.bench.files, false);
    if (!done) return null;
    const { outcome } = done;
    // The command says by its exit whether it made what was asked for: what a failed run leaves behind is nobody's file.
    const isBest = outcome.exit === UNMET && done.line.includes(KEEP_BEST);
    const isUseful = (outcome.exit === 0 || isBest) && Object.keys(outcome.made).length > 0;
    if (!isUseful) this.update({ fault: faultOf(outcome) });
    return isUseful ? outcome.made : null;
  }

  look(view: View): void {
    this.update({ view });
    this.later("picture", () => void this.draw());
    // Pixels are counted at this distance.
    if (this.state.bench.budget.by === "px") this.later("proof", () => void this.prove());
  }

  resize(size: Size): void {
    if (size.width === this.state.size.width && size.height === this.state.size.height) return;
    this.update({ size });
    this.later("picture", () => void this.draw());
    if (this.state.bench.budget.by === "px") this.later("proof", () => void this.prove());
  }

  cancel(lane: LaneName): void {
    this.jobs.cancel(lane);
    this.update({ notice: "stopped" });
  }

  say(notice: Notice): void {
    this.update({ notice });
  }

  dismiss(): void {
    this.update({ notice: null });
  }

  private work(isDragging: boolean): void {
    const { bench: now } = this.state;
    this.update({ levels: null, slice: null, notice: null });
    for (const lane of ["levels", "slice", "step"] as const) this.jobs.cancel(lane);
    if (isScript(now)) void this.draft();
    else this.jobs.cancel("draft");
    if (isDragging) {
      this.jobs.cancel("proof");
      this.jobs.cancel("picture");
      clearTimeout(this.timers.get("proof"));
      this.timers.delete("proof");
    } else {
      this.later("proof", () => void this.prove());
      void this.inspect();
      this.later("picture", () => void this.draw());
      this.later("link", () => void pack(now).then((link) => now === this.state.bench && this.update({ link })));
    }
  }

  /** One draft is finished before the next is begun, so that there are some while the hand moves. */
  private draft(): Promise<void> {
    this.isNewer = true;
    this.drafting ??= this.drafts();
    return this.drafting;
  }
  private drafting: Promise<void> | null = null;
  private isNewer = false;

  private async drafts(): Promise<void> {
    try {
      // It is known that there are drafts before the first is begun.
      await null;
      while (this.isNewer && isScript(this.state.bench)) {
        this.isNewer = false;
        const { bench: now } = this.state;
        const words = keepingBest(["mesh", ...reading(now), "--tol", DRAFT, "--require", "estimated", "-o", "draft.glb"]);
        await this.mesh("draft", words, "draft.glb", now);
      }
    } finally {
      this.drafting = null;
    }
    // A mistake may have had its answer before the shape that it was made in had its draft.
    const { ended, bench: now } = this.state;
    if (ended === now) void this.proveOlder(now);
  }

  private async prove(): Promise<void> {
    const { bench: now } = this.state;
    const number = ++this.proofs;
    this.update({ ended: null });
    // Pixels are counted from the box of the shape, which its draft shows first.
    if (now.budget.by === "px" && this.drafting) {
      await this.drafting;
      if (number !== this.proofs || now !== this.state.bench) return;
    }
    const { view, size } = this.state;
    this.counted = { bench: now, view, size, screen: this.screen };
    const isMade = await this.proof(now);
    if (isMade === false && number === this.proofs) await this.proveOlder(now);
    if (number === this.proofs) this.update({ ended: now });
  }
  private proofs = 0;

  private proof(of: Bench): Promise<boolean | null> {
    const output = this.outputOf(`${stem(of.name)}.glb`);
    return this.mesh("proof", keepingBest(meshLine(of, this.counted?.screen ?? this.screen, output)), output, of);
  }

  /** The last shape that worked may not have got beyond its draft. */
  private async proveOlder(now: Bench): Promise<void> {
    const { bench: newest, shown } = this.state;
    if (now === newest && shown?.isDraft && shown.of !== now) await this.proof(shown.of);
  }

  /** Shows what a line makes. Whether there is something; `null` where nobody waits for it any more. */
  private async mesh(lane: "draft" | "proof", words: Line, output: string, of: Bench): Promise<boolean | null> {
    const begun = performance.now();
    const outcome = await this.run(lane, words, of.files, true);
    if (!outcome || !this.isWanted(lane, of)) return null;
    const { certificate } = reportOf(outcome);
    const bytes = outcome.made[output];
    const isNewest = of === this.state.bench;
    if (!bytes || !certificate) {
      if (lane === "draft" || isNewest) this.update({ fault: faultOf(outcome) });
      return false;
    }
    const up = this.upOf(of, certificate.frame.up);
    const read = await drawn(() => withPictures(partsOf(bytes, certificate.frame)));
    const parts = (read ?? []).map((part) => standing(part, up));
    if (!this.isWanted(lane, of)) return null;
    if (lane === "proof") this.provedOf = of;
    const seconds = (performance.now() - begun) / 1000;
    const isShort = outcome.exit !== 0;
    this.frame(of, parts, up);
    const shown: Shown = { of, parts, certificate, bytes, seconds, isDraft: lane === "draft", isShort };
    // What is wrong with the newest stays where an older one is proved in its place.
    const isOld = lane === "proof" && !isNewest;
    const fault = isOld ? this.state.fault : isShort && lane === "proof" ? faultOf(outcome) : null;
    this.update({ shown, fault, ...(read ? {} : { notice: "undrawn" }) });
    if (!isOld && this.drawnOf !== of && this.drawnOf !== shown) this.later("picture", () => void this.draw());
    return true;
  }

  /** A proof is of what is there or shown. An older draft of it is better than none while one drags, until the proof is there. */
  private isWanted(lane: "draft" | "proof", of: Bench): boolean {
    const { bench: now } = this.state;
    if (lane === "proof") return of === now || of === this.state.shown?.of;
    return of.name === now.name && this.provedOf !== now && this.provedOf !== of;
  }
  private provedOf: Bench | null = null;
  /** What the last picture shows: the field of a bench, or triangles. */
  private drawnOf: Bench | Shown | null = null;

  /** The axis that is up: glTF's is y, if the report does not say. */
  private upOf(now: Bench, up: string | null): string | null {
    return up ?? (/\.(glb|gltf)$/i.test(now.name) ? "y" : null);
  }

  /** Stands before a new shape; a changed one is looked at as before, unless it is of quite another size. */
  private frame(now: Bench, parts: readonly Part[], up: string | null): void {
    const isNew = this.seen?.name !== now.name;
    const box = boxOf(parts);
    if (isNew && !box) return;
    this.seen = { name: now.name, up };
    if (!box) return;
    const [low, high] = box;
    const diagonal = Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]) || 1;
    const target: Vec3 = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2];
    const { azimuth, elevation } = isNew ? HOME : this.state.view;
    const home = { ...HOME, target, distance: AWAY * diagonal };
    const grown = home.distance / this.state.home.distance;
    if (!isNew && (this.dragged || Math.max(grown, 1 / grown) < OTHER_SIZE)) return;
    this.update({ view: { ...home, azimuth, elevation }, home });
    // What was proved for pixels was so from where nobody stands.
    if (now.budget.by === "px") this.later("proof", () => void this.prove());
  }

  /** A place of the report in the picture. */
  place(at: Vec3): Vec3 {
    return stood(at, this.seen?.up ?? null);
  }

  private async inspect(): Promise<void> {
    const { bench: now } = this.state;
    const done = await this.reads("inspect", ["inspect", ...reading(now)], now.files, true);
    if (!done || now !== this.state.bench) return;
    const { outcome } = done;
    const { inspection, certificate } = reportOf(outcome);
    this.update({ inspection: inspection ?? null, witnesses: certificate?.valid?.witnesses ?? [] });
    if (!inspection) this.update({ fault: faultOf(outcome) });
  }

  /** Puts something else beside the mesh. */
  besides(beside: Beside): void {
    this.update({ beside, picture: null });
    void this.draw();
  }

  /** What stands beside the mesh, as the command sees it from where the mesh is seen. */
  private async draw(): Promise<void> {
    const { bench: now, beside, view, size, shown } = this.state;
    const what = besideOf(now, beside);
    if (what === "sliced" || !shown || (what !== "traced" && shown.isDraft)) return;
    // What is shaded is counted on the pixels of this screen.
    const ratio = what === "overshade" ? globalThis.devicePixelRatio || 1 : Math.min(1, Math.sqrt(MOST_DOTS / (size.width * size.height)));
    const dots = { width: Math.round(size.width * ratio), height: Math.round(size.height * ratio) };
    const { parts, certificate } = shown;
    const subject = { bench: now, parts, up: this.seen?.up ?? null, atMost: certificate.bound?.at_most ?? null };
    const { line, files } = pictureLine(what, subject, view, dots);
    const done = await this.reads("picture", line, files, true);
    if (!done || now !== this.state.bench || beside !== this.state.beside) return;
    const { outcome } = done;
    const png = outcome.made["picture.png"];
    this.drawnOf = what === "traced" ? now : shown;
    if (!png) return this.update({ fault: faultOf(outcome) });
    this.update({ picture: { of: what, png, report: reportOf(outcome) } });
  }

  /** Runs a line, without options of the bench that are for other verbs. The line that comes back is the one that was run. */
  private async reads(lane: LaneName, line: Line, files: Files, isReport: boolean): Promise<{ outcome: Outcome; line: Line } | null> {
    const outcome = await this.run(lane, line, files, isReport);
    if (!outcome) return null;
    const other = outcome.exit === USAGE && /unexpected argument '(-[\w-]+)/.exec(`${outcome.stderr}${outcome.stdout}`)?.[1];
    const less = other ? without(line, other) : line;
    return less.length < line.length ? this.reads(lane, less, files, isReport) : { outcome, line };
  }

  private async run(lane: LaneName, words: Line, files: Files, isReport: boolean): Promise<Outcome | null> {
    const mark = (isOn: boolean) => {
      const { running, progress } = this.state;
      const { [lane]: _, ...rest } = progress;
      this.update({ running: isOn ? [...running.filter((one) => one !== lane), lane] : running.filter((one) => one !== lane), progress: rest });
    };
    mark(true);
    try {
      const all = isReport ? [...words, "--json"] : words;
      return await this.jobs.run(lane, all, files, (progress) => this.update({ progress: { ...this.state.progress, [lane]: progress } }));
    } catch (error) {
      if (error instanceof Stopped && error.why === "unloaded") this.update({ notice: "unloaded" });
      else if (error instanceof Stopped && error.why === "trapped") {
        // What stands before the last line are warnings, and the last one is the browser's own.
        const last = error.message.split("\n").slice(0, -1).findLast((line) => line && !line.includes("warning:"));
        this.update({ notice: "trapped", fault: last ? { text: last } : null });
      } else if (!(error instanceof Stopped)) throw error;
      return null;
    } finally {
      if (!this.jobs.isRunning(lane)) mark(false);
    }
  }

  private later(name: string, act: () => void): void {
    clearTimeout(this.timers.get(name));
    const timer = setTimeout(() => {
      this.timers.delete(name);
      this.update({ isWaiting: this.timers.size > 0 });
      act();
    }, REST_MS);
    this.timers.set(name, timer);
    this.update({ isWaiting: true });
  }

  private update(change: Partial<State>): void {
    this.state = { ...this.state, ...change };
    this.changed();
  }
}

/** A name that the command does not take for an option. */
const nameOf = ({ name }: File): string => name.replace(/^-+/, "_");

const keepingBest = (line: Line): Line => (line.includes(KEEP_BEST) ? line : [...line, KEEP_BEST]);

/** What can be read of a file that was written; nothing where this page cannot. */
const drawn = <T>(read: () => Promise<T>): Promise<T | undefined> => Promise.resolve().then(read).catch(() => undefined);
