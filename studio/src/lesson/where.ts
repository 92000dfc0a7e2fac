// The files of the lesson, for links from other pages, which load nothing else of it.
import type { Language } from "../exhibits/say";

export const LESSON: Record<Language, string> = { en: "lesson.html", zh: "lesson.zh.html" };
