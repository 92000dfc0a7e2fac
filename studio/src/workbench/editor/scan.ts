// The tokens and numbers of the document, scanned once for each version of it.
import type { EditorState, Text } from "@codemirror/state";
import { type NumberPlace, numbersOf } from "./numbers";
import { type Token, tokens } from "./tokens";

export interface Scan {
  text: string;
  tokens: readonly Token[];
  numbers: readonly NumberPlace[];
}

const cache = new WeakMap<Text, Scan>();

export function scan({ doc }: EditorState): Scan {
  let scanned = cache.get(doc);
  if (!scanned) {
    const text = doc.toString();
    const allTokens = tokens(text);
    scanned = { text, tokens: allTokens, numbers: numbersOf(text, allTokens) };
    cache.set(doc, scanned);
  }
  return scanned;
}
