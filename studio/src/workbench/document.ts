// What is on the bench, and the words of the command that make something of it. The line that the page shows is the line that
// was run.
import type { Files } from "./command";

export type BudgetKind = "tol" | "px" | "triangles";

export interface Budget {
  by: BudgetKind;
  /** As the command takes it: 0.1, 0.1mm or 0.5%. */
  tol: string;
  px: string;
  triangles: string;
}

/** A shape on the bench: a file, and the files that it names or that are combined with it. */
export interface Bench {
  /** The file's name. */
  name: string;
  /** All files by name; the text of a script is among them. */
  files: Files;
  budget: Budget;
  /** Values that take the place of those in a script, by the label of `param`. */
  set: Readonly<Record<string, string>>;
  /** A solid that is combined with it, by its file's name. */
  combine: { how: "union" | "minus" | "intersect"; name: string } | null;
  /** Options besides, as one writes them, such as `--iso 60`. */
  options: string;
  /** The lines that made this file out of another one, oldest first. */
  before: readonly Line[];
}

export type Line = readonly string[];

export const BUDGET: Budget = { by: "tol", tol: "0.5%", px: "1", triangles: "5000" };

export const bench = (name: string, files: Files, before: readonly Line[] = []): Bench => ({
  name,
  files,
  budget: BUDGET,
  set: {},
  combine: null,
  options: "",
  before,
});

const SCRIPT = /\.star$/i;
const DRAWING = /\.(svg|ttf|otf)$/i;
const VOLUME = /\.(npy|npz|nrrd|nhdr|nii|nii\.gz|mha|mhd|vti|slc|vm)$/i;
const GRID_OR_FIELD = /\.(star|npy|npz|nrrd|nhdr|nii|nii\.gz|mha|mhd|vti|slc|vm)$/i;

export const isScript = ({ name }: Bench): boolean => SCRIPT.test(name);
export const isDrawing = ({ name }: Bench): boolean => DRAWING.test(name);
export const isVolume = ({ name }: Bench): boolean => VOLUME.test(name);
export const hasField = ({ name }: Bench): boolean => GRID_OR_FIELD.test(name);

export const textOf = ({ name, files }: Bench): string => new TextDecoder().decode(files[name]);

export function withText(of: Bench, text: string): Bench {
  return { ...of, files: { ...of.files, [of.name]: new TextEncoder().encode(text) } };
}

/** A file's name without folder and ending. */
export const stem = (name: string): string => name.replace(/^.*\//, "").replace(/(\.nii)?\.[^.]*$/, "") || "shape";

/** The view of pixels: any eye at that distance, on a screen of that size. */
export interface Screen {
  width: number;
  height: number;
  fovDeg: number;
  distance: number;
}

/** Of a page that nobody looks at yet. */
export const NO_SCREEN: Screen = { width: 1, height: 1, fovDeg: 1, distance: 1 };

const short = (value: number): string => String(Number(value.toPrecision(4)));

export function viewText({ width, height, fovDeg, distance }: Screen): string {
  return `${Math.round(width)}x${Math.round(height)} fov=${short(fovDeg)} dist=${short(distance)}`;
}

function limits({ budget }: Bench, screen: Screen): Line {
  switch (budget.by) {
    case "tol":
      return ["--tol", budget.tol.trim()];
    case "px":
      return ["--px", budget.px.trim(), "--view", viewText(screen)];
    case "triangles":
      return ["--triangles", budget.triangles.trim()];
  }
}

/** What every verb takes that reads the file. */
export const reading = (of: Bench): Line => [
  of.name,
  ...Object.entries(of.set).flatMap(([label, value]) => ["--set", `${label}=${value}`]),
  ...split(of.options),
];

export const meshLine = (of: Bench, screen: Screen, output: string): Line => [
  "mesh",
  ...reading(of),
  ...(of.combine ? [`--${of.combine.how}`, of.combine.name] : []),
  ...limits(of, screen),
  "-o",
  output,
];

/** Words as a shell splits them: quotes hold together what stands between them. */
export function split(text: string): string[] {
  const words: string[] = [];
  for (const match of text.matchAll(/((?:[^\s"']+|"[^"]*"|'[^']*')+)/g)) words.push(match[0].replace(/["']/g, ""));
  return words;
}

/** Words without an option and its value, which may be a negative number. */
export function without(words: Line, option: string): Line {
  const at = words.findIndex((word) => word === option || word.startsWith(`${option}=`));
  if (at < 1) return words;
  const next = words[at + 1];
  const isPair = words[at] === option && next !== undefined && (isNumber(next) || !next.startsWith("-"));
  return [...words.slice(0, at), ...words.slice(at + (isPair ? 2 : 1))];
}

/** A word as a shell needs it. */
export const quoted = (word: string): string => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replace(/'/g, "'\\''")}'`);

export const shell = (lines: readonly Line[]): string =>
  lines.map((line) => ["chordal", ...line].map(quoted).join(" ")).join("\n");

/** A text as Python and Rust both write it. */
const literal = (text: string): string => JSON.stringify(text);

/** A number as the command takes it, and nothing else that Python might run. */
export const isNumber = (text: string): boolean => /^[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$/.test(text.trim());

/** The mesh in Python. Steps before it, and options that the page does not know, are run as lines of the command. */
export function python(of: Bench, screen: Screen, output: string): string {
  const { budget } = of;
  const steps = of.before.map((line) => `subprocess.run(${literalList(["chordal", ...line])}, check=True)`);
  const values = Object.entries(of.set).map(([label, value]) => `, ${literal(label)}: ${isNumber(value) ? value.trim() : literal(value)}`);
  // A boolean takes a length alone.
  const isPlain = split(of.options).length === 0 && (!of.combine || budget.by === "tol");
  const read = isScript(of)
    ? `chordal.script(open(${literal(of.name)}).read()${values.length ? `, **{${values.join("").slice(2)}}` : ""})`
    : `chordal.load(${literal(of.name)})`;
  const limit =
    budget.by === "tol"
      ? budget.tol.includes("%")
        ? `rel=${literal(budget.tol.trim())}`
        : `tol=${/^[\d.eE+-]+$/.test(budget.tol.trim()) ? budget.tol.trim() : literal(budget.tol.trim())}`
      : budget.by === "px"
        ? `pixels=${Number(budget.px)}, view=${literal(viewText(screen))}`
        : `triangles=${Number(budget.triangles)}`;
  const operators = { union: "union", minus: "difference", intersect: "intersection" } as const;
  const make = of.combine
    ? `shape.combine((${literal(operators[of.combine.how])}, chordal.load(${literal(of.combine.name)})), ${limit})`
    : `shape.mesh(${limit})`;
  const code = isPlain
    ? [`shape = ${read}`, `made = ${make}`, "print(made.bound)", `made.export(${literal(output)})`]
    : [`subprocess.run(${literalList(["chordal", ...meshLine(of, screen, output)])}, check=True)`];
  const imports = [...(steps.length || !isPlain ? ["import subprocess"] : []), ...(isPlain ? ["import chordal"] : [])];
  return [...imports, ...steps, ...code].join("\n");
}

const literalList = (words: readonly string[]): string => `[${words.map(literal).join(", ")}]`;

/** The mesh in Rust, by the library of verbs. */
export function rust(of: Bench, screen: Screen, output: string): string {
  const { budget } = of;
  if (of.before.length || of.combine || of.options.trim() || Object.keys(of.set).length) {
    // What more than a budget takes is run as lines of the command.
    const lines = [...of.before, meshLine(of, screen, output)];
    return lines.map((line) => `std::process::Command::new("chordal").args([${line.map(literal).join(", ")}]).status()?;`).join("\n");
  }
  const limit =
    budget.by === "tol"
      ? `length: Some(${literal(budget.tol.trim())}.parse()?)`
      : budget.by === "px"
        ? `pixels: Some(PixelBudget { pixels: ${literal(budget.px.trim())}.parse()?, view: ${literal(viewText(screen))}.parse()? })`
        : `triangles: Some(${Number(budget.triangles)})`;
  const format = output.replace(/^.*\./, "");
  const named = format.charAt(0).toUpperCase() + format.slice(1);
  return [
    `let bytes = std::fs::read(${literal(of.name)})?;`,
    `let hint = FormatHint { name: Some(${literal(of.name)}), ..FormatHint::default() };`,
    "let input = chordal_verbs::load(&bytes, hint, &Default::default())?;",
    `let spec = BudgetSpec { ${limit}, ..BudgetSpec::default() };`,
    `let made = chordal_verbs::mesh(input, &spec, Format::${named}, &Job::default())?;`,
    `made.write(&mut std::fs::File::create(${literal(output)})?)?;`,
  ].join("\n");
}
