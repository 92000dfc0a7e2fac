// The parameters of a script, as sliders need them: calls of param() whose default is a number as it is written.
import { fitting, numbersOf, rewritten, stepOf } from "./numbers";
import { type Token, tokens } from "./tokens";

export interface ParamCall {
  /** The variable that it is assigned to; nothing where it is a part of something larger. */
  name: string | null;
  /** What `--set` calls it. */
  label: string;
  value: number;
  /** The change of value that its last written digit stands for. */
  step: number;
  /** Where the default stands, its sign included. */
  from: number;
  to: number;
}

/** Parameters have names of up to 64 letters, digits and '_': `param` in crates/chordal-script/src/builtins.rs. */
const LABEL = /^["'](\w{1,64})["']$/;

/** Every call whose default is a number, in the order of the text; two calls may have one label. */
function calls(text: string): ParamCall[] {
  const all = tokens(text).filter(({ kind }) => kind !== "comment");
  const numbers = new Map(numbersOf(text).map((place) => [place.to, place]));
  const word = (token: Token | undefined) => (token ? text.slice(token.from, token.to) : "");
  const found: ParamCall[] = [];
  all.forEach((token, k) => {
    const before = word(all[k - 1]);
    if (token.kind !== "name" || word(token) !== "param" || before === "." || before === "def") return;
    const label = LABEL.exec(word(all[k + 2]))?.[1];
    if (word(all[k + 1]) !== "(" || label === undefined || word(all[k + 3]) !== ",") return;
    // The number may stand in parentheses of its own.
    let next = k + 4;
    let nested = 0;
    for (; word(all[next]) === "("; next += 1) nested += 1;
    if (word(all[next]) === "-") next += 1;
    const place = all[next]?.kind === "number" ? numbers.get(all[next]!.to) : undefined;
    if (!place || place.from !== (word(all[next - 1]) === "-" ? all[next - 1]!.from : all[next]!.from)) return;
    for (next += 1; nested > 0 && word(all[next]) === ")"; next += 1) nested -= 1;
    if (word(all[next]) === ",") next += 1;
    if (nested > 0 || word(all[next]) !== ")") return;
    const literal = text.slice(place.from, place.to);
    const name = assigned(text, all, k, next);
    found.push({ name, label, value: Number(literal), step: stepOf(literal), from: place.from, to: place.to });
  });
  return found;
}

/** The variable of `name = f(g(param(…)))`, where `first` to `last` is the call and nothing else is assigned. */
function assigned(text: string, all: readonly Token[], first: number, last: number): string | null {
  const word = (k: number) => (all[k] ? text.slice(all[k].from, all[k].to) : "");
  const isEnd = (k: number) => !all[k] || all[k].kind === "end" || word(k) === ";";
  let [before, after] = [first - 1, last + 1];
  while (word(before) === "(" && word(after) === ")") {
    before -= all[before - 1]?.kind === "name" ? 2 : 1;
    after += 1;
  }
  const isAssigned = word(before) === "=" && all[before - 1]?.kind === "name" && (isEnd(before - 2) || word(before - 2) === ":");
  return isAssigned && isEnd(after) ? word(before - 1) : null;
}

/** The parameters of a script: the first call of each. */
export function paramsOf(text: string): ParamCall[] {
  const known = new Set<string>();
  return calls(text).filter(({ label }) => !known.has(label) && known.add(label));
}

/** The script with another default of a parameter, in all of its calls: two defaults would be an error. */
export function withParam(text: string, label: string, value: number): string {
  if (!Number.isFinite(value)) return text;
  const places = calls(text).filter((call) => call.label === label);
  return places.reduceRight((made, { from, to }) => {
    const literal = fitting(made, { from, to }, rewritten(made.slice(from, to), value));
    return made.slice(0, from) + literal + made.slice(to);
  }, text);
}
