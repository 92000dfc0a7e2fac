// Writes the pages as text and still figures, at build time: what a reader has before any script runs, or without it.
import { renderToString } from "preact-render-to-string";
import type { Core } from "../core/module";
import type { AnyExhibit } from "./exhibit";
import { Frame, Languages, Mark } from "./Frame";
import { FRAME } from "./frame_texts";
import { EXHIBITS, type Entry, PARTS, fileOf } from "./index";
import { LANGUAGES, type Language, Say, TAGS } from "./say";

/** A page: its file, and what stands in it. */
export interface Written {
  file: string;
  /** Of the exhibit; empty for the list of all. */
  id: string;
  lang: string;
  title: string;
  description: string;
  body: string;
}

const nothing = () => undefined;

/** Every page of the exhibits, in both languages. */
export async function written(core: Core): Promise<Written[]> {
  const all = await Promise.all(EXHIBITS.map(async (entry) => ({ entry, exhibit: (await entry.load()).default })));
  const answers = all.map(({ entry, exhibit }) =>
    core.ask("exhibit", { exhibit: entry.id, ...exhibit.question(exhibit.defaults) }),
  );
  return LANGUAGES.flatMap((language) => [
    ...all.map(({ entry, exhibit }, i) => one(entry, exhibit, answers[i], language)),
    list(all, answers, language),
  ]);
}

function one(entry: Entry, exhibit: AnyExhibit, answer: unknown, language: Language): Written {
  const frame = (
    <Frame
      entry={entry}
      exhibit={exhibit}
      state={exhibit.defaults as object}
      answer={answer}
      language={language}
      fragment=""
      isStill
      isEmbedded={false}
      notes={[]}
      set={nothing}
    />
  );
  return {
    file: fileOf(entry.id, language),
    id: entry.id,
    lang: TAGS[language],
    title: `${entry.title[language]} · Chordal`,
    description: entry.claim[language],
    body: renderToString(frame),
  };
}

function list(all: { entry: Entry; exhibit: AnyExhibit }[], answers: unknown[], language: Language): Written {
  const words = FRAME[language];
  const parts = [...new Set(all.map(({ entry }) => entry.part))];
  const cards = (part: Entry["part"]) =>
    all.map(({ entry, exhibit }, i) => {
      if (entry.part !== part) return null;
      const page = {
        state: exhibit.defaults,
        answer: answers[i],
        say: new Say(language),
        texts: exhibit.texts[language],
        set: nothing,
        isStill: true,
        isSmall: true,
      };
      return (
        <li key={entry.id}>
          <a href={fileOf(entry.id, language)}>
            <div class="thumb" aria-hidden="true">
              <exhibit.Figure page={page} />
            </div>
            <h3>
              <span class="place">{i + 1}</span> {entry.title[language]}
            </h3>
            <p>{entry.claim[language]}</p>
          </a>
        </li>
      );
    });
  const page = (
    <div class="page exhibits">
      <header>
        <span class="brand">
          <Mark />
          Chordal
        </span>
        <Languages language={language} file={(other) => fileOf("exhibits", other)} />
      </header>
      <main>
        <h1>{words.all}</h1>
        <p class="lead">{words.lead}</p>
        {parts.map((part) => (
          <section key={part}>
            <h2>
              <small>{words.part(part)}</small> {PARTS[part][language]}
            </h2>
            <ul class="cards">{cards(part)}</ul>
          </section>
        ))}
        <section>
          <h2>
            <small>{words.part(3)}</small> {PARTS[3][language]}
          </h2>
          <ul class="cards">
            <li>
              <a href={language === "en" ? "index.html" : `${language}.html`}>
                <div class="thumb" aria-hidden="true">
                  <svg viewBox="0 0 360 240">
                    <path class="curve" d="M40 200C120-40 180 10 330 150" />
                    <path class="chain" d="M40 200L96 95L152 53L232 76L330 150" />
                  </svg>
                </div>
                <h3>{words.widget}</h3>
                <p>{words.widgetClaim}</p>
              </a>
            </li>
          </ul>
        </section>
      </main>
      <footer>
        <p>{words.footer}</p>
      </footer>
    </div>
  );
  return {
    file: fileOf("exhibits", language),
    id: "",
    lang: TAGS[language],
    title: words.all,
    description: words.lead,
    body: renderToString(page),
  };
}

export { Core } from "../core/module";
