// Writes the lesson's pages as text with still figures at build time, for readers without script and until it runs.
import { createHash } from "node:crypto";
import { renderToString } from "preact-render-to-string";
import type { Core } from "../core/module";
import type { Written } from "../exhibits/prerender";
import { fileOf } from "../exhibits/index";
import { type Language, TAGS } from "../exhibits/say";
import { answerOf, type Ask, factsOf } from "./facts";
import { loaded } from "./figures";
import { LessonPage, type Still } from "./LessonPage";
import { LESSONS } from "./languages";
import { BLOCKS } from "./outline";
import { lighter, type StillFile } from "./stills";
import { packed } from "./teapot_levels";

const files: Record<string, string> = import.meta.glob("./code/*", { query: "?raw", import: "default", eager: true });
const code = new Map(Object.entries(files).map(([path, text]) => [path.replace("./code/", ""), text]));

interface Lessons {
  pages: Written[];
  /** The first picture's file, and those of stills. */
  teapot: StillFile;
  stills: StillFile[];
}

/** The lesson in both languages. */
export async function lessons(core: Core): Promise<Lessons> {
  const ask: Ask = (question) => core.ask("exhibit", question);
  const facts = await factsOf(ask);
  const stills = new Map<string, Still>();
  for (const { figure, state } of BLOCKS) {
    if (!figure) continue;
    const exhibit = await loaded(figure);
    stills.set(figure, { exhibit, state: { ...(exhibit.defaults as object), ...state }, answer: await answerOf(ask, figure, state) });
  }
  const bytes = packed(facts.hero);
  // With its contents in its name, as all assets.
  const teapot = { file: `assets/teapot-${createHash("sha256").update(bytes).digest("hex").slice(0, 8)}.bin`, bytes };
  const files: StillFile[] = [];
  const pages = Object.entries(LESSONS).map(([name, text]) => {
    const language = name as Language;
    const html = renderToString(
      <LessonPage
        language={language}
        text={text}
        facts={facts}
        stills={stills}
        code={code}
        teapot={teapot.file}
      />,
    );
    // The first picture stays in the page.
    const body = html.replace(/<figure.*?<\/figure>/gs, (figure) => {
      const light = lighter(figure);
      files.push(...light.files);
      return light.html;
    });
    return {
      file: fileOf("lesson", language),
      id: "lesson",
      lang: TAGS[language],
      title: text.title,
      description: text.description,
      body,
    };
  });
  return { pages, teapot, stills: files };
}

export { lighter } from "./stills";
