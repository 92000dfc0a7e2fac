// The further mistakes of a script. The command reports the first one; the page mends that in a copy and asks again. Only mistakes
// that no other one can cause are looked for: unknown names, and lines that are no Starlark.
import type { Fault } from "./outcome";

/** So many are shown at once; with more a reader begins with the first anyway. */
export const MOST_FAULTS = 8;

const UNKNOWN = /^Variable `(\w+)` not found/;
const UNREADABLE = /^Parse error:/;

/** Whether a mistake can be mended in a copy, so that the next one shows. */
export const isMendable = ({ text, line }: Fault): boolean => line !== undefined && (UNKNOWN.test(text) || UNREADABLE.test(text));

/**
 * Whether a mistake is another one than those before it. Reading a script ends at its first unreadable line, so the next such
 * line is below it, unless it was not mended.
 */
export const isFurther = (next: Fault, known: readonly Fault[]): boolean =>
  known.every((one) => one.text !== next.text || one.line !== next.line) &&
  (!UNREADABLE.test(next.text) || known.every((one) => !UNREADABLE.test(one.text) || one.line! < next.line!));

const OPENING = "([{";
const CLOSING = ")]}";

/** The line of a bracket that was opened before a line of the script and is still open there; `undefined` if there is none. */
export function openedBefore(script: string, line: number): number | undefined {
  const open: number[] = [];
  const lines = script.split("\n").slice(0, line - 1);
  for (const [i, text] of lines.entries()) {
    // Without texts and comments, in which brackets mean nothing.
    for (const letter of text.replace(/"(\\.|[^"\\])*"|'(\\.|[^'\\])*'|#.*/g, "")) {
      if (OPENING.includes(letter)) open.push(i + 1);
      else if (CLOSING.includes(letter)) open.pop();
    }
  }
  return open.at(-1);
}

/** A mistake with the line of the bracket that causes it, if one is open there. */
export function withCause(fault: Fault, script: string): Fault {
  const openedIn = fault.line !== undefined && UNREADABLE.test(fault.text) ? openedBefore(script, fault.line) : undefined;
  return openedIn === undefined ? fault : { ...fault, openedIn };
}

/** The script without a mistake, with all other lines in their places; `null` if that could cause another mistake. */
export function withoutFault(script: string, { text, line = 0 }: Fault): string | null {
  const unknown = UNKNOWN.exec(text)?.[1];
  // Before the first line, so that no place below it moves.
  if (unknown) return `${unknown} = 0; ${script}`;
  const lines = script.split("\n");
  const [here, next] = [lines[line - 1], lines[line]];
  if (here === undefined) return null;
  const indent = /^\s*/.exec(here)![0];
  // The head of a block, or a statement that goes on in the next line.
  const isOpen = /[:([{,\\]\s*(#.*)?$/.test(here) || (next !== undefined && /^\s/.test(next) && /^\s*/.exec(next)![0].length > indent.length);
  if (isOpen) return null;
  const name = /^\s*(\w+)\s*=(?!=)/.exec(here)?.[1];
  // What it assigned must stay known below.
  lines[line - 1] = `${indent}${name ?? "_"} = 0`;
  return lines.join("\n");
}

/** The place of a mistake in the copy, as it is in the script. */
export function inScript(fault: Fault, copy: string, script: string): Fault {
  const ahead = copy.split("\n")[0]!.length - script.split("\n")[0]!.length;
  return fault.line === 1 && fault.column && ahead > 0 ? { ...fault, column: Math.max(1, fault.column - ahead) } : fault;
}
