// Finds the Chinese of a sentence of the command by its English. `{n} edges are open` has the places of its values in braces; the
// values are kept. What stands at a place is told by its first letter, alone or before a capital, as in `{n}` and `{nMost}`:
// n is a number, f a name, p the name of a file, w a sentence that is translated, too, k the kind of a value in words, or the value.
// Any other place takes any text.

export type Table = Readonly<Record<string, string>>;

interface Pattern {
  pattern: RegExp;
  places: readonly string[];
  chinese: string;
  /** The more of a sentence is fixed, the better it fits. */
  fixed: number;
}

/** The place's letter, or nothing if it takes any text. */
const letterOf = (place: string): string => /^([nfpwk])(?:[A-Z]\w*)?$/.exec(place)?.[1] ?? "";

const VALUES: Readonly<Record<string, string>> = { n: "(-?[\\d.,]+(?:e-?\\d+)?|inf|-inf|NaN)", f: "([\\w.]+)", p: "([^:]+\\.\\w+)", k: "([^:]+?)" };
const escaped = (text: string) => text.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");

function patternOf(english: string, chinese: string): Pattern {
  const parts = english.split(/\{(\w+)\}/);
  const places = parts.filter((_, k) => k % 2 === 1);
  const source = parts.map((part, k) => (k % 2 === 1 ? (VALUES[letterOf(part)] ?? "([^]+?)") : escaped(part))).join("");
  return { pattern: new RegExp(`^${source}$`), places, chinese, fixed: english.replace(/\{\w+\}/g, "").length };
}

/** A translator by tables: of sentences, and of the kinds of values in them. */
export function translator(sentences: Table, kinds: Table): (english: string) => string | undefined {
  const compile = (table: Table) => Object.entries(table).map(([english, chinese]) => patternOf(english, chinese)).sort((a, b) => b.fixed - a.fixed);
  let compiled: { sentences: readonly Pattern[]; kinds: readonly Pattern[] } | undefined;
  const within = (of: readonly Pattern[], english: string): string | undefined => {
    for (const { pattern, places, chinese } of of) {
      const values = pattern.exec(english)?.slice(1).map((value, k) => valueIn(places[k]!, value));
      if (values && !values.includes(undefined)) return chinese.replace(/\{(\w+)\}/g, (_, place: string) => values[places.indexOf(place)]!);
    }
    return undefined;
  };
  const valueIn = (place: string, value: string): string | undefined => {
    const letter = letterOf(place);
    if (letter === "w") return within(compiled!.sentences, value);
    return letter === "k" ? (within(compiled!.kinds, value) ?? value) : value;
  };
  return (english) => {
    compiled ??= { sentences: compile(sentences), kinds: compile(kinds) };
    return within(compiled.sentences, english);
  };
}
