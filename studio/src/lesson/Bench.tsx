// A figure of the lesson: an exhibit's picture, its number and its controls, as a still at build time and in motion in the page.
import { Awake } from "../exhibits/Scene";
import type { AnyExhibit } from "../exhibits/exhibit";
import type { Change } from "../exhibits/run";
import { type Language, Say } from "../exhibits/say";
import { Hint } from "../view/Hint";
import { Figure as Data, Scope } from "../view/parts";

export interface BenchProps {
  /** The figure's id, which is put before the ids of its controls. */
  id: string;
  exhibit: AnyExhibit;
  state: object;
  answer: unknown;
  language: Language;
  isStill: boolean;
  isAwake: boolean;
  notes: readonly string[];
  set(change: Change): void;
}

export function Bench({ id, exhibit, state, answer, language, isStill, isAwake, notes, set }: BenchProps) {
  const texts = exhibit.texts[language];
  const page = { state, answer, say: new Say(language), texts, set, isStill, isSmall: false };
  const number = exhibit.number(page);
  return (
    <Scope.Provider value={`${id}-`}>
      <Awake.Provider value={isAwake}>
        <div class="stage">
          <exhibit.Figure page={page} />
          <p class="aside hint" id={`${id}-hint`}>
            <Hint text={texts.hint} />
          </p>
        </div>
        <div class="panel" {...(isStill ? { inert: true } : {})}>
          {notes.map((note) => (
            <p class="note" role="alert" key={note}>
              {note}
            </p>
          ))}
          <div class={`live ${number.tone}`}>
            <p class="label-of">{number.label}</p>
            <p class="big">
              <Data name={`${id}-live`} value={number.value}>
                {number.shown}
              </Data>
            </p>
            <p class="meaning">{number.meaning}</p>
          </div>
          <exhibit.Panel page={page} />
        </div>
      </Awake.Provider>
    </Scope.Provider>
  );
}
