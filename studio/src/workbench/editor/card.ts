// What a function is: how it is called, what it makes, and what its value is worth.
import type { EditorPhrases } from "./phrases";
import { type FunctionRow, parametersOf } from "./table";

type Tags = HTMLElementTagNameMap;

function element<K extends keyof Tags>(name: K, className: string, ...inside: (Node | string)[]): Tags[K] {
  const made = document.createElement(name);
  made.className = className;
  made.append(...inside);
  return made;
}

/** With the parameter that is being given set off, if there is one. */
export function card(row: FunctionRow, parameter: number, phrases: EditorPhrases): HTMLElement {
  const given = (written: string, k: number) => (k === parameter ? element("b", "", written) : written);
  const shown = parametersOf(row).flatMap((written, k) => [k > 0 ? ", " : "", given(written, k)]);
  const usage = element("code", "cm-usage", `${row.name}(`, ...shown, ")");
  const text = [row.doc, row.worth ? phrases.asDistance(row.worth) : ""].filter(Boolean).join(phrases.gap);
  return element("div", "cm-card", usage, element("p", "", text));
}
