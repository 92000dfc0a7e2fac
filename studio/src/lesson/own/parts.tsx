// What the stations of an own shape share: its picture, its numbers, the line of the command, and what stands in place of them.
import type { ComponentChildren } from "preact";
import { FRAME } from "../../exhibits/frame_texts";
import { Scene } from "../../exhibits/Scene";
import type { Language } from "../../exhibits/say";
import { Hint } from "../../view/Hint";
import { Figure as Data, Row } from "../../view/parts";
import type { Layer } from "../../viewer";
import { evidenceOf, sizeOf } from "../../workbench/Certificate";
import { stageIn } from "../../workbench/command_zh";
import { shell } from "../../workbench/document";
import type { BoundFacts } from "../../workbench/report";
import { FaultSaid, Said } from "../../workbench/Said";
import { TEXTS, type Texts as BenchTexts } from "../../workbench/texts";
import type { BenchSay, Page as BenchPage } from "../../workbench/words";
import type { StationId } from "../outline";
import type { OwnShape, Run, Why } from "./shape";
import type { OwnTexts } from "./texts";

/** What every station has. */
export interface StationPage {
  id: StationId;
  own: OwnShape;
  words: OwnTexts;
  say: BenchSay;
  language: Language;
}

/** The words of the workbench, for what is the same there. */
export const benchWords = ({ language }: StationPage): BenchTexts => TEXTS[language];
const asBench = (page: StationPage): BenchPage => ({ words: benchWords(page), say: page.say }) as BenchPage;

export const knownBy = (page: StationPage, bound: Pick<BoundFacts, "evidence">): string => evidenceOf(asBench(page), bound as BoundFacts);
/** How far off triangles are, and how that is known. */
export const Off = ({ page, name, bound }: { page: StationPage; name: string; bound: Pick<BoundFacts, "at_least" | "at_most" | "evidence"> | null }) =>
  bound && bound.at_most !== null ? (
    <Data name={`own-${name}`} value={bound.at_most}>
      {sizeOf(asBench(page), bound as BoundFacts)}
      {page.language === "zh" ? "，" : ", "}
      {knownBy(page, bound)}
    </Data>
  ) : (
    <>{benchWords(page).unknown}</>
  );
export const isGood = (bound: Pick<BoundFacts, "evidence"> | null | undefined): boolean => bound?.evidence === "proved" || bound?.evidence === "proved-if";

/** The picture: all stations share one view. */
export function Pictured({ page, layers, children }: { page: StationPage; layers: readonly Layer[]; children?: ComponentChildren }) {
  const { id, own, words, language } = page;
  return (
    <div class="stage">
      <Scene
        name={`${words.picture}: ${words.stations[id]}`}
        help={`own-${id}-hint`}
        picture={{ layers }}
        view={own.view}
        home={own.home}
        look={(view) => own.look(view)}
        isStill={false}
      />
      <p class="aside hint" id={`own-${id}-hint`}>
        <Hint text={FRAME[language].turn} />
      </p>
      {children}
    </div>
  );
}

interface LiveProps {
  label: string;
  name: string;
  value: number;
  shown: string;
  meaning?: ComponentChildren;
  isGood: boolean;
}

/** The number that a station is about. */
export const Live = ({ label, name, value, shown, meaning, isGood }: LiveProps) => (
  <div class={`live ${isGood ? "good" : "plain"}`}>
    <p class="label-of">{label}</p>
    <p class="big">
      <Data name={`own-${name}`} value={value}>
        {shown}
      </Data>
    </p>
    {meaning && <p class="meaning">{meaning}</p>}
  </div>
);

export type Row = readonly [label: string, name: string, value: number | null | undefined, shown?: string];

/** Further numbers; those that the report does not have are left out. */
export const Rows = ({ page: { say }, rows }: { page: StationPage; rows: readonly Row[] }) => (
  <dl>
    {rows.map(
      ([label, name, value, shown]) =>
        (shown !== undefined || (value !== null && value !== undefined)) && (
          <Row key={name} name={`own-${name}`} label={label} value={value ?? null}>
            {shown ?? (Number.isInteger(value) ? say.whole(value!) : say.number(value!))}
          </Row>
        ),
    )}
  </dl>
);

/** Why there is nothing, in a sentence. */
export function Reason({ why, words, language }: { why: Why; words: OwnTexts; language: Language }) {
  return (
    <p class="fault" role="alert">
      {"fault" in why ? (
        <FaultSaid fault={why.fault} language={language} />
      ) : why.notice === "no-triangles" ? (
        words.noTriangles
      ) : (
        TEXTS[language].notices[why.notice]
      )}
    </p>
  );
}

/** What runs, how far it is, or why it failed. */
export function Working({ runs, words, language }: { runs: readonly (Run | null)[]; words: OwnTexts; language: Language }) {
  const failed = runs.find((run) => run?.why);
  if (failed) return <Reason why={failed.why!} words={words} language={language} />;
  const running = runs.find((run) => !run?.made);
  if (running === undefined) return null;
  return (
    <p class="aside working" role="status">
      {running?.stage ? (
        <>
          <Said words={stageIn(language, running.stage)} /> <progress max={100} value={running.percent} aria-label={TEXTS[language].waiting} />
        </>
      ) : (
        TEXTS[language].waiting
      )}
    </p>
  );
}

/** The lines of the command by which a reader gets the same. */
export const Lines = ({ page: { words }, runs }: { page: StationPage; runs: readonly (Run | null)[] }) => (
  <details class="own-line">
    <summary>{words.line}</summary>
    <pre tabIndex={0} aria-label={words.line}>
      <code>{shell(runs.flatMap((run) => (run ? [run.line] : [])))}</code>
    </pre>
  </details>
);

/** How far a station is, for programs that drive the page. */
export const stateOf = (runs: readonly (Run | null)[]): "working" | "done" | "failed" =>
  runs.some((run) => run?.why) ? "failed" : runs.every((run) => run?.made) ? "done" : "working";

interface FrameProps {
  page: StationPage;
  runs: readonly (Run | null)[];
  figure: ComponentChildren;
  /** What its numbers are, once all runs have made something. */
  children: ComponentChildren;
  /** What can be chosen, also while something runs. */
  controls?: ComponentChildren;
}

/** A station: its title, its picture, its numbers. */
export function Station({ page, runs, figure, children, controls }: FrameProps) {
  const { id, own, words, language } = page;
  return (
    <div class="own-body" data-state={stateOf(runs)}>
      <div class="own-title">
        <p class="label-of">{words.yours(own.shape!.name)}</p>
        <h4 id={`own-${id}-title`}>{words.stations[id]}</h4>
      </div>
      {figure}
      <p class="aside own-covered">{words.covered}</p>
      <div class="panel">
        <Working runs={runs} words={words} language={language} />
        {children}
        {controls}
        <Lines page={page} runs={runs} />
      </div>
    </div>
  );
}
