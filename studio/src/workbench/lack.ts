// What a script lacks: a file that it reads, or the font of a text; and the script once that was chosen or dropped.
import type { Files } from "../core/command";
import { type Bench, isScript, textOf, withText } from "./document";
import type { State } from "./state";

export interface Lack {
  /** The file's name in the script; `null` for a text that is set without a font. */
  name: string | null;
  isFont: boolean;
  /** The line of the script that asks for it. */
  line: number;
}

/** A file that the command did not find, as its message names it. */
const MISSING = /'([^']+)' cannot be (?:used|loaded): no such file or directory/;
/** A text that is set without a font. */
const NO_FONT = /`font` for call to `text`|text\(\) needs 'font'/;
export const isFont = (name: string): boolean => /\.(ttf|otf|ttc)$/i.test(name);

/** What the script on the bench lacks; `null` if it is another mistake, or none. */
export function lackOf({ bench, fault }: Pick<State, "bench" | "fault">): Lack | null {
  if (!isScript(bench) || !fault) return null;
  const name = MISSING.exec(fault.text)?.[1] ?? null;
  if (name === null && !NO_FONT.test(fault.text)) return null;
  return { name, isFont: name === null || isFont(name), line: fault.line ?? 1 };
}

const endingOf = (name: string): string => /\.[^.]*$/.exec(name)?.[0].toLowerCase() ?? "";

/** Whether files that are dropped are what the script lacks, and not a shape of their own. */
export function suits({ name, isFont: wantsFont }: Lack, dropped: readonly string[]): boolean {
  if (name !== null && dropped.includes(name)) return true;
  const [only, ...others] = dropped;
  if (only === undefined || others.length) return false;
  // A script of another name is a script to open.
  return wantsFont ? isFont(only) : endingOf(only) === endingOf(name!) && endingOf(only) !== ".star";
}

/** The bench with what it lacks: files under their own names, or a single one under the name in the script, whatever its own is. */
export function supplied(bench: Bench, { name, line }: Lack, given: Files): Bench {
  const [[file, bytes] = ["", new Uint8Array()]] = Object.entries(given);
  const files = name === null || given[name] ? given : { [name]: bytes };
  const added = { ...bench, files: { ...bench.files, ...files } };
  return name === null ? withText(added, withFont(textOf(bench), line, file)) : added;
}

/** A call of `text` whose only argument without a name is the text, up to the end of that. */
const TEXT_CALL = /\btext\(\s*("[^"]*"|'[^']*')(?=\s*[,)])/;

/** The script with a font as the second argument of the call of `text` in a line. */
export function withFont(script: string, line: number, font: string): string {
  const lines = script.split("\n");
  lines[line - 1] = (lines[line - 1] ?? "").replace(TEXT_CALL, (call) => `${call}, ${JSON.stringify(font)}`);
  return lines.join("\n");
}
