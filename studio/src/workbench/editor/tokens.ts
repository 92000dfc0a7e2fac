// The words of a script, by a scanner of its own: it stays right where a text is unfinished, and knows Starlark's numbers.
export type TokenKind = "name" | "number" | "odd" | "string" | "comment" | "sign" | "end";

export interface Token {
  /** `odd` looks like a number and is none that can be changed: 0x1F, 12abc. `end` is the end of a statement. */
  kind: TokenKind;
  from: number;
  to: number;
  /** How many brackets are open before it. */
  depth: number;
}

const NAME = /[\p{L}_][\p{L}\p{N}_]*/uy;
const NUMBER = /(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?/y;
const WORD_GOES_ON = /[\p{L}\p{N}_.]+/uy;
const STRING_PREFIX = /^(?:[rbf]|br|rb)$/i;
const COMMENT = /#[^\n]*/y;

const at = (pattern: RegExp, text: string, from: number): number => {
  pattern.lastIndex = from;
  return pattern.test(text) ? pattern.lastIndex : from;
};

export function tokens(text: string): Token[] {
  const found: Token[] = [];
  let [from, depth] = [0, 0];
  const add = (kind: TokenKind, to: number) => {
    found.push({ kind, from, to, depth });
    from = to;
  };
  while (from < text.length) {
    const c = text[from]!;
    if (c === "\n") {
      if (depth === 0) add("end", from + 1);
      else from += 1;
    } else if (/\s/.test(c) || c === "\\") {
      // A backslash takes the end of its line along.
      from += c === "\\" && text[from + 1] === "\n" ? 2 : 1;
    } else if (c === "#") {
      add("comment", at(COMMENT, text, from));
    } else if (c === '"' || c === "'") {
      add("string", stringEnd(text, from));
    } else if (at(NAME, text, from) > from) {
      const to = at(NAME, text, from);
      const isPrefix = (text[to] === '"' || text[to] === "'") && STRING_PREFIX.test(text.slice(from, to));
      if (isPrefix) add("string", stringEnd(text, to));
      else add("name", to);
    } else if (at(NUMBER, text, from) > from) {
      const to = at(NUMBER, text, from);
      const end = at(WORD_GOES_ON, text, to);
      add(end > to ? "odd" : "number", end);
    } else if ("([{".includes(c)) {
      add("sign", from + 1);
      depth += 1;
    } else if (")]}".includes(c)) {
      depth = Math.max(0, depth - 1);
      add("sign", from + 1);
    } else {
      add("sign", from + 1);
    }
  }
  return found;
}

/** Where the string ends whose quote stands at `from`; an unfinished one ends with its line, or with the text. */
function stringEnd(text: string, from: number): number {
  const quote = text[from]!;
  const isLong = text.startsWith(quote.repeat(3), from);
  const close = isLong ? quote.repeat(3) : quote;
  for (let k = from + close.length; k < text.length; k += 1) {
    if (text[k] === "\\") k += 1;
    else if (text.startsWith(close, k)) return k + close.length;
    else if (text[k] === "\n" && !isLong) return k;
  }
  return text.length;
}

/** The token that holds a place: it starts before, and ends behind it or right there. */
export function tokenBefore(all: readonly Token[], place: number): Token | undefined {
  let [low, high] = [0, all.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (all[middle]!.from < place) low = middle + 1;
    else high = middle;
  }
  const token = all[low - 1];
  return token && place <= token.to ? token : undefined;
}
