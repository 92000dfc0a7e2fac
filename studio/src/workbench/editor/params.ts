// The parameters of a script for sliders: calls of param() whose default is a literal number.
import { fitting, numbersOf, rewritten, stepOf } from "./numbers";
import { type Token, tokens } from "./tokens";

export interface ParamCall {
  /** The variable to which it is assigned; `null` if it is part of a larger expression. */
  name: string | null;
  /** Its name for `--set`. */
  label: string;
  value: number;
  /** The value of one unit of the default's last written digit. */
  step: number;
  /** The place of the default, its sign included. */
  from: number;
  to: number;
}

/** Parameters have names of up to 64 letters, digits and '_', in any alphabet: `param` in crates/chordal-script/src/builtins.rs. */
const LABEL = /^["']([\p{Alphabetic}\p{N}_]{1,64})["']$/u;

/** All calls whose default is a number, in the order of the text. Several calls may have the same label. */
function calls(text: string): ParamCall[] {
  const significant = tokens(text).filter(({ kind }) => kind !== "comment");
  const numbers = new Map(numbersOf(text).map((place) => [place.to, place]));
  const word = (token: Token | undefined) => (token ? text.slice(token.from, token.to) : "");
  const params: ParamCall[] = [];
  significant.forEach((token, k) => {
    const before = word(significant[k - 1]);
    if (token.kind !== "name" || word(token) !== "param" || before === "." || before === "def") return;
    const label = LABEL.exec(word(significant[k + 2]))?.[1];
    if (word(significant[k + 1]) !== "(" || label === undefined || word(significant[k + 3]) !== ",") return;
    // The number may be in parentheses.
    let next = k + 4;
    let nested = 0;
    for (; word(significant[next]) === "("; next += 1) nested += 1;
    if (word(significant[next]) === "-") next += 1;
    const place = significant[next]?.kind === "number" ? numbers.get(significant[next]!.to) : undefined;
    // A minus apart from the number is an operator, and the default an expression.
    if (!place || place.from !== (word(significant[next - 1]) === "-" ? significant[next - 1]!.from : significant[next]!.from)) return;
    for (next += 1; nested > 0 && word(significant[next]) === ")"; next += 1) nested -= 1;
    if (word(significant[next]) === ",") next += 1;
    if (nested > 0 || word(significant[next]) !== ")") return;
    const literal = text.slice(place.from, place.to);
    const name = assigned(text, significant, k, next);
    params.push({ name, label, value: Number(literal), step: stepOf(literal), from: place.from, to: place.to });
  });
  return params;
}

/** The variable of `name = f(g(param(…)))`; the call is from `first` to `last`, and nothing else may be assigned. */
function assigned(text: string, significant: readonly Token[], first: number, last: number): string | null {
  const word = (k: number) => (significant[k] ? text.slice(significant[k].from, significant[k].to) : "");
  const isEnd = (k: number) => !significant[k] || significant[k].kind === "end" || word(k) === ";";
  let [before, after] = [first - 1, last + 1];
  while (word(before) === "(" && word(after) === ")") {
    before -= significant[before - 1]?.kind === "name" ? 2 : 1;
    after += 1;
  }
  const isAssigned = word(before) === "=" && significant[before - 1]?.kind === "name" && (isEnd(before - 2) || word(before - 2) === ":");
  return isAssigned && isEnd(after) ? word(before - 1) : null;
}

/** The parameters of a script, each by its first call. */
export function paramsOf(text: string): ParamCall[] {
  const seen = new Set<string>();
  return calls(text).filter(({ label }) => !seen.has(label) && seen.add(label));
}

/** Changes the default of a parameter in all of its calls, because different defaults are an error. */
export function withParam(text: string, label: string, value: number): string {
  if (!Number.isFinite(value)) return text;
  const places = calls(text).filter((call) => call.label === label);
  return places.reduceRight((result, { from, to }) => {
    const literal = fitting(result, { from, to }, rewritten(result.slice(from, to), value));
    return result.slice(0, from) + literal + result.slice(to);
  }, text);
}
