// What a language writes for the lesson.
import type { ComponentChildren } from "preact";
import type { Say } from "../exhibits/say";
import type { Facts } from "./facts";
import type { BlockId, GuessId, QuestionId, SectionId, TermId } from "./outline";

type Text = ComponentChildren;

export interface BlockText {
  /** A heading, in few words. */
  title: string;
  text: Text;
  /** After the guess and beside the figure: what the reveal shows. */
  after?: Text;
}

export interface GuessText {
  ask: string;
  /** The options of a choice, or the unit of a number. */
  options?: Record<string, string>;
  unit?: string;
  /** The answer in a sentence or two. */
  answer: Text;
}

export interface TermText {
  word: string;
  formula?: Text;
  gloss: Text;
}

/** Words of the page around the texts. */
export interface Words {
  skip: string;
  sections: string;
  elsewhere: string;
  onward: string;
  exhibits: string;
  bench: string;
  workbench: string;
  widget: string;
  begin: string;
  /** The handle of the hero. */
  distance: string;
  seenFrom(distance: string, pixels: string): string;
  upClose: string;
  enough(pixels: string): string;
  spokenAt(distance: string, triangles: string): string;
  all(triangles: string): string;
  heroPicture: string;
  /** Below the stills of the two answers. */
  asPoints: string;
  asRule: string;
  again: string;
  ownPage: string;
  guess: string;
  yourGuess: string;
  reveal: string;
  showAnswer: string;
  /** After a guess: `{guess}` is replaced. */
  close: string;
  far: string;
  right: string;
  wrong: string;
  code: string;
  copy: string;
  copied: string;
  terms: string;
  termsLead: string;
  showTerms: string;
  showTable: string;
  backToText: string;
  closeTerm: string;
  turn: string;
  answerOf: string;
  seeFigure: string;
  yourAnswer: string;
  footer: string;
}

export interface LessonText {
  title: string;
  description: string;
  words: Words;
  hero: { question: string; sentence(facts: Facts, say: Say): Text };
  sections: Record<SectionId, { kicker: string; title: string; lead?: Text }>;
  blocks(facts: Facts, say: Say): Record<BlockId, BlockText>;
  table(facts: Facts, say: Say): Text;
  guesses(facts: Facts, say: Say): Record<GuessId, GuessText>;
  terms: Record<TermId, TermText>;
  questions: { title: string; lead: Text; cards(facts: Facts, say: Say): Record<QuestionId, { ask: string; answer: Text; figure: string }> };
  ending: { title: string; text: Text };
}
