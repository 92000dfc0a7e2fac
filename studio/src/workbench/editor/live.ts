// Undo steps: changes that belong together, such as those of a drag, are one step however long they take. Changes by the page
// are kept apart from those by the reader.
import { history, undo } from "@codemirror/commands";
import { Annotation, type ChangeSpec, type EditorSelection, type Extension, StateField, Transaction } from "@codemirror/state";
import type { EditorView } from "@codemirror/view";

/** The number of the edit to which a change belongs. */
const editOf = Annotation.define<number>();

interface LastEdit {
  time: number;
  edit: number | undefined;
}

const lastEdit = StateField.define<LastEdit>({
  create: () => ({ time: 0, edit: undefined }),
  update: (last, tr) => (tr.docChanged ? { time: tr.annotation(Transaction.time)!, edit: tr.annotation(editOf) } : last),
});

/** Typing within so many milliseconds is one step: CodeMirror's own default. */
const TYPED_TOGETHER = 500;
/** A day, in milliseconds, so that `joinToEvent` always decides. An isolated change has the time 0 and is not joined. */
const ALWAYS_ASK = 86_400_000;

export const steps: Extension = [
  lastEdit,
  history({
    newGroupDelay: ALWAYS_ASK,
    joinToEvent: (tr, isAdjacent) => {
      const last = tr.startState.field(lastEdit);
      const edit = tr.annotation(editOf);
      if (edit !== undefined || last.edit !== undefined) return edit === last.edit;
      return isAdjacent && tr.annotation(Transaction.time)! - last.time < TYPED_TOGETHER;
    },
  }),
];

let count = 0;

/** One step of undo that consists of many changes. */
export class LiveEdit {
  private readonly edit = (count += 1);
  private readonly before: string;
  private isChanged = false;

  constructor(private readonly view: EditorView) {
    this.before = view.state.doc.toString();
  }

  change(changes: ChangeSpec, selection?: EditorSelection): void {
    this.view.dispatch({ changes, annotations: editOf.of(this.edit), ...(selection ? { selection } : {}) });
    this.isChanged = true;
  }

  /** Ends the edit. If it is not kept, or changes nothing in total, it is undone and leaves no step. */
  end(isKept: boolean): void {
    if (!this.isChanged) return;
    const isUnchanged = this.view.state.doc.toString() === this.before;
    // `undo` takes the last step back, which is this edit only if nothing was changed after it.
    if ((!isKept || isUnchanged) && this.view.state.field(lastEdit).edit === this.edit) undo(this.view);
  }
}

/** The change from one text to another as a single range, so that a cursor outside of it keeps its place. */
export function difference(before: string, after: string): { from: number; to: number; insert: string } | null {
  if (before === after) return null;
  let from = 0;
  while (from < before.length && before[from] === after[from]) from += 1;
  let tail = 0;
  // The equal ends must not overlap the equal starts: of "aa" and "aaa", each would be the whole of
  // the shorter text.
  while (tail < Math.min(before.length, after.length) - from && before.at(-1 - tail) === after.at(-1 - tail)) tail += 1;
  return { from, to: before.length - tail, insert: after.slice(from, after.length - tail) };
}
