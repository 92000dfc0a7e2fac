// The six questions at the end, each with the initial number of its exhibit.
import { Choice } from "../view/parts";
import culling from "./culling";
import { type AnyExhibit, type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import field from "./field";
import { word } from "./fragment";
import { EXHIBITS, fileOf } from "./index";
import joins from "./joins";
import normals from "./normals";
import overshade from "./overshade";
import quad from "./quad";
import { QUESTIONS, type Question, texts } from "./questions_texts";
import type { Language } from "./say";

interface State {
  question: Question;
}

/** The core's answer for the initial state of each exhibit, by its name, without data that is only drawn. */
type Answer = Record<string, unknown>;

const defaults: State = { question: "triangles" };

export interface Texts extends CommonTexts {
  figure: string;
  choose: string;
  questions: Record<Question, string>;
  short: Record<Question, string>;
  answers: Record<Question, string>;
  see: string;
  widget: string;
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

/** A small picture for each question, in a card of 220 by 200. */
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

function Figure({ page }: { page: Page }) {
  const { state, texts } = page;
  return (
    <svg class="flat six" data-figure viewBox="0 0 720 480" role="group" aria-label={texts.figure}>
      {QUESTIONS.map((question, i) => (
        <g
          key={question}
          class={question === state.question ? "card chosen" : "card"}
          transform={`translate(${20 + 230 * (i % 3)} ${24 + 220 * Math.floor(i / 3)})`}
          {...(page.isStill ? {} : { onClick: () => page.set({ question }) })}
        >
          <rect width="220" height="208" rx="12" />
          {PICTURES[question].map(([kind, d]) => (
            <path key={d} class={kind} d={d} />
          ))}
          <Shown text={numberOf(question, page).shown} />
          <text x="110" y="192">
            {i + 1} · {texts.short[question]}
          </text>
        </g>
      ))}
    </svg>
  );
}

/** A number; more than six characters get a smaller font. */
const Shown = ({ text }: { text: string }) => (
  <text class={text.length > 6 ? "big long" : "big"} x="110" y="164">
    {text}
  </text>
);

function liveNumber(page: Page): LiveNumber {
  const { question } = page.state;
  return { ...numberOf(question, page), meaning: page.texts.answers[question], tone: "plain" };
}

function Panel({ page }: { page: Page }) {
  const { state, texts, say, set } = page;
  const seen = SHOWN[state.question].flatMap((id) => EXHIBITS.find((entry) => entry.id === id) ?? []);
  const language: Language = say.language;
  return (
    <>
      <Choice
        name="question"
        legend={texts.choose}
        value={state.question}
        class="stacked"
        options={QUESTIONS.map((value, i) => ({ value, label: `${i + 1}. ${texts.questions[value]}` }))}
        choose={(question) => set({ question })}
      />
      <div>
        <p class="aside">{texts.see}</p>
        <ul class="seen">
          {seen.map((entry) => (
            <li key={entry.id}>
              <a href={fileOf(entry.id, language)}>{entry.title[language]}</a>
            </li>
          ))}
          {state.question === "joins" && (
            <li>
              <a href={`${language === "en" ? "index" : language}.html#v=1&w=s`}>{texts.widget}</a>
            </li>
          )}
        </ul>
      </div>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: { question: ["n", word(...QUESTIONS)] },
  question: () => ({ asked: QUESTIONS.map(initialQuestion) }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
