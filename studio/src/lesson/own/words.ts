// The words by which a reader brings a shape along: the only ones of it that are in the page before it is asked for.
import type { Language } from "../../exhibits/say";

export const BRING: Record<Language, string> = {
  en: "Bring your own shape",
  zh: "带上你自己的形状",
};
