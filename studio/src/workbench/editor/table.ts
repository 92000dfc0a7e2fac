// The functions that scripts know, as the editor needs them: by name, with their parameters, and at a place of a text.
import { Facet } from "@codemirror/state";
import { type Token, tokenBefore } from "./tokens";

export interface FunctionRow {
  name: string;
  /** As in `gyroid(period, level=0)`. */
  usage: string;
  /** What it makes, in a sentence or two. */
  doc: string;
  /** How far its value can be trusted as a distance. */
  worth?: string;
}

export interface Table {
  rows: ReadonlyMap<string, FunctionRow>;
  words: readonly string[];
}

export const table = Facet.define<Table, Table>({ combine: (tables) => tables[0] ?? { rows: new Map(), words: [] } });

/** The parameters of a function as they are written: `shapes`, with a star before it, or `level=0`. */
export function parametersOf({ usage }: FunctionRow): string[] {
  const inside = usage.slice(usage.indexOf("(") + 1, usage.lastIndexOf(")"));
  return inside === "" ? [] : inside.split(/,\s*/);
}

/** The name of a parameter as a call gives it. */
export const parameterName = (parameter: string): string => parameter.replace(/^\*|=.*$/g, "");

export interface Call {
  row: FunctionRow;
  /** Which of its parameters is being given; -1 where it cannot be told. */
  parameter: number;
}

/** The call in whose parentheses a place is, the innermost first, of functions that are known. */
export function callAt(text: string, all: readonly Token[], place: number, rows: Table["rows"]): Call | null {
  const open: { name: string; commas: number; last: Token | null }[] = [];
  const word = (token: Token | undefined) => (token ? text.slice(token.from, token.to) : "");
  const before = all.filter(({ kind, to }) => to <= place && kind !== "comment");
  before.forEach((token, k) => {
    const said = token.kind === "sign" ? word(token) : "";
    const top = open.at(-1);
    if ("([{".includes(said) && said) {
      const called = before[k - 1];
      const isCall = said === "(" && called?.kind === "name" && called.to === token.from;
      open.push({ name: isCall ? word(called) : "", commas: 0, last: null });
    } else if (")]}".includes(said) && said) {
      open.pop();
    } else if (said === "," && top) {
      top.commas += 1;
      top.last = null;
    } else if (said === "=" && top && before[k - 1]?.kind === "name") {
      top.last = before[k - 1]!;
    }
  });
  for (const { name, commas, last } of open.reverse()) {
    const row = rows.get(name);
    if (row) return { row, parameter: parameterIndex(parametersOf(row), commas, last && word(last)) };
  }
  return null;
}

/** Given by name, or by how many came before; what takes any number of arguments takes all of these. */
function parameterIndex(parameters: readonly string[], commas: number, name: string | null): number {
  if (name !== null) return parameters.findIndex((parameter) => parameterName(parameter) === name);
  const rest = parameters.findIndex((parameter) => parameter.startsWith("*"));
  if (rest >= 0 && commas >= rest) return rest;
  return commas < parameters.length ? commas : -1;
}

export interface NamedFunction {
  row: FunctionRow;
  token: Token;
}

/** The function whose name stands at a place, or ends there. */
export function functionAt(text: string, all: readonly Token[], place: number, rows: Table["rows"]): NamedFunction | null {
  // Of `a(b` at the bracket the name is before, and of `(b` it begins there.
  for (const token of [tokenBefore(all, place), tokenBefore(all, place + 1)]) {
    const row = token?.kind === "name" && token.from <= place ? rows.get(text.slice(token.from, token.to)) : undefined;
    if (token && row) return { row, token };
  }
  return null;
}
