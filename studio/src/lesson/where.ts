// The files of the lesson, for links from other pages, which load nothing else of it.
import type { Language } from "../exhibits/say";

/** The Chinese one is `lesson.zh.html` once languages.ts has its texts. */
export const LESSON: Record<Language, string> = { en: "lesson.html", zh: "lesson.html" };
