// The input on the bench, and the arguments of the command for it. The line that the page shows is the line that was run.
import type { Files } from "../core/command";

export type BudgetKind = "tol" | "px" | "triangles";

export interface Budget {
  by: BudgetKind;
  /** In the command's notation: 0.1, 0.1mm or 0.5%. */
  tol: string;
  px: string;
  triangles: string;
}

/** The input on the bench: a file, and the files to which it refers or that are combined with it. */
export interface Bench {
  /** The file's name. */
  name: string;
  /** All files by name, among them the script. */
  files: Files;
  budget: Budget;
  /** Values that replace the defaults of a script's parameters, by the label of `param`. */
  set: Readonly<Record<string, string>>;
  /** A solid that is combined with it, by its file's name. */
  combine: { how: "union" | "minus" | "intersect"; name: string } | null;
  /** Further options as text, such as `--iso 60`. */
  options: string;
  /** The command lines that produced this file from another one, oldest first. */
  before: readonly Line[];
  /** The id of the script on the shelf that this is, if it is kept there. */
  kept?: string;
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
const DRAWING = /\.(svg|ttf|otf|ttc)$/i;
const VOLUME = /\.(npy|npz|nrrd|nhdr|nii|nii\.gz|mha|mhd|vti|slc|vm)$/i;
const MESH = /\.(glb|gltf|3mf|obj|ply|stl|off|amf|dae)$/i;
const GRID_OR_FIELD = /\.(star|npy|npz|nrrd|nhdr|nii|nii\.gz|mha|mhd|vti|slc|vm)$/i;

export const isScript = ({ name }: Bench): boolean => SCRIPT.test(name);
export const isDrawing = ({ name }: { name: string }): boolean => DRAWING.test(name);
export const isVolume = ({ name }: Bench): boolean => VOLUME.test(name);
/** Triangles in a file, as they are. */
export const isMesh = ({ name }: Bench): boolean => MESH.test(name);
export const hasField = ({ name }: Bench): boolean => GRID_OR_FIELD.test(name);

/** A script with files beside it. */
export const readsFiles = (bench: Bench): boolean => isScript(bench) && Object.keys(bench.files).length > 1;

export const textOf = ({ name, files }: Bench): string => new TextDecoder().decode(files[name]);

export function withText(bench: Bench, text: string): Bench {
  return { ...bench, files: { ...bench.files, [bench.name]: new TextEncoder().encode(text) } };
}

/** A file's name without folder and ending. */
export const stem = (name: string): string => name.replace(/^.*\//, "").replace(/(\.nii)?\.[^.]*$/, "") || "shape";

/** The view for pixel budgets: any eye at that distance, with a screen of that size. */
export interface Screen {
  width: number;
  height: number;
  fovDeg: number;
  distance: number;
}

/** A placeholder at build time, when there is no screen. */
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

/** The arguments for the input that every verb takes. */
export const reading = (bench: Bench): Line => [
  bench.name,
  ...Object.entries(bench.set).flatMap(([label, value]) => ["--set", `${label}=${value}`]),
  ...split(bench.options),
];

export const meshLine = (bench: Bench, screen: Screen, output: string): Line => [
  "mesh",
  ...reading(bench),
  ...(bench.combine ? [`--${bench.combine.how}`, bench.combine.name] : []),
  ...limits(bench, screen),
  "-o",
  output,
];

/** Splits a text as a shell does: quotes keep their content together. */
export function split(text: string): string[] {
  const words: string[] = [];
  for (const match of text.matchAll(/((?:[^\s"']+|"[^"]*"|'[^']*')+)/g)) words.push(match[0].replace(/["']/g, ""));
  return words;
}

/** Removes an option and its value, which may be a negative number. */
export function without(words: Line, option: string): Line {
  const at = words.findIndex((word) => word === option || word.startsWith(`${option}=`));
  if (at < 1) return words;
  const next = words[at + 1];
  const isPair = words[at] === option && next !== undefined && (isNumber(next) || !next.startsWith("-"));
  return [...words.slice(0, at), ...words.slice(at + (isPair ? 2 : 1))];
}

/** Quotes a word for a shell if necessary. */
export const quoted = (word: string): string => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replace(/'/g, "'\\''")}'`);

export const shell = (lines: readonly Line[]): string =>
  lines.map((line) => ["chordal", ...line].map(quoted).join(" ")).join("\n");

/** A string literal that is valid in both Python and Rust. */
const literal = (text: string): string => JSON.stringify(text);

/** Whether a text is a number, so that it is safe to paste into Python code. */
export const isNumber = (text: string): boolean => /^[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$/.test(text.trim());

/** Python code for the mesh. Previous steps and options without a counterpart are run as command lines. */
export function python(bench: Bench, screen: Screen, output: string): string {
  const { budget } = bench;
  const steps = bench.before.map((line) => `subprocess.run(${literalList(["chordal", ...line])}, check=True)`);
  const values = Object.entries(bench.set).map(([label, value]) => `, ${literal(label)}: ${isNumber(value) ? value.trim() : literal(value)}`);
  // A boolean accepts only a length as budget.
  const isPlain = split(bench.options).length === 0 && (!bench.combine || budget.by === "tol");
  const read = isScript(bench)
    ? `chordal.script(open(${literal(bench.name)}).read()${values.length ? `, **{${values.join("").slice(2)}}` : ""})`
    : `chordal.load(${literal(bench.name)})`;
  const limit =
    budget.by === "tol"
      ? budget.tol.includes("%")
        ? `rel=${literal(budget.tol.trim())}`
        : `tol=${/^[\d.eE+-]+$/.test(budget.tol.trim()) ? budget.tol.trim() : literal(budget.tol.trim())}`
      : budget.by === "px"
        ? `pixels=${Number(budget.px)}, view=${literal(viewText(screen))}`
        : `triangles=${Number(budget.triangles)}`;
  const operators = { union: "union", minus: "difference", intersect: "intersection" } as const;
  const make = bench.combine
    ? `shape.combine((${literal(operators[bench.combine.how])}, chordal.load(${literal(bench.combine.name)})), ${limit})`
    : `shape.mesh(${limit})`;
  const code = isPlain
    ? [`shape = ${read}`, `mesh = ${make}`, "print(mesh.bound)", `mesh.export(${literal(output)})`]
    : [`subprocess.run(${literalList(["chordal", ...meshLine(bench, screen, output)])}, check=True)`];
  const imports = [...(steps.length || !isPlain ? ["import subprocess"] : []), ...(isPlain ? ["import chordal"] : [])];
  return [...imports, ...steps, ...code].join("\n");
}

const literalList = (words: readonly string[]): string => `[${words.map(literal).join(", ")}]`;

/** Rust code for the mesh, with the crate chordal-verbs. */
export function rust(bench: Bench, screen: Screen, output: string): string {
  const { budget } = bench;
  if (bench.before.length || bench.combine || bench.options.trim() || Object.keys(bench.set).length) {
    // Anything beyond a budget is run as command lines.
    const lines = [...bench.before, meshLine(bench, screen, output)];
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
    `let bytes = std::fs::read(${literal(bench.name)})?;`,
    `let hint = FormatHint { name: Some(${literal(bench.name)}), ..FormatHint::default() };`,
    "let input = chordal_verbs::load(&bytes, hint, &Default::default())?;",
    `let spec = BudgetSpec { ${limit}, ..BudgetSpec::default() };`,
    `let mesh = chordal_verbs::mesh(input, &spec, Format::${named}, &Job::default())?;`,
    `mesh.write(&mut std::fs::File::create(${literal(output)})?)?;`,
  ].join("\n");
}

/** Renames an output that would overwrite an input. */
export const outputOf = ({ files }: Bench, output: string): string => (output in files ? output.replace(/(\.[^.]*)$/, "-out$1") : output);
