// Finds the Chinese of a sentence of the command by its English. `{n} edges are open` has the places of its values in braces; the
// values are kept. What stands at a place is told by its first letter, alone or before a capital, as in `{n}` and `{nMost}`:
// n is a number, f a name, p the name of a file, w a sentence that is translated, too, k the kind of a value in words, or the value;
// `{list}` is a list of names, and `{option}` an option of the command, or what the page calls it. In quotes a place takes any text without them.
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
const letterOf = (place: string): string => (place === "list" ? "l" : place === "option" ? "o" : (/^([nfpwk])(?:[A-Z]\w*)?$/.exec(place)?.[1] ?? ""));

const VALUES: Readonly<Record<string, string>> = { l: "([\\w., ]+?)", o: "([-<][^;]+?)", n: "(-?[\\d.,]+(?:e-?\\d+)?|inf|-inf|NaN)", f: "([\\w.]+)", p: "([^:]+\\.\\w+)", k: "((?:'[^']*'|[^:])+?)" };
const escaped = (text: string) => text.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");

function patternOf(english: string, chinese: string): Pattern {
  const parts = english.split(/\{(\w+)\}/);
  const places = parts.filter((_, k) => k % 2 === 1);
  const isQuoted = (k: number) => /['`]$/.test(parts[k - 1]!) && parts[k + 1]!.startsWith(parts[k - 1]!.at(-1)!);
  const anyText = (k: number) => (isQuoted(k) ? `([^${parts[k - 1]!.at(-1)!}]*)` : "([^]+?)");
  const source = parts.map((part, k) => (k % 2 === 1 ? ((isQuoted(k) ? undefined : VALUES[letterOf(part)]) ?? anyText(k)) : escaped(part))).join("");
  return { pattern: new RegExp(`^${source}$`), places, chinese, fixed: english.replace(/\{\w+\}/g, "").length };
}

/** A kind, apart from the characters around it if it is no Chinese there, as in `应为 2 个数`. */
function spaced(chinese: string, at: number, place: string, value: string): string {
  if (!["k", "o"].includes(letterOf(place))) return value;
  const [before, after] = [chinese[at - 1] ?? "", chinese[at + place.length + 2] ?? ""];
  const isApart = (ours: string, theirs: string) => /[!-~]/.test(ours) && /\p{Script=Han}/u.test(theirs);
  return `${isApart(value[0]!, before) ? " " : ""}${value}${isApart(value.at(-1)!, after) ? " " : ""}`;
}

/** A translator by tables: of sentences, and of the kinds of values in them. */
export function translator(sentences: Table, kinds: Table): (english: string) => string | undefined {
  const compile = (table: Table) => Object.entries(table).map(([english, chinese]) => patternOf(english, chinese)).sort((a, b) => b.fixed - a.fixed);
  let compiled: { sentences: readonly Pattern[]; kinds: readonly Pattern[] } | undefined;
  const within = (of: readonly Pattern[], english: string): string | undefined => {
    for (const { pattern, places, chinese } of of) {
      const values = pattern.exec(english)?.slice(1).map((value, k) => valueIn(places[k]!, value));
      if (values && !values.includes(undefined)) return chinese.replace(/\{(\w+)\}/g, (_, place: string, at: number) => spaced(chinese, at, place, values[places.indexOf(place)]!));
    }
    return undefined;
  };
  const valueIn = (place: string, value: string): string | undefined => {
    const letter = letterOf(place);
    if (letter === "w") return within(compiled!.sentences, value);
    if (letter === "l") return value.replace(/ (and|or) /g, (_, word) => (word === "and" ? " 和 " : " 或 ")).replaceAll(", ", "、");
    return letter === "k" || letter === "o" ? (within(compiled!.kinds, value) ?? value) : value;
  };
  return (english) => {
    compiled ??= { sentences: compile(sentences), kinds: compile(kinds) };
    return within(compiled.sentences, english);
  };
}
