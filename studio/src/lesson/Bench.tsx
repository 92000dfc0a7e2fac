// A figure of the lesson: an exhibit's picture, its number and its controls, as a still at build time and in motion in the page.
import type { ComponentChild, VNode } from "preact";
import { useState } from "preact/hooks";
import { Awake } from "../exhibits/Scene";
import type { AnyExhibit } from "../exhibits/exhibit";
import { FRAME } from "../exhibits/frame_texts";
import type { Change } from "../exhibits/run";
import { type Language, Say } from "../exhibits/say";
import { Hint } from "../view/Hint";
import { Figure as Data, Scope } from "../view/parts";

/** What opens the rest of a panel on a narrow screen: as it is seen beside the number, and as it is spoken. */
const MORE: Record<Language, readonly [string, string]> = {
  en: ["More", "More to set and to read off"],
  zh: ["更多", "更多设置与数值"],
};

export interface BenchProps {
  /** The figure's id, which is put before the ids of its controls. */
  id: string;
  exhibit: AnyExhibit;
  state: object;
  answer: unknown;
  language: Language;
  isStill: boolean;
  isAwake: boolean;
  /** Whether the picture is moved by hand, so that its first control repeats that. */
  isByHand: boolean;
  notes: readonly string[];
  set(change: Change): void;
}

/**
 * On a narrow screen a panel is its first control, its number and a button for the rest of it. Elsewhere, and without script, the
 * button is not there, the rest is no box of its own, and the number comes first (blocks.css, narrow.css).
 */
export function Bench({ id, exhibit, state, answer, language, isStill, isAwake, isByHand, notes, set }: BenchProps) {
  const [isOpen, setOpen] = useState(false);
  const texts = exhibit.texts[language];
  const page = { state, answer, say: new Say(language), texts, set, isStill, isSmall: false };
  const number = exhibit.number(page);
  const parts = partsOf(exhibit.Panel, page);
  const first = isByHand || isNumbers(parts[0]) ? 0 : 1;
  const [more, moreSpoken] = MORE[language];
  // How to turn a body is the same for many figures.
  const isCommon = texts.hint === FRAME[language].turn;
  return (
    <Scope.Provider value={`${id}-`}>
      <Awake.Provider value={isAwake}>
        <div class="stage">
          <exhibit.Figure page={page} />
          <p class={isCommon ? "aside hint common" : "aside hint"} id={`${id}-hint`}>
            <Hint text={texts.hint} />
          </p>
        </div>
        <div class={isOpen ? "panel unfolded" : "panel"} {...(isStill ? { inert: true } : {})}>
          {notes.map((note) => (
            <p class="note" role="alert" key={note}>
              {note}
            </p>
          ))}
          {parts.slice(0, first)}
          <div class={`live ${number.tone}`}>
            <p class="label-of">{number.label}</p>
            <p class="big">
              <Data name={`${id}-live`} value={number.value}>
                {number.shown}
              </Data>
            </p>
            <div class="told">
              <p class="meaning">{number.meaning}</p>
              <button type="button" class="fold" aria-label={moreSpoken} aria-expanded={isOpen} aria-controls={`${id}-rest`} onClick={() => setOpen(!isOpen)}>
                {more}
              </button>
            </div>
          </div>
          <div class="rest" id={`${id}-rest`}>
            {parts.slice(first)}
          </div>
        </div>
      </Awake.Provider>
    </Scope.Provider>
  );
}

/** The parts of an exhibit's panel. It is called, not rendered, because they are needed one by one; what a state lacks keeps its place. */
function partsOf(Panel: AnyExhibit["Panel"], page: Parameters<AnyExhibit["Panel"]>[0]["page"]): ComponentChild[] {
  return [(Panel({ page }) as VNode<{ children: ComponentChild[] }>).props.children].flat();
}

const isNumbers = (part: ComponentChild) => (part as VNode).type === "dl";
