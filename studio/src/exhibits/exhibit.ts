// The interface of an exhibit: a state in the address, a question to the core, a figure with a handle, a live number, texts.
import type { ComponentChildren, ComponentType, FunctionComponent } from "preact";
import type { Parts } from "./fragment";
import type { Language, Say } from "./say";

/** The properties of a figure and its panel. */
export interface Page<S, A, T> {
  state: S;
  /** The newest answer; it may still be of an earlier state. */
  answer: A;
  say: Say;
  texts: T;
  set(change: Partial<S> | ((state: S) => Partial<S>)): void;
  /** Rendered at build time: nothing moves, and no script runs. */
  isStill: boolean;
  /** Rendered as a small picture in the list of exhibits. */
  isSmall: boolean;
}

/** The number that the exhibit is about. */
export interface LiveNumber {
  /** For programs; `null` if there is none. */
  value: number | null;
  shown: string;
  label: string;
  /** A sentence on its meaning; it is spoken after a pause of the hand. */
  meaning: string;
  /** `good` if a promised property holds, `bad` if not. */
  tone: "plain" | "good" | "bad";
}

/** The texts that every exhibit has. */
export interface CommonTexts {
  /** How to move the figure; shown below it. */
  hint: string;
  /** Paragraphs below the figure. `*word*` is emphasized. */
  story: readonly string[];
  /** Suggestions, one a line. */
  attempts: readonly string[];
}

export interface Exhibit<S extends object, A, T extends CommonTexts> {
  defaults: S;
  parts: Parts<S>;
  /** The question to the core, without the exhibit's name. */
  question(state: S): Record<string, unknown>;
  /** Whether a state shows nothing of an answer: until it does, a page loads no core, and its answer is `{}`. */
  isIdle?(state: S): boolean;
  texts: Record<Language, T>;
  number(page: Page<S, A, T>): LiveNumber;
  Figure: ComponentType<{ page: Page<S, A, T> }>;
  /** The controls and further numbers, one below the other in a fragment. */
  Panel: FunctionComponent<{ page: Page<S, A, T> }>;
}

export type AnyExhibit = Exhibit<any, any, any>;

/** Checks an exhibit's types at its definition, and erases them for the registry. */
export function exhibit<S extends object, A, T extends CommonTexts>(definition: Exhibit<S, A, T>): AnyExhibit {
  return definition;
}

export type Children = ComponentChildren;
