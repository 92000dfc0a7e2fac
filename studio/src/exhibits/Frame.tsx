// The frame of every exhibit: title and claim, figure and handle, the live number, the texts, links to the other stops.
import { Clauses } from "../view/Clauses";
import { Figure as Data } from "../view/parts";
import { LESSON } from "../lesson/where";
import { Hint } from "../view/Hint";
import { Themes } from "../view/Themes";
import type { AnyExhibit, LiveNumber, Page } from "./exhibit";
import { type Entry, PARTS, STOPS, type Stop, WIDGET, fileOf, fileOfStop } from "./index";
import { FRAME } from "./frame_texts";
import { LANGUAGES, type Language, Say, TAGS } from "./say";

export interface FrameProps {
  entry: Entry;
  exhibit: AnyExhibit;
  state: object;
  answer: unknown;
  language: Language;
  /** The fragment of the state, without `#`; the link to the other language has it, too. */
  fragment: string;
  isStill: boolean;
  isEmbedded: boolean;
  notes: readonly string[];
  set: Page<object, unknown, unknown>["set"];
}

/** Paragraphs that are open at first. Chosen: with them all stops take half an hour to read; the rest is on demand. */
const FIRST_READ = 1;

const paragraphs = (story: readonly string[]) => story.map((text) => <p key={text}>{emphasized(text)}</p>);

export function Frame(props: FrameProps) {
  const { entry, exhibit, language, isStill, isEmbedded, notes } = props;
  const say = new Say(language);
  const texts = exhibit.texts[language];
  const words = FRAME[language];
  const page = { state: props.state, answer: props.answer, say, texts, set: props.set, isStill, isSmall: false };
  const number: LiveNumber = exhibit.number(page);
  return (
    <div class={`page exhibit${isEmbedded ? " embedded" : ""}`}>
      {!isEmbedded && (
        <>
          <a class="skip" href="#figure" onClick={jump}>
            {words.skip}
          </a>
          <Head {...props} />
        </>
      )}
      <main>
        <p class="kicker">
          {words.part(entry.part)} · {PARTS[entry.part][language]}
        </p>
        <h1>
          <Clauses text={entry.claim[language]} />
        </h1>
        <div class="notes">
          {notes.map((note) => (
            <p class="note" role="alert" key={note}>
              {note}
            </p>
          ))}
        </div>
        <div class="bench">
          <div class="wide">
            <div class="stage" id="figure" tabindex={-1}>
              <exhibit.Figure page={page} />
              <p class="aside hint" id="hint">
                {isStill ? words.still : <Hint text={texts.hint} />}
              </p>
            </div>
            {!isEmbedded && (
              <div class="prose">
                {paragraphs(texts.story.slice(0, FIRST_READ))}
                {texts.story.length > FIRST_READ && (
                  <details>
                    <summary>{words.more}</summary>
                    {paragraphs(texts.story.slice(FIRST_READ))}
                  </details>
                )}
              </div>
            )}
          </div>
          <div class="narrow">
            <div class="panel">
              <div class={`live ${number.tone}`}>
                <h2>{number.label}</h2>
                <p class="big">
                  <Data name="live" value={number.value}>
                    {number.shown}
                  </Data>
                </p>
                <p class="meaning">{number.meaning}</p>
              </div>
              <exhibit.Panel page={page} />
            </div>
            {!isEmbedded && (
              <aside class="attempts">
                <h2>{words.attempts}</h2>
                <ul>
                  {texts.attempts.map((text: string) => (
                    <li key={text}>{emphasized(text)}</li>
                  ))}
                </ul>
              </aside>
            )}
          </div>
        </div>
      </main>
      {!isEmbedded && (
        <>
          <Path {...props} />
          <Onward stop={entry} language={language} />
          <footer>
            <p>{words.footer}</p>
          </footer>
        </>
      )}
    </div>
  );
}

function Head({ entry, language, fragment }: FrameProps) {
  const words = FRAME[language];
  return (
    <header>
      <a class="brand" href={fileOf("exhibits", language)}>
        <Mark />
        {words.all}
      </a>
      <a class="to-lesson" href={LESSON[language]}>
        {words.lesson}
      </a>
      <div class="wishes-of-page">
        <Languages language={language} file={(other) => fileOf(entry.id, other) + (fragment && `#${fragment}`)} />
        <Themes language={language} />
      </div>
    </header>
  );
}

/** The tour: its five parts, and the stops of this one. It is seen above the figure, and follows it for keys and ears. */
function Path({ entry, language }: FrameProps) {
  const words = FRAME[language];
  return (
    <nav class="path" aria-label={words.path}>
      <ol class="moves-of-tour">
        {[...new Set(STOPS.map(({ part }) => part))].map((part) => (
          <li key={part}>
            <a
              href={fileOfStop(STOPS.find((stop) => stop.part === part)!, language)}
              {...(part === entry.part ? { "aria-current": "true" as const } : {})}
            >
              {PARTS[part][language]}
            </a>
          </li>
        ))}
      </ol>
      {/* Of this part alone: 37 of them would be a page of links before each page. */}
      <ol class="stops" aria-label={PARTS[entry.part][language]}>
        {STOPS.filter((stop) => stop.part === entry.part).map((stop) => (
          <li key={fileOfStop(stop, language)}>
            <a href={fileOfStop(stop, language)} {...(stop === entry ? { "aria-current": "page" as const } : {})}>
              {titleOf(stop, language)}
            </a>
          </li>
        ))}
      </ol>
    </nav>
  );
}

export function Languages({ language, file }: { language: Language; file: (language: Language) => string }) {
  const names: Record<Language, string> = { en: "English", zh: "中文" };
  return (
    <nav class="language" aria-label={FRAME[language].language}>
      {LANGUAGES.map((other) => (
        <a
          key={other}
          href={file(other)}
          lang={TAGS[other]}
          hreflang={TAGS[other]}
          {...(other === language ? { "aria-current": "true" as const } : {})}
        >
          {names[other]}
        </a>
      ))}
    </nav>
  );
}

/** The title of a stop. */
export const titleOf = (stop: Stop, language: Language) => ("id" in stop ? stop.title[language] : FRAME[language].widget);

/** Links to the previous and the next stop, with their language: the first page contains both languages. */
export function Onward({ stop, language }: { stop: Stop; language: Language }) {
  const words = FRAME[language];
  const n = STOPS.indexOf(stop);
  const [before, after] = [STOPS[n - 1], STOPS[n + 1]];
  return (
    <nav class="onward" aria-label={words.onward} lang={TAGS[language]}>
      {before ? (
        <a rel="prev" href={fileOfStop(before, language)}>
          <small>← {words.previous}</small>
          {titleOf(before, language)}
        </a>
      ) : (
        <a href={fileOf("exhibits", language)}>
          <small>← {words.back}</small>
          {words.all}
        </a>
      )}
      {after ? (
        <a rel="next" href={fileOfStop(after, language)}>
          <small>{words.next} →</small>
          {titleOf(after, language)}
        </a>
      ) : (
        <a rel="next" href={fileOf("exhibits", language)}>
          <small>{words.next} →</small>
          {words.all}
        </a>
      )}
      {stop === WIDGET && (
        <a class="to-all" href={fileOf("exhibits", language)}>
          {words.tour(STOPS.length)}
        </a>
      )}
      <a class="to-bench" href={language === "en" ? "workbench.html" : `workbench.${language}.html`}>
        {words.bench}
      </a>
    </nav>
  );
}

export function Mark() {
  return (
    <svg width="34" height="20" viewBox="0 0 34 20" aria-hidden="true">
      <path class="mark-curve" d="M2 17C7-3 27-3 32 17" />
      <path class="mark-chain" d="M2 17L9.5 6L17 2.5L24.5 6L32 17" />
    </svg>
  );
}

/** Emphasizes `*word*`. */
function emphasized(text: string) {
  return text.split("*").map((part, i) => (i % 2 ? <em key={i}>{part}</em> : part));
}

/** Moves the focus to the figure by script, because the fragment of the address holds the state. */
export function jump(event: Event) {
  event.preventDefault();
  document.getElementById("figure")?.focus();
}
