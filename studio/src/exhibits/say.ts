// Numbers in the reader's language.
export type Language = "en" | "zh";
export const LANGUAGES: readonly Language[] = ["en", "zh"];
/** The value of `lang` for each language. */
export const TAGS: Record<Language, string> = { en: "en", zh: "zh-CN" };

/** What stands between words, and between sentences. */
const MARKS = {
  en: { comma: ", ", colon: ": ", stop: ". ", gap: " ", aside: (text: string) => ` (${text})` },
  zh: { comma: "，", colon: "：", stop: "。", gap: "", aside: (text: string) => `（${text}）` },
} as const;

export class Say {
  readonly marks: (typeof MARKS)[Language];
  private readonly short: Intl.NumberFormat;
  private readonly grouped: Intl.NumberFormat;
  private readonly share: Intl.NumberFormat;

  constructor(readonly language: Language) {
    const tag = TAGS[language];
    this.marks = MARKS[language];
    this.short = new Intl.NumberFormat(tag, { maximumSignificantDigits: 3, useGrouping: false });
    this.grouped = new Intl.NumberFormat(tag, { maximumFractionDigits: 0 });
    this.share = new Intl.NumberFormat(tag, { style: "percent", maximumFractionDigits: 0 });
  }

  /** Three significant digits, with a typographic minus. */
  number(value: number): string {
    // −0 would have a minus.
    return this.short.format(value === 0 ? 0 : value).replace("-", "−");
  }

  /** A fixed number of decimals. */
  fixed(value: number, digits = 2): string {
    // A negative number that rounds to 0 has no minus either.
    const text = (Math.abs(value) < 0.5 * 10 ** -digits ? 0 : value).toFixed(digits);
    return text.replace("-", "−");
  }

  whole(value: number): string {
    return this.grouped.format(value);
  }

  percent(share: number): string {
    return this.share.format(share);
  }

  degrees(value: number): string {
    return `${this.fixed(value, value !== 0 && Math.abs(value) < 10 ? 1 : 0)}°`;
  }

  /** With its unit: bytes below ten thousand, otherwise kilobytes. */
  bytes(value: number): string {
    if (value < 10_000) return this.language === "zh" ? `${this.whole(value)} 字节` : `${this.whole(value)} bytes`;
    return value < 1e6 ? `${this.number(value / 1e3)} kB` : `${this.number(value / 1e6)} MB`;
  }
}
