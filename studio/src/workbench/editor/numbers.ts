// The numbers of a script: their places, and their values after steps. All arithmetic is on the written decimal digits, so
// that 0.30 keeps two decimals after any number of steps and rounding never shows.
import { type Token, tokens } from "./tokens";

export interface NumberPlace {
  from: number;
  /** A minus sign is part of it. */
  to: number;
}

/** Keywords after which a minus is a sign, not a difference. */
const BEFORE_OPERAND = new Set(["and", "or", "not", "in", "if", "elif", "else", "for", "return", "lambda", "while"]);

/** Whether a minus directly before a number is its sign, given the token before the minus. */
function isSign(text: string, before: Token | undefined): boolean {
  switch (before?.kind) {
    case undefined:
    case "end":
      return true;
    case "sign":
      return !")]}".includes(text[before.from]!);
    case "name":
      return BEFORE_OPERAND.has(text.slice(before.from, before.to));
    default:
      return false;
  }
}

export function numbersOf(text: string, allTokens: readonly Token[] = tokens(text)): NumberPlace[] {
  const significant = allTokens.filter(({ kind }) => kind !== "comment");
  return significant.flatMap((token, k): NumberPlace[] => {
    if (token.kind !== "number") return [];
    const minus = significant[k - 1];
    // A minus apart from its number, as in `- 5`, is left to the script: only one that touches it
    // is written as a sign.
    const isMinus = minus?.kind === "sign" && text[minus.from] === "-" && minus.to === token.from;
    return [{ from: isMinus && isSign(text, significant[k - 2]) ? minus.from : token.from, to: token.to }];
  });
}

/** The number at a place, its ends included. */
export function numberAt(numbers: readonly NumberPlace[], place: number): NumberPlace | undefined {
  return numbers.find(({ from, to }) => from <= place && place <= to);
}

/** A number in the form in which it is written: `digits` times ten to the power of -`decimals`, and the notation. */
interface Written {
  digits: bigint;
  decimals: number;
  /** As in 5. and 5.e3. */
  endsInPoint: boolean;
  /** As in .5. */
  startsWithPoint: boolean;
  exponent: string;
}

function read(literal: string): Written {
  const [, sign, whole, point, fraction, exponent] = /^(-?)(\d*)(\.?)(\d*)((?:[eE].*)?)$/.exec(literal)!;
  const size = BigInt(`0${whole}${fraction}`);
  return {
    digits: sign ? -size : size,
    decimals: fraction!.length,
    endsInPoint: point !== "" && fraction === "",
    startsWithPoint: whole === "",
    exponent: exponent!,
  };
}

function write({ digits, decimals, endsInPoint, startsWithPoint, exponent }: Written): string {
  // At least one digit stays before the point, as in 0.05.
  const size = String(digits < 0n ? -digits : digits).padStart(decimals + 1, "0");
  const whole = size.slice(0, size.length - decimals);
  const fraction = size.slice(size.length - decimals);
  const shown = startsWithPoint && whole === "0" && decimals > 0 ? "" : whole;
  return `${digits < 0n ? "-" : ""}${shown}${decimals > 0 || endsInPoint ? "." : ""}${fraction}${exponent}`;
}

/** The size of a step, in tenths of the last written digit. */
export const STEP = { fine: 1, plain: 10, coarse: 100 } as const;

/** The literal after a change by `tenths` of its last digit; it gets one more decimal only if necessary. */
export function stepped(literal: string, tenths: number): string {
  const written = read(literal);
  const digits = written.digits * 10n + BigInt(tenths);
  if (digits % 10n === 0n) return write({ ...written, digits: digits / 10n });
  return write({ ...written, digits, decimals: written.decimals + 1 });
}

/** The value of one step: for 5 it is 1, for 0.25 it is 0.01, for 2e-3 it is 0.001. */
export function stepOf(literal: string): number {
  const { decimals, exponent } = read(literal);
  return Number(`1e${Number(exponent.slice(1) || 0) - decimals}`);
}

/** Decimal digits that survive binary arithmetic, so that a slider's 0.1 + 0.2 is 0.3. */
const KEPT_DIGITS = 12;

/** A value in the form of a literal: with at least as many decimals, and no rounding noise. */
export function rewritten(literal: string, value: number): string {
  const short = String(Number(value.toPrecision(KEPT_DIGITS)));
  const { decimals, endsInPoint, exponent } = read(literal);
  if (exponent || short.includes("e")) return short;
  const [whole, fraction = ""] = short.split(".");
  const shown = fraction.padEnd(decimals, "0");
  return `${whole}${shown || endsInPoint ? "." : ""}${shown}`;
}

/** The text for a number's place, with a space if it would join the word before it, as `return-5` with 4 would. */
export function fitting(text: string, place: NumberPlace, literal: string): string {
  const isGlued = text[place.from] === "-" && !literal.startsWith("-") && /[\p{L}\p{N}_]/u.test(text[place.from - 1] ?? "");
  return isGlued ? ` ${literal}` : literal;
}
