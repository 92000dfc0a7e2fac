// Shows a script's error at its place: underlined text and a marked line number. The panel below shows the message.
import { type EditorState, type Extension, type Range, RangeSet, StateEffect, StateField, type Text, type Transaction } from "@codemirror/state";
import { type Command, Decoration, type DecorationSet, EditorView } from "@codemirror/view";
import { GutterMarker, gutterLineClass, keymap } from "@codemirror/view";

export interface EditorError {
  /** Counted from 1. */
  line: number;
  /** Counted from 1, in code points as the command counts them. */
  column?: number;
  message: string;
  /** The language of the message, if it is not the page's. */
  lang?: "en";
}

export interface Problem {
  from: number;
  to: number;
  message: string;
  lang?: "en";
}

/** Marks the language of a message, for screen readers. */
export function speak(element: HTMLElement, problem: Problem | null): void {
  if (problem?.lang) element.lang = problem.lang;
  else element.removeAttribute("lang");
}

export const setProblem = StateEffect.define<Problem | null>();

/** The mistakes after the first. */
export const setOthers = StateEffect.define<readonly Problem[]>();

/** Marked in the text only. They move with it, as the first one does. */
const othersField = StateField.define<readonly Problem[]>({
  create: () => [],
  update(others, tr) {
    for (const effect of tr.effects) if (effect.is(setOthers)) return effect.value;
    return tr.docChanged ? others.map((problem) => moved(problem, tr)) : others;
  },
  provide: (field) => [
    EditorView.decorations.from(field, (others) => Decoration.set(others.flatMap(marksOf), true)),
    gutterLineClass.compute([field, "doc"], (state) => RangeSet.of(state.field(field).map(({ from }) => lineMark.range(state.doc.lineAt(from).from)), true)),
  ],
});

/** Moves with the text until the page sets the error of the new text. */
export const problemField = StateField.define<Problem | null>({
  create: () => null,
  update(problem, tr) {
    for (const effect of tr.effects) if (effect.is(setProblem)) return effect.value;
    return problem && tr.docChanged ? moved(problem, tr) : problem;
  },
  provide: (field) => [
    EditorView.decorations.from(field, marks),
    gutterLineClass.compute([field, "doc"], (state) => {
      const problem = state.field(field);
      return problem ? RangeSet.of(lineMark.range(state.doc.lineAt(problem.from).from)) : RangeSet.empty;
    }),
    EditorView.contentAttributes.from(field, (problem) => ({ "aria-invalid": String(problem !== null) })),
  ],
});

function moved(problem: Problem, { changes }: Transaction): Problem {
  // Towards each other, so that text typed at either end is not underlined.
  const [from, to] = [changes.mapPos(problem.from, 1), changes.mapPos(problem.to, -1)];
  // If all of it was replaced, they have crossed.
  return { ...problem, from: Math.min(from, to), to: Math.max(from, to) };
}

class LineMark extends GutterMarker {
  override elementClass = "cm-problemLine";
}
const lineMark = new LineMark();

const underline = Decoration.mark({ class: "cm-problem" });
/** Marks the line if there is no text to underline, as at the end of a line. */
const spot = Decoration.line({ class: "cm-problemSpot" });

// Functions, not constants: the fields above are given them while this module is read.
function marksOf(problem: Problem): Range<Decoration>[] {
  return [problem.to > problem.from ? underline.range(problem.from, problem.to) : spot.range(problem.from)];
}

function marks(problem: Problem | null): DecorationSet {
  return problem ? Decoration.set(marksOf(problem)) : Decoration.none;
}

const WORD = /^[\p{L}\p{N}_]+/u;

/** The place of an error in a text: the word at its column, or the whole line. */
export function problemAt(doc: Text, { line, column, ...said }: EditorError): Problem {
  const { from, text } = doc.line(Math.min(Math.max(1, Math.trunc(line) || 1), doc.lines));
  const start = text.length - text.trimStart().length;
  if (column === undefined) return lineStart(doc, { from: from + start, to: from + text.trimEnd().length, ...said });
  // The command counts code points, and the editor UTF-16 units.
  const before = [...text].slice(0, Math.max(0, column - 1)).join("").length;
  const rest = text.slice(before);
  const word = WORD.exec(rest)?.[0] ?? rest.slice(0, String.fromCodePoint(rest.codePointAt(0) ?? 0).length);
  return lineStart(doc, { from: from + before, to: from + before + (rest.trim() === "" ? 0 : word.length), ...said });
}

/** Moves an empty range to the start of its line, where a line decoration must be. */
function lineStart(doc: Text, problem: Problem): Problem {
  if (problem.to > problem.from) return problem;
  const { from } = doc.lineAt(problem.from);
  return { ...problem, from, to: from };
}

export const problemLine = (state: EditorState): number | null => {
  const problem = state.field(problemField);
  return problem && state.doc.lineAt(problem.from).number;
};

/** Moves the cursor to the first error; from an error to the next. */
export const goToProblem: Command = (view) => {
  const first = view.state.field(problemField);
  if (!first) return false;
  const all = [first, ...view.state.field(othersField)];
  const at = all.findIndex(({ from }) => from === view.state.selection.main.anchor);
  const problem = all[(at + 1) % all.length]!;
  view.focus();
  view.dispatch({ selection: { anchor: problem.from }, scrollIntoView: true, userEvent: "select" });
  return true;
};

export const problems: Extension = [problemField, othersField, keymap.of([{ key: "F8", run: goToProblem }])];
