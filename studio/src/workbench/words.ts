// What every part of the page is given, and numbers in the reader's language.
import { useMemo } from "preact/hooks";
import { Say } from "../exhibits/say";
import type { Controller, State } from "./controller";
import type { Language, Texts } from "./texts";

export interface Page {
  words: Texts;
  say: Say;
  state: State;
  control: Controller | null;
  language: Language;
}

export const useWords = (language: Language): Say => useMemo(() => new Say(language), [language]);
