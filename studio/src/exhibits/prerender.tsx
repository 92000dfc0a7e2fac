// Writes the pages as text with still figures at build time, for readers without script and until it runs.
import { renderToString } from "preact-render-to-string";
import type { Core } from "../core/module";
import { LESSON } from "../lesson/where";
import { Themes } from "../view/Themes";
import type { AnyExhibit } from "./exhibit";
import { Frame, Languages, Mark, Onward, titleOf } from "./Frame";
import { FRAME } from "./frame_texts";
import { EXHIBITS, type Entry, PARTS, STOPS, type Stop, WIDGET, fileOf, fileOfStop } from "./index";
import { Thumbnails } from "./Scene";
import { LANGUAGES, type Language, Say, TAGS } from "./say";

/** A page that was written: its file and its contents. */
export interface Written {
  file: string;
  /** The exhibit's id; empty for the list of exhibits. */
  id: string;
  lang: string;
  title: string;
  description: string;
  body: string;
}

const nothing = () => undefined;

/** The links from the widget to its neighbours, in both languages, because it switches language without loading a page. */
export const onwardFromWidget = () =>
  LANGUAGES.map((language) => renderToString(<Onward stop={WIDGET} language={language} />)).join("");

/** Every page of the exhibits, in both languages. */
export async function written(core: Core): Promise<Written[]> {
  const loaded = await Promise.all(EXHIBITS.map(async (entry) => ({ entry, exhibit: (await entry.load()).default })));
  const answers = loaded.map(({ entry, exhibit }) =>
    core.ask("exhibit", { exhibit: entry.id, ...exhibit.question(exhibit.defaults) }),
  );
  return LANGUAGES.flatMap((language) => [
    ...loaded.map(({ entry, exhibit }, i) => exhibitPage(entry, exhibit, answers[i], language)),
    listPage(loaded, answers, language),
  ]);
}

function exhibitPage(entry: Entry, exhibit: AnyExhibit, answer: unknown, language: Language): Written {
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

function listPage(loaded: { entry: Entry; exhibit: AnyExhibit }[], answers: unknown[], language: Language): Written {
  const words = FRAME[language];
  const parts = [...new Set(STOPS.map(({ part }) => part))];
  const picture = (stop: Stop) => {
    const i = loaded.findIndex(({ entry }) => entry === stop);
      if (i < 0) return <Widget />;
      const { exhibit } = loaded[i]!;
      const page = {
        state: exhibit.defaults,
        answer: answers[i],
        say: new Say(language),
        texts: exhibit.texts[language],
        set: nothing,
        isStill: true,
        isSmall: true,
      };
      return <exhibit.Figure page={page} />;
  };
  const cards = (part: Entry["part"]) =>
    STOPS.map((stop, i) =>
      stop.part !== part ? null : (
        <li key={fileOfStop(stop, language)}>
          <a href={fileOfStop(stop, language)}>
            <div class="thumb" aria-hidden="true">
              {picture(stop)}
            </div>
            <h3>
              <span class="place">{i + 1}</span> {titleOf(stop, language)}
            </h3>
            <p>{"id" in stop ? stop.claim[language] : words.widgetClaim}</p>
          </a>
        </li>
      ),
    );
  const page = (
    <div class="page exhibits">
      <header>
        <span class="brand">
          <Mark />
          Chordal
        </span>
        <a class="to-lesson" href={LESSON[language]}>
          {words.lesson}
        </a>
        <div class="wishes-of-page">
          <Languages language={language} file={(other) => fileOf("exhibits", other)} />
          <Themes language={language} />
        </div>
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
    body: inWholeUnits(renderToString(<Thumbnails.Provider value={true}>{page}</Thumbnails.Provider>)),
  };
}

/** Paths without digits behind the point: the pictures of the list are shown at a third of the size that they are made for. */
const inWholeUnits = (html: string) =>
  html.replace(/ d="[^"]*"/g, (path) => path.replace(/-?\d*\.\d+/g, (number) => String(Math.round(Number(number)))));

/** A simple drawing for the widget, whose own figure is in another module. */
function Widget() {
  return (
    <svg viewBox="0 0 360 240">
      <path class="curve" d="M40 200C120-40 180 10 330 150" />
      <path class="chain" d="M40 200L96 95L152 53L232 76L330 150" />
    </svg>
  );
}

export { Core } from "../core/module";
