// Writes the pages of the workbench as text at build time, for readers without script and until the command is loaded.
import { renderToString } from "preact-render-to-string";
import { Jobs } from "../core/jobs";
import type { Written } from "../exhibits/prerender";
import { TAGS } from "../exhibits/say";
import { App } from "./App";
import { Controller } from "./controller";
import { example } from "./examples";
import { type Language, TEXTS } from "./texts";

const never = () => {
  throw new Error("nothing runs while pages are written");
};

export function workbenches(): Written[] {
  const { state } = new Controller(new Jobs(never, never), example("bracket"), () => undefined);
  return (["en", "zh"] as const).map((language: Language) => ({
    file: language === "en" ? "workbench.html" : `workbench.${language}.html`,
    id: "",
    lang: TAGS[language],
    title: `${TEXTS[language].title} · Chordal`,
    description: TEXTS[language].lead,
    body: renderToString(<App language={language} state={state} control={null} />),
  }));
}

// For the picture that the build draws.
export { run } from "../core/command";
