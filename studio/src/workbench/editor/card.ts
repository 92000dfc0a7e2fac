// The help on a function: its usage, what it returns, and how exact its distance is.
import type { EditorPhrases } from "./phrases";
import { type FunctionRow, parametersOf } from "./table";

type Tags = HTMLElementTagNameMap;

function element<K extends keyof Tags>(name: K, className: string, ...inside: (Node | string)[]): Tags[K] {
  const created = document.createElement(name);
  created.className = className;
  created.append(...inside);
  return created;
}

/** The help on a function; the current parameter is emphasized. */
export function card(row: FunctionRow, parameter: number, phrases: EditorPhrases): HTMLElement {
  const emphasized = (written: string, k: number) => (k === parameter ? element("b", "", written) : written);
  const shown = parametersOf(row).flatMap((written, k) => [k > 0 ? ", " : "", emphasized(written, k)]);
  const usage = element("code", "cm-usage", `${row.name}(`, ...shown, ")");
  const text = [row.doc, row.worth ? phrases.asDistance(row.worth) : ""].filter(Boolean).join(phrases.gap);
  return element("div", "cm-card", usage, element("p", "", text));
}
