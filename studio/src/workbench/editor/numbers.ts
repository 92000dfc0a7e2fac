// The numbers of a script: where they stand, and what they become a step further. All in the digits as they are written,
// so that 0.30 has two decimals after any number of steps and no rounding ever shows.
import { type Token, tokens } from "./tokens";

export interface NumberPlace {
  from: number;
  /** A minus that belongs to it is part of it. */
  to: number;
}

/** Words after which a minus is a sign and not a difference. */
const BEFORE_OPERAND = new Set(["and", "or", "not", "in", "if", "elif", "else", "for", "return", "lambda", "while"]);

/** Whether a minus that stands right before a number is its sign, given what comes before the minus. */
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

export function numbersOf(text: string, all: readonly Token[] = tokens(text)): NumberPlace[] {
  const spoken = all.filter(({ kind }) => kind !== "comment");
  return spoken.flatMap((token, k): NumberPlace[] => {
    if (token.kind !== "number") return [];
    const minus = spoken[k - 1];
    const isMinus = minus?.kind === "sign" && text[minus.from] === "-" && minus.to === token.from;
    return [{ from: isMinus && isSign(text, spoken[k - 2]) ? minus.from : token.from, to: token.to }];
  });
}

/** The number at a place, its ends included. */
export function numberAt(numbers: readonly NumberPlace[], place: number): NumberPlace | undefined {
  return numbers.find(({ from, to }) => from <= place && place <= to);
}

/** A number as it is written: `digits` times ten to the power of -`decimals`, and what stands around that. */
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
  const size = String(digits < 0n ? -digits : digits).padStart(decimals + 1, "0");
  const whole = size.slice(0, size.length - decimals);
  const fraction = size.slice(size.length - decimals);
  const shown = startsWithPoint && whole === "0" && decimals > 0 ? "" : whole;
  return `${digits < 0n ? "-" : ""}${shown}${decimals > 0 || endsInPoint ? "." : ""}${fraction}${exponent}`;
}

/** What a step is worth, in tenths of the last digit that is written. */
export const STEP = { fine: 1, plain: 10, coarse: 100 } as const;

/** The literal so many tenths of its last digit further; one more decimal only where the tenths need it. */
export function stepped(literal: string, tenths: number): string {
  const written = read(literal);
  const digits = written.digits * 10n + BigInt(tenths);
  if (digits % 10n === 0n) return write({ ...written, digits: digits / 10n });
  return write({ ...written, digits, decimals: written.decimals + 1 });
}

/** The value of one step: of 5 it is 1, of 0.25 it is 0.01, of 2e-3 it is 0.001. */
export function stepOf(literal: string): number {
  const { decimals, exponent } = read(literal);
  return Number(`1e${Number(exponent.slice(1) || 0) - decimals}`);
}

/** Digits that a binary number keeps of a decimal one: a slider's 0.1 + 0.2 is 0.3. */
const KEPT_DIGITS = 12;

/** A value in the form of a literal: at least as many decimals, and no rounding noise. */
export function rewritten(literal: string, value: number): string {
  const short = String(Number(value.toPrecision(KEPT_DIGITS)));
  const { decimals, endsInPoint, exponent } = read(literal);
  if (exponent || short.includes("e")) return short;
  const [whole, fraction = ""] = short.split(".");
  const shown = fraction.padEnd(decimals, "0");
  return `${whole}${shown || endsInPoint ? "." : ""}${shown}`;
}

/** A text for the place of a number that runs into no word before it, as `return-5` with 4 would. */
export function fitting(text: string, place: NumberPlace, literal: string): string {
  const isGlued = text[place.from] === "-" && !literal.startsWith("-") && /[\p{L}\p{N}_]/u.test(text[place.from - 1] ?? "");
  return isGlued ? ` ${literal}` : literal;
}
