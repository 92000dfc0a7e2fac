// The lesson's page: the outline, filled with the texts of one language. Rendered at build time only; enhance.ts and live.tsx
// make it work.
import { Fragment } from "preact";
import type { AnyExhibit } from "../exhibits/exhibit";
import { Languages, Mark } from "../exhibits/Frame";
import { fileOf } from "../exhibits/index";
import { type Language, Say } from "../exhibits/say";
import { Clauses } from "../view/Clauses";
import { Themes } from "../view/Themes";
import { Bench } from "./Bench";
import { TwoAnswers } from "./TwoAnswers";
import type { Facts } from "./facts";
import { hasPage } from "./figures";
import { DISTANCES, HeroBench, levelAt, START, STILL_STEP } from "./Hero";
import type { BlockText, GuessText, LessonText, Words } from "./lesson";
import {
  type BlockPlan,
  type BlockId,
  blocksOf,
  type GuessId,
  type GuessPlan,
  QUESTIONS,
  SECTIONS,
  STATIONS,
  TERMS,
} from "./outline";
import { AWAY, BRING } from "./own/words";

export interface Still {
  exhibit: AnyExhibit;
  state: object;
  answer: unknown;
}

export interface LessonProps {
  language: Language;
  text: LessonText;
  facts: Facts;
  /** The figures that exist, by their ids. */
  stills: ReadonlyMap<string, Still>;
  /** The files of the code, by name with ending. */
  code: ReadonlyMap<string, string>;
  /** The file of the first picture. */
  teapot: string;
}

const nothing = () => undefined;
/** The picture before scripts run is drawn in this size. */
const STILL_SIZE = { width: 720, height: 480 };

export function LessonPage(props: LessonProps) {
  const { language, text, facts } = props;
  const { words } = text;
  const say = new Say(language);
  const blocks = text.blocks(facts, say);
  const guesses = text.guesses(facts, say);
  const cards = text.questions.cards(facts, say);
  return (
    <div class="page lesson">
      <a class="skip" href="#figure">
        {words.skip}
      </a>
      <header>
        <span class="brand">
          <Mark />
          Chordal
        </span>
        <nav class="onwards" aria-label={words.elsewhere}>
          <a href={fileOf("exhibits", language)}>{words.exhibits}</a>
          <a href={language === "en" ? "workbench.html" : "workbench.zh.html"}>{words.bench}</a>
        </nav>
        <div class="wishes-of-page">
          {/* Named in the address, because lesson.html takes readers to the language that their browser prefers. */}
          <Languages language={language} file={(other) => `${fileOf("lesson", other)}#l=${other}`} />
          <Themes language={language} />
        </div>
      </header>
      <main>
        <Hero {...props} />
        {SECTIONS.map((section) => {
          const { kicker, title, lead } = text.sections[section.id];
          return (
            <section id={section.id} key={section.id}>
              <p class="kicker">{kicker}</p>
              <h2>
                <Clauses text={title} />
              </h2>
              {lead && <p class="lead">{lead}</p>}
              {blocksOf(section).map((plan) => (
                <Fragment key={plan.id}>
                  <Block plan={plan} {...props} block={blocks[plan.id as BlockId]} guess={guesses[plan.id as GuessId]} />
                  <Station at={plan.id} />
                </Fragment>
              ))}
            </section>
          );
        })}
        <section id="questions">
          <h2>{text.questions.title}</h2>
          <p class="lead">{text.questions.lead}</p>
          <ol class="turning">
            {QUESTIONS.map((id) => (
              <li key={id} data-card={id}>
                <h3>
                  <Clauses text={cards[id].ask} />
                </h3>
                <div class="front" hidden>
                  <label for={`answer-${id}`}>{words.yourAnswer}</label>
                  <textarea id={`answer-${id}`} rows={3} />
                  <button type="button" disabled>
                    {words.turn}
                  </button>
                </div>
                <details>
                  <summary>{words.answerOf}</summary>
                  <p>{cards[id].answer}</p>
                  <p class="aside">
                    <a href={`#block-${cards[id].figure}`}>{words.seeFigure}</a>
                  </p>
                </details>
              </li>
            ))}
          </ol>
        </section>
        <section id="ending">
          <p class="closing">
            <Clauses text={text.ending.title} />
          </p>
          <p>{text.ending.text}</p>
          <Station at="ending" />
          <nav class="onwards" aria-label={words.onward}>
            <a href={fileOf("exhibits", language)}>{words.exhibits}</a>
            <a href={language === "en" ? "index.html" : "zh.html"}>{words.widget}</a>
            <a href={language === "en" ? "workbench.html" : "workbench.zh.html"}>{words.workbench}</a>
          </nav>
        </section>
        <section id="terms">
          <h2>{words.terms}</h2>
          <p class="aside">{words.termsLead}</p>
          <details data-fold open>
            <summary>{words.showTerms}</summary>
            <dl class="terms">
              {TERMS.map((id) => {
                const { word, formula, gloss } = text.terms[id];
                return (
                  <div id={`term-${id}`} key={id}>
                    <dt>
                      {word}{" "}
                      <a class="back" href={`#use-${id}`} aria-label={`${words.backToText}: ${word}`}>
                        ↑
                      </a>
                    </dt>
                    {formula && <dd class="formula">{formula}</dd>}
                    <dd>{gloss}</dd>
                  </div>
                );
              })}
            </dl>
          </details>
        </section>
      </main>
      <footer>
        <p>{words.footer}</p>
      </footer>
    </div>
  );
}

function Hero({ language, text, facts, teapot }: LessonProps) {
  const { words, hero } = text;
  const say = new Say(language);
  return (
    <div class="hero">
      <div class="hero-text">
        <h1>
          <Clauses text={hero.question} />
        </h1>
        <p class="lead">{hero.sentence(facts, say)}</p>
        <div class="begins">
          <a class="begin" href="#question">
            {words.begin}
          </a>
          {/* Shown by the script that it needs. */}
          <div class="own-begin" data-own-begin data-away={AWAY[language]} hidden>
            <button type="button">{BRING[language]}</button>
            <div data-own-line />
          </div>
        </div>
      </div>
      <div class="hero-figure" data-hero={teapot} data-words={JSON.stringify(spoken(words))}>
        <HeroBench
          levels={[levelAt(facts.hero, DISTANCES[STILL_STEP]!)]}
          state={{ ...START, step: STILL_STEP }}
          language={language}
          words={words}
          size={STILL_SIZE}
          isStill
          isAwake={false}
          set={nothing}
          play={nothing}
        />
      </div>
      {/* After the figure, which the keyboard reaches first. */}
      <nav aria-label={words.sections} class="moves">
        <ol>
          {SECTIONS.slice(1).map(({ id }) => (
            <li key={id}>
              <a href={`#${id}`}>{text.sections[id].title}</a>
            </li>
          ))}
        </ol>
      </nav>
    </div>
  );
}

/** Functions of the words as patterns, for the script: each argument becomes `{0}`, `{1}`. */
function spoken(words: Words): Record<string, string> {
  const patterns = { seenFrom: words.seenFrom("{0}", "{1}"), enough: words.enough("{0}"), spokenAt: words.spokenAt("{0}", "{1}"), all: words.all("{0}") };
  const { distance, upClose, heroPicture, again } = words;
  return { ...patterns, distance, upClose, heroPicture, again };
}

type BlockProps = LessonProps & { plan: BlockPlan; block: BlockText; guess: GuessText | undefined };

function Block(props: BlockProps) {
  const { plan, block, guess, text, facts, code, language } = props;
  return (
    <article class={`block${plan.figure ? " with-figure" : ""}${plan.table || plan.twoAnswers ? " with-table" : ""}`} id={`block-${plan.id}`}>
      <div class="words">
        <h3>{block.title}</h3>
        {block.text}
        {plan.guess && guess && <Guess id={plan.id} plan={plan.guess} guess={guess} facts={facts} words={text.words} />}
        {block.after && <div class="after">{block.after}</div>}
      </div>
      {plan.twoAnswers && <TwoAnswers points={text.words.asPoints} rule={text.words.asRule} />}
      {plan.table && (
        <details data-fold open>
          <summary>{text.words.showTable}</summary>
          {text.table(facts, new Say(language))}
        </details>
      )}
      {plan.figure && <PlacedFigure {...props} figure={plan.figure} />}
      {plan.code && <Code name={plan.code} code={code} words={text.words} />}
    </article>
  );
}

/** Where a shape of the reader's own appears, once there is one. */
function Station({ at }: { at: string }) {
  const station = STATIONS.find((one) => one.at === at);
  return station ? <section class="own" id={`own-${station.id}`} aria-labelledby={`own-${station.id}-title`} data-own={station.id} hidden /> : null;
}

function PlacedFigure({ plan, figure, stills, language, text }: BlockProps & { figure: string }) {
  const { exhibit, state, answer } = stills.get(figure)!;
  return (
    <figure
      class="placed"
      data-figure-of={figure}
      data-state={JSON.stringify(plan.state ?? {})}
      {...(plan.guess ? { "data-locked": plan.id } : {})}
      {...(plan.isByHand ? { "data-by-hand": "" } : {})}
    >
      <div class="bench">
        <Bench
          id={figure}
          exhibit={exhibit}
          state={state}
          answer={answer}
          language={language}
          isStill
          isAwake={false}
          isByHand={plan.isByHand ?? false}
          notes={[]}
          set={nothing}
        />
      </div>
      {hasPage(figure) && (
        <figcaption class="aside">
          <a href={fileOf(figure, language)}>{text.words.ownPage}</a>
        </figcaption>
      )}
    </figure>
  );
}

interface GuessProps {
  id: string;
  plan: GuessPlan;
  guess: GuessText;
  facts: Facts;
  words: Words;
}

function Guess({ id, plan, guess, facts, words }: GuessProps) {
  const answer = plan.kind === "number" ? plan.answer(facts) : plan.right;
  return (
    <div class="guess" data-guess={id} data-kind={plan.kind} data-answer={answer}>
      <p class="ask" id={`ask-${id}`}>
        <b>{words.guess}</b> {guess.ask}
      </p>
      <form hidden aria-labelledby={`ask-${id}`}>
        {plan.kind === "number" ? (
          <label>
            <span class="spoken">{words.yourGuess}</span>
            <input type="number" inputmode="decimal" step="any" min="0" required /> {guess.unit}
          </label>
        ) : (
          <span class="options">
            {plan.options.map((option) => (
              <button type="submit" key={option} value={option}>
                {guess.options![option]}
              </button>
            ))}
          </span>
        )}
        {plan.kind === "number" && <button type="submit">{words.reveal}</button>}
      </form>
      <p class="verdict" role="status" data-close={words.close} data-far={words.far} data-right={words.right} data-wrong={words.wrong} />
      <details>
        <summary>{words.showAnswer}</summary>
        <p>{guess.answer}</p>
      </details>
    </div>
  );
}

const LANGUAGES_OF_CODE = [
  ["py", "Python"],
  ["js", "JavaScript"],
] as const;

function Code({ name, code, words }: { name: string; code: ReadonlyMap<string, string>; words: Words }) {
  return (
    <div class="code" data-fold={words.code} data-copy={words.copy} data-copied={words.copied}>
      {LANGUAGES_OF_CODE.map(([ending, label]) => (
        <details key={ending} data-code={ending} open={ending === "py"}>
          <summary>{label}</summary>
          <pre tabindex={0} aria-label={`${words.code}, ${label}`}>
            <code>{code.get(`${name}.${ending}`)!.trimEnd()}</code>
          </pre>
        </details>
      ))}
    </div>
  );
}
