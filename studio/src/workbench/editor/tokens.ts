// A scanner for scripts. Unlike the parser it keeps working on unfinished text, and it knows Starlark's numbers.
export type TokenKind = "name" | "number" | "odd" | "string" | "comment" | "sign" | "end";

export interface Token {
  /** `odd` starts like a number but cannot be changed as one: 0x1F, 12abc. `end` is the end of a statement. */
  kind: TokenKind;
  from: number;
  to: number;
  /** The number of open brackets before it. */
  depth: number;
}

const NAME = /[\p{L}_][\p{L}\p{N}_]*/uy;
const NUMBER = /(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?/y;
const WORD_GOES_ON = /[\p{L}\p{N}_.]+/uy;
const STRING_PREFIX = /^(?:[rbf]|br|rb)$/i;
const COMMENT = /#[^\n]*/y;

const matchEnd = (pattern: RegExp, text: string, from: number): number => {
  pattern.lastIndex = from;
  return pattern.test(text) ? pattern.lastIndex : from;
};

export function tokens(text: string): Token[] {
  const result: Token[] = [];
  let [from, depth] = [0, 0];
  const add = (kind: TokenKind, to: number) => {
    result.push({ kind, from, to, depth });
    from = to;
  };
  while (from < text.length) {
    const c = text[from]!;
    if (c === "\n") {
      // Inside brackets a statement goes on over the end of the line.
      if (depth === 0) add("end", from + 1);
      else from += 1;
    } else if (/\s/.test(c) || c === "\\") {
      // A backslash joins the next line.
      from += c === "\\" && text[from + 1] === "\n" ? 2 : 1;
    } else if (c === "#") {
      add("comment", matchEnd(COMMENT, text, from));
    } else if (c === '"' || c === "'") {
      add("string", stringEnd(text, from));
    } else if (matchEnd(NAME, text, from) > from) {
      const to = matchEnd(NAME, text, from);
      const isPrefix = (text[to] === '"' || text[to] === "'") && STRING_PREFIX.test(text.slice(from, to));
      if (isPrefix) add("string", stringEnd(text, to));
      else add("name", to);
    } else if (matchEnd(NUMBER, text, from) > from) {
      const to = matchEnd(NUMBER, text, from);
      const end = matchEnd(WORD_GOES_ON, text, to);
      add(end > to ? "odd" : "number", end);
    } else if ("([{".includes(c)) {
      add("sign", from + 1);
      depth += 1;
    } else if (")]}".includes(c)) {
      // Counted first: a closing bracket belongs to what is around the pair, as the opening one
      // does.
      depth = Math.max(0, depth - 1);
      add("sign", from + 1);
    } else {
      add("sign", from + 1);
    }
  }
  return result;
}

/** The end of the string whose quote is at `from`; an unfinished one ends with its line, or with the text. */
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

/** The token at a place: it starts before the place, and ends at or behind it. */
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
