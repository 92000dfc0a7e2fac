// The functions of the script language for the editor: by name, with their parameters, and at a place in a text.
import { Facet } from "@codemirror/state";
import { type Token, tokenBefore } from "./tokens";

export interface FunctionRow {
  name: string;
  /** As in `gyroid(period, level=0)`. */
  usage: string;
  /** Its result, in a sentence or two. */
  doc: string;
  /** How exact its value is as a distance. */
  worth?: string;
}

export interface Table {
  rows: ReadonlyMap<string, FunctionRow>;
  words: readonly string[];
}

export const table = Facet.define<Table, Table>({ combine: (tables) => tables[0] ?? { rows: new Map(), words: [] } });

/** The parameters of a function in their notation: `*shapes`, or `level=0`. */
export function parametersOf({ usage }: FunctionRow): string[] {
  const inside = usage.slice(usage.indexOf("(") + 1, usage.lastIndexOf(")"));
  return inside === "" ? [] : inside.split(/,\s*/);
}

/** The name of a parameter, as in a call. */
export const parameterName = (parameter: string): string => parameter.replace(/^\*|=.*$/g, "");

export interface Call {
  row: FunctionRow;
  /** The index of the parameter at the place; -1 if it is unknown. */
  parameter: number;
}

/** The innermost call of a known function whose parentheses contain a place. */
export function callAt(text: string, all: readonly Token[], place: number, rows: Table["rows"]): Call | null {
  const open: { name: string; commas: number; last: Token | null }[] = [];
  const word = (token: Token | undefined) => (token ? text.slice(token.from, token.to) : "");
  const before = all.filter(({ kind, to }) => to <= place && kind !== "comment");
  before.forEach((token, k) => {
    const sign = token.kind === "sign" ? word(token) : "";
    const top = open.at(-1);
    if ("([{".includes(sign) && sign) {
      const callee = before[k - 1];
      const isCall = sign === "(" && callee?.kind === "name" && callee.to === token.from;
      open.push({ name: isCall ? word(callee) : "", commas: 0, last: null });
    } else if (")]}".includes(sign) && sign) {
      open.pop();
    } else if (sign === "," && top) {
      top.commas += 1;
      top.last = null;
    } else if (sign === "=" && top && before[k - 1]?.kind === "name") {
      top.last = before[k - 1]!;
    }
  });
  for (const { name, commas, last } of open.reverse()) {
    const row = rows.get(name);
    if (row) return { row, parameter: parameterIndex(parametersOf(row), commas, last && word(last)) };
  }
  return null;
}

/** The parameter by its name, or else by its position; a starred parameter takes all further positions. */
function parameterIndex(parameters: readonly string[], commas: number, name: string | null): number {
  if (name !== null) return parameters.findIndex((parameter) => parameterName(parameter) === name);
  const starred = parameters.findIndex((parameter) => parameter.startsWith("*"));
  if (starred >= 0 && commas >= starred) return starred;
  return commas < parameters.length ? commas : -1;
}

export interface NamedFunction {
  row: FunctionRow;
  token: Token;
}

/** The function whose name is at a place, or ends there. */
export function functionAt(text: string, all: readonly Token[], place: number, rows: Table["rows"]): NamedFunction | null {
  // In `a(b`, at the parenthesis the name ends; in `(b`, it starts behind it.
  for (const token of [tokenBefore(all, place), tokenBefore(all, place + 1)]) {
    const row = token?.kind === "name" && token.from <= place ? rows.get(text.slice(token.from, token.to)) : undefined;
    if (token && row) return { row, token };
  }
  return null;
}
