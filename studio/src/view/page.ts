// The properties of every part of the page: the reader's choices, the core's answers, texts, and the functions that act.
import type { LadderAnswer, SeamAnswer, StudyAnswer } from "../core/types";
import type { Key } from "../i18n/en";
import type { Speaker } from "../i18n/speak";
import type { State } from "../state/state";

export interface Answers {
  study: StudyAnswer;
  ladder: LadderAnswer;
  seam: SeamAnswer;
}

/** The page's environment, which the reader does not choose here. */
export interface Surroundings {
  /** Of the main figure, in CSS pixels. */
  width: number;
  /** Device pixels in one CSS pixel of this screen. */
  ownDensity: number;
  /** Whether the page is embedded in another one and shows only the figure. */
  isEmbedded: boolean;
  /** Whether the page is written at build time, for readers without script: it shows everything, and nothing moves. */
  isStill: boolean;
}

export interface Note {
  key: Key;
  values?: Record<string, string>;
}

/** New values, or a function of the state at that time. */
export type Change = Partial<State> | ((state: State) => Partial<State>);

export interface Page {
  say: Speaker;
  state: State;
  answers: Answers;
  around: Surroundings;
  notes: readonly Note[];
  /** Whether a drag is going on; only the visible parts need to follow it. */
  isMoving: boolean;
  /** Whether the number of segments runs by itself; `play` starts and stops it. */
  isPlaying: boolean;
  play(): void;
  set(change: Change): void;
  close(note: Note): void;
}

/** Device pixels in one CSS pixel, as chosen. */
export function densityOf(state: State, around: Surroundings): number {
  return state.density === 0 ? around.ownDensity : state.density;
}
