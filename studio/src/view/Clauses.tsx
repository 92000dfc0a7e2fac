// A heading whose lines end with its clauses. Chinese may break between any two characters, also within a word; so every clause is
// a box of its own, and only one that is wider than the page breaks inside.
import type { ComponentChildren } from "preact";

/** A clause with the marks that end it: none of them may begin a line. */
const CLAUSE = /[^，；：。？！、]+[，；：。？！、]*/gu;

export function Clauses({ text }: { text: string }): ComponentChildren {
  const clauses = text.match(CLAUSE) ?? [];
  if (clauses.length < 2 || clauses.join("") !== text) return text;
  return clauses.map((clause) => <span class="clause">{clause}</span>);
}
