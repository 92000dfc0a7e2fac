// The lesson's texts, by language.
import type { Language } from "../exhibits/say";
import { EN } from "./en";
import type { LessonText } from "./lesson";
import { ZH } from "./zh";

export const LESSONS: Record<Language, LessonText> = { en: EN, zh: ZH };
