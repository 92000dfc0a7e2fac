// Texts and numbers in the reader's language.
import type { Language } from "../state/state";
import { en, type Catalogue, type Key } from "./en";
import { zh } from "./zh";

export const CATALOGUES: Record<Language, Catalogue> = { en, zh };
/** The value of `lang` for each language. */
export const TAGS: Record<Language, string> = { en: "en", zh: "zh-CN" };

export type Values = Record<string, string | number>;

export class Speaker {
  private readonly catalogue: Catalogue;
  private readonly plural: Intl.PluralRules;
  private readonly short: Intl.NumberFormat;
  private readonly fixed: Intl.NumberFormat;
  private readonly percentage: Intl.NumberFormat;
  private readonly factor: Intl.NumberFormat;
  private readonly withSign: Intl.NumberFormat;

  constructor(readonly language: Language) {
    const tag = TAGS[language];
    this.catalogue = CATALOGUES[language];
    this.plural = new Intl.PluralRules(tag);
    this.short = new Intl.NumberFormat(tag, { maximumSignificantDigits: 3, useGrouping: false });
    this.fixed = new Intl.NumberFormat(tag, { minimumFractionDigits: 2, maximumFractionDigits: 2, useGrouping: false });
    this.factor = new Intl.NumberFormat(tag, { minimumFractionDigits: 1, maximumFractionDigits: 1, useGrouping: false });
    this.withSign = new Intl.NumberFormat(tag, { maximumSignificantDigits: 3, useGrouping: false, signDisplay: "exceptZero" });
    this.percentage = new Intl.NumberFormat(tag, { style: "percent", maximumFractionDigits: 0 });
  }

  /** The text with its placeholders filled in. */
  text(key: Key, values: Values = {}): string {
    return fill(this.catalogue[key], values);
  }

  /** Three significant digits. Zero is "0", and a value below a ten-thousandth is written with a power of ten. */
  number(value: number): string {
    if (value !== 0 && Math.abs(value) < 1e-4) return power(value);
    return this.short.format(value);
  }

  /** A ratio with one decimal, so that exactly 4 is shown as 4.0. */
  times(value: number): string {
    return this.factor.format(value);
  }

  /** With its sign, also a plus. */
  signed(value: number): string {
    return this.withSign.format(value).replace("-", "−");
  }

  /** A coordinate: two decimals, as on the grid. */
  coordinate(value: number): string {
    return this.fixed.format(value);
  }

  percent(share: number): string {
    return this.percentage.format(share);
  }

  segments(n: number): string {
    return this.counted("segments", n, String(n));
  }

  pixels(value: number): string {
    return this.counted("pixels", value, this.number(value));
  }

  units(value: number): string {
    return this.counted("units", value, this.number(value));
  }

  /** The plural form follows the formatted number: 1.0004 is formatted as 1 and is "1 pixel". */
  private counted(noun: "segments" | "pixels" | "units", value: number, shown: string): string {
    const form = shown === "1" && this.plural.select(Math.round(value)) === "one" ? "one" : "other";
    return this.text(`${noun}.${form}`, { n: shown });
  }
}

/** 1.2·10⁻⁶ */
function power(value: number): string {
  const [digits, exponent] = value.toExponential(1).split("e");
  const raised = [...exponent!.replace("+", "")].map((c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(c)]!));
  return `${digits}·10${raised.join("")}`;
}

export function fill(text: string, values: Values): string {
  return text.replace(/\{(\w+)\}/g, (place, name: string) => (name in values ? String(values[name]) : place));
}

/** The language for a reader who has not chosen one. */
export function preferred(languages: readonly string[]): Language {
  for (const tag of languages) {
    if (/^zh\b/i.test(tag)) return "zh";
    if (/^en\b/i.test(tag)) return "en";
  }
  return "en";
}
