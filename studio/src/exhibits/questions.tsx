// The six questions at the end. A card turns after the reader has chosen or written an answer, and shows the initial number of
// its exhibit. Without script each card is a fold.
import { Clauses } from "../view/Clauses";
import { Figure as Data } from "../view/parts";
import culling from "./culling";
import { type AnyExhibit, type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import field from "./field";
import { words } from "./fragment";
import { EXHIBITS, fileOf } from "./index";
import joins from "./joins";
import normals from "./normals";
import overshade from "./overshade";
import quad from "./quad";
import { QUESTIONS, type Question, texts } from "./questions_texts";
import type { Language } from "./say";

interface State {
  /** The cards that were turned, in that order. */
  turned: readonly Question[];
  /** What the reader chose, by its number, or wrote. Not in the address: it is nobody else's. */
  said: Partial<Record<Question, number | string>>;
}

/** The core's answer for the initial state of each exhibit, by its name, without data that is only drawn. */
type Answer = Record<string, unknown>;

const defaults: State = { turned: [], said: {} };

export interface Texts extends CommonTexts {
  figure: string;
  questions: Record<Question, string>;
  /** Guesses, of which one is right. */
  guesses: Record<Question, { readonly all: readonly [string, string, string]; readonly right: number }>;
  guess: string;
  write: string;
  turn: string;
  /** Above the answer: what the reader said. */
  right: string;
  wrong(choice: string): string;
  wrote(text: string): string;
  answers: Record<Question, string>;
  see: string;
  widget: string;
  label: string;
  of(n: string, all: string): string;
  /** Below the count of turned cards: none, some, all. */
  none: string;
  some: string;
  all: string;
  again: string;
}

type Page = PageOf<State, Answer, Texts>;

/** The exhibits that answer each question, best first. The number is that of the first. */
const SHOWN: Record<Question, readonly [string, ...string[]]> = {
  triangles: ["quad", "inside", "weights"],
  normals: ["normals"],
  winding: ["culling", "doctor"],
  joins: ["joins", "runge", "bernstein"],
  fields: ["field", "csg", "tracing", "squares", "baking"],
  cost: ["overshade", "levels", "budget"],
};

/** The first exhibit of each question. */
const FIRST: Record<Question, AnyExhibit> = { triangles: quad, normals, winding: culling, joins, fields: field, cost: overshade };

/** The question of an exhibit in its initial state. */
const initialQuestion = (question: Question) => ({
  exhibit: SHOWN[question][0],
  ...FIRST[question].question(FIRST[question].defaults),
});

/** The number of an exhibit in its initial state. */
function numberOf(question: Question, { answer, say, set, isStill, isSmall }: Page): LiveNumber {
  const first = FIRST[question];
  const firstPage = { state: first.defaults, answer: answer[SHOWN[question][0]], texts: first.texts[say.language] };
  return first.number({ ...firstPage, say, set, isStill, isSmall });
}

/** A small picture for each question, 220 by 145. */
const PICTURES: Record<Question, readonly (readonly [kind: string, d: string])[]> = {
  triangles: [
    ["face", "M20 110L78 30L108 100z"],
    ["face", "M128 112L140 50L196 34L184 104z"],
    ["fold", "M128 112L196 34"],
    ["lost", "M140 50L184 104"],
  ],
  normals: [
    ["face", "M60 52L112 34L160 52L108 74zM60 52L108 74V126L60 104zM160 52V104L108 126V74z"],
    ["lost", "M108 74V44M108 74L84 92M108 74L134 92"],
  ],
  winding: [
    ["face", "M40 112L110 28L180 112z"],
    ["fold", "M92 96A22 22 0 1 0 90 78M80 86L90 77L99 88"],
  ],
  joins: [
    ["fold", "M24 108C52 30 88 30 110 74"],
    ["lost", "M110 74C132 118 168 118 196 40"],
  ],
  fields: [
    ["face", "M110 30A44 44 0 1 1 109.9 30z"],
    ["fold", "M110 50A24 24 0 1 1 109.9 50z"],
    ["lost", "M72 52L110 30L148 52V96L110 118L72 96z"],
  ],
  cost: [
    ["face", "M40 30H110V65H40zM110 65H180V100H110z"],
    ["fold", "M40 30H180V100H40zM110 30V100M40 65H180"],
    ["lost", "M40 100L75 30L110 100L145 30L180 100"],
  ],
};

const Drawing = ({ question }: { question: Question }) => (
  <svg class="six" viewBox="10 20 200 115" aria-hidden="true">
    {PICTURES[question].map(([kind, d]) => (
      <path key={d} class={kind} d={d} />
    ))}
  </svg>
);

function Figure({ page }: { page: Page }) {
  if (page.isSmall) return <Thumbnail />;
  const { texts, isStill, state } = page;
  return (
    <ol class="questions" data-figure aria-label={texts.figure}>
      {QUESTIONS.map((question, i) => {
        // Its number may still be on the way.
        const isTurned = state.turned.includes(question) && SHOWN[question][0] in page.answer;
        const front = (
          <>
            <Drawing question={question} />
            <b>
              <Clauses text={`${i + 1}. ${texts.questions[question]}`} />
            </b>
          </>
        );
        return (
          <li key={question} class={isTurned ? "turned" : ""} data-question={question}>
            {isStill ? (
              <details>
                <summary>{front}</summary>
                <Back page={page} question={question} />
              </details>
            ) : (
              <>
                <h2>{front}</h2>
                {isTurned ? <Back page={page} question={question} /> : <Front page={page} question={question} />}
              </>
            )}
          </li>
        );
      })}
    </ol>
  );
}

/** The six pictures for the list of exhibits, without an answer. */
const Thumbnail = () => (
  <svg class="flat six" viewBox="0 0 720 480">
    {QUESTIONS.map((question, i) => (
      <g key={question} class="card" transform={`translate(${20 + 230 * (i % 3)} ${24 + 220 * Math.floor(i / 3)})`}>
        <rect width="220" height="208" rx="12" />
        {PICTURES[question].map(([kind, d]) => (
          <path key={d} class={kind} d={d} transform="translate(0 30)" />
        ))}
      </g>
    ))}
  </svg>
);

/** The shortest text that counts as an answer. */
const SHORTEST = 3;

/** The side with the question: it turns only after the reader has chosen or written something. */
function Front({ page, question }: { page: Page; question: Question }) {
  const { state, texts, set } = page;
  const said = state.said[question];
  const say = (value: number | string) => set(({ said }) => ({ said: { ...said, [question]: value } }));
  const isTurning = state.turned.includes(question);
  const isSaid = typeof said === "number" || (said?.trim().length ?? 0) >= SHORTEST;
  return (
    <>
      <fieldset class="guesses">
        <legend>{texts.guess}</legend>
        {texts.guesses[question].all.map((guess, k) => (
          <label key={k}>
            <input type="radio" name={`guess-${question}`} value={k} checked={said === k} onChange={() => say(k)} />
            {guess}
          </label>
        ))}
      </fieldset>
      <label class="write">
        {texts.write}
        <textarea rows={2} maxLength={600} value={typeof said === "string" ? said : ""} onInput={(event) => say(event.currentTarget.value)} />
      </label>
      <button type="button" disabled={!isSaid || isTurning} aria-busy={isTurning} onClick={() => set(({ turned }) => ({ turned: [...turned, question] }))}>
        {texts.turn}
      </button>
    </>
  );
}

/** The side with the number and the answer. */
function Back({ page, question }: { page: Page; question: Question }) {
  const { state, texts, say } = page;
  const { label, value, shown } = numberOf(question, page);
  const { all, right } = texts.guesses[question];
  const said = state.said[question];
  const seen = SHOWN[question].flatMap((id) => EXHIBITS.find((entry) => entry.id === id) ?? []);
  const language: Language = say.language;
  return (
    <div class="back" role="status">
      {said !== undefined && (
        <p class="aside">{typeof said === "string" ? texts.wrote(said.trim()) : said === right ? texts.right : texts.wrong(all[said]!)}</p>
      )}
      <p>{texts.answers[question]}</p>
      <p class="number-of">
        <Data name={`card-${question}`} value={value}>
          {shown}
        </Data>{" "}
        <span>{label}</span>
      </p>
      <p class="seen">
        {texts.see}{" "}
        {seen.map((entry) => (
          <a key={entry.id} href={fileOf(entry.id, language)}>
            {entry.title[language]}
          </a>
        ))}
        {question === "joins" && <a href={`${language === "en" ? "index" : language}.html#v=1&w=s`}>{texts.widget}</a>}
      </p>
    </div>
  );
}

function liveNumber({ state, texts, say }: Page): LiveNumber {
  const n = state.turned.length;
  return {
    value: n,
    shown: texts.of(say.whole(n), say.whole(QUESTIONS.length)),
    label: texts.label,
    meaning: n === 0 ? texts.none : n < QUESTIONS.length ? texts.some : texts.all,
    tone: n === QUESTIONS.length ? "good" : "plain",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, texts, set } = page;
  return state.turned.length > 0 ? (
    <button type="button" onClick={() => set({ turned: [], said: {} })}>
      {texts.again}
    </button>
  ) : null;
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: { turned: ["n", words(QUESTIONS, QUESTIONS.length)] },
  question: () => ({ asked: QUESTIONS.map(initialQuestion) }),
  // The core is loaded while the reader chooses or writes a first answer.
  isIdle: ({ turned, said }) => turned.length === 0 && Object.keys(said).length === 0,
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
