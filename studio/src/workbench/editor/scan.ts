// The words and numbers of the document as it is, scanned once for each of its versions.
import type { EditorState, Text } from "@codemirror/state";
import { type NumberPlace, numbersOf } from "./numbers";
import { type Token, tokens } from "./tokens";

export interface Scan {
  text: string;
  tokens: readonly Token[];
  numbers: readonly NumberPlace[];
}

const known = new WeakMap<Text, Scan>();

export function scan({ doc }: EditorState): Scan {
  let found = known.get(doc);
  if (!found) {
    const text = doc.toString();
    const all = tokens(text);
    found = { text, tokens: all, numbers: numbersOf(text, all) };
    known.set(doc, found);
  }
  return found;
}
