// What an exhibit is: a state in the address, a question to the core, a figure with one handle, one live number, a text.
import type { ComponentChildren, ComponentType } from "preact";
import type { Parts } from "./fragment";
import type { Language, Say } from "./say";

/** What figure and panel are given. */
export interface Page<S, A, T> {
  state: S;
  /** The core's answer to the newest state that it has answered. */
  answer: A;
  say: Say;
  texts: T;
  set(change: Partial<S> | ((state: S) => Partial<S>)): void;
  /** Written at build time: nothing moves, and no script runs. */
  isStill: boolean;
  /** Only a small picture of it, on the list of all. */
  isSmall: boolean;
}

/** The one number to look at. */
export interface LiveNumber {
  /** For programs; null where there is none. */
  value: number | null;
  shown: string;
  label: string;
  /** A sentence that says what it means here; it is spoken once the hand rests. */
  meaning: string;
  /** Good where what was promised holds, bad where it does not. */
  tone: "plain" | "good" | "bad";
}

/** What every exhibit says besides its own words. */
export interface CommonTexts {
  /** How the figure is moved, under it. */
  hint: string;
  /** Paragraphs under the figure. `*word*` is emphasized. */
  story: readonly string[];
  /** What to try, in a line each. */
  attempts: readonly string[];
}

export interface Exhibit<S extends object, A, T extends CommonTexts> {
  defaults: S;
  parts: Parts<S>;
  /** What the core is asked, without the exhibit's name. */
  question(state: S): Record<string, unknown>;
  texts: Record<Language, T>;
  number(page: Page<S, A, T>): LiveNumber;
  Figure: ComponentType<{ page: Page<S, A, T> }>;
  Panel: ComponentType<{ page: Page<S, A, T> }>;
}

export type AnyExhibit = Exhibit<any, any, any>;

/** Checks an exhibit's types where it is written, and forgets them for the registry. */
export function exhibit<S extends object, A, T extends CommonTexts>(made: Exhibit<S, A, T>): AnyExhibit {
  return made;
}

export type Children = ComponentChildren;
