// What every part of the page gets: the reader's choices, the core's answers, a voice, and a way to change things.
import type { LadderAnswer, SeamAnswer, StudyAnswer } from "../core/types";
import type { Key } from "../i18n/en";
import type { Speaker } from "../i18n/speak";
import type { State } from "../state/state";

export interface Answers {
  study: StudyAnswer;
  ladder: LadderAnswer;
  seam: SeamAnswer;
}

/** What the surroundings are, which the reader does not choose here. */
export interface Surroundings {
  /** Of the main figure, in CSS pixels. */
  width: number;
  /** Device pixels in one CSS pixel of this screen. */
  ownDensity: number;
  /** Whether the page is embedded in another one and shows only the figure. */
  isEmbedded: boolean;
  /** Whether it is written at build time, for readers without script: everything shows, nothing moves. */
  isStill: boolean;
}

export interface Note {
  key: Key;
  values?: Record<string, string>;
}

/** New values, or how they follow from the ones that hold by then. */
export type Change = Partial<State> | ((state: State) => Partial<State>);

export interface Page {
  say: Speaker;
  state: State;
  answers: Answers;
  around: Surroundings;
  notes: readonly Note[];
  /** Whether something is being dragged: then only what is in sight needs to follow. */
  isMoving: boolean;
  /** Whether the number of segments runs by itself, and what starts and stops that. */
  isPlaying: boolean;
  play(): void;
  set(change: Change): void;
  close(note: Note): void;
}

/** Device pixels in one CSS pixel, as chosen. */
export function densityOf(state: State, around: Surroundings): number {
  return state.density === 0 ? around.ownDensity : state.density;
}
