// The properties of every part of the page, and numbers in the reader's language.
import { useMemo } from "preact/hooks";
import { Say } from "../exhibits/say";
import type { Controller } from "./controller";
import type { State } from "./state";
import type { Language, Texts } from "./texts";

export interface Page {
  words: Texts;
  say: Say;
  state: State;
  control: Controller | null;
  language: Language;
  /** Between the script and the picture: the part of the text to select, and where the reader put the cursor. */
  link?: { reveal: { from: number; to: number } | null; moved(place: number): void };
}

/** From four zeros after the point, or eight digits before it, a number is written with a power of ten. */
const [SMALLEST, LARGEST] = [1e-4, 1e7];

/** Numbers of any size: the proved error of a mesh may be its rounding alone. */
export class BenchSay extends Say {
  override number(value: number): string {
    const size = Math.abs(value);
    return size === 0 || !Number.isFinite(size) || (size >= SMALLEST && size < LARGEST) ? super.number(value) : power(value);
  }
}

/** 3.4·10⁻¹⁴ */
function power(value: number): string {
  const [digits, exponent] = value.toExponential(1).split("e");
  const raised = [...exponent!.replace("+", "")].map((c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(c)]!));
  return `${digits!.replace("-", "−")}·10${raised.join("")}`;
}

export const useWords = (language: Language): Say => useMemo(() => new BenchSay(language), [language]);
