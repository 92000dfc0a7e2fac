// Changes that belong together, as those of a drag, are one step of undo, however long they take; and what the page changes
// itself is told apart from what its reader changes.
import { history, undo } from "@codemirror/commands";
import { Annotation, type ChangeSpec, type EditorSelection, type Extension, StateField, Transaction } from "@codemirror/state";
import type { EditorView } from "@codemirror/view";

/** The number of the edit that a change is part of. */
const partOf = Annotation.define<number>();

interface LastEdit {
  time: number;
  part: number | undefined;
}

const lastEdit = StateField.define<LastEdit>({
  create: () => ({ time: 0, part: undefined }),
  update: (last, tr) => (tr.docChanged ? { time: tr.annotation(Transaction.time)!, part: tr.annotation(partOf) } : last),
});

/** Typing within so many milliseconds is one step: CodeMirror's own default. */
const TYPED_TOGETHER = 500;
/** In milliseconds, a day: it leaves the decision to `joinToEvent`. What is isolated is as old as the epoch. */
const ALWAYS_ASK = 86_400_000;

export const steps: Extension = [
  lastEdit,
  history({
    newGroupDelay: ALWAYS_ASK,
    joinToEvent: (tr, isAdjacent) => {
      const last = tr.startState.field(lastEdit);
      const part = tr.annotation(partOf);
      if (part !== undefined || last.part !== undefined) return part === last.part;
      return isAdjacent && tr.annotation(Transaction.time)! - last.time < TYPED_TOGETHER;
    },
  }),
];

let count = 0;

/** One edit made of many changes. */
export class LiveEdit {
  private readonly part = (count += 1);
  private readonly before: string;
  private isChanged = false;

  constructor(private readonly view: EditorView) {
    this.before = view.state.doc.toString();
  }

  change(changes: ChangeSpec, selection?: EditorSelection): void {
    this.view.dispatch({ changes, annotations: partOf.of(this.part), ...(selection ? { selection } : {}) });
    this.isChanged = true;
  }

  /** Ends it. What is not kept, or has come to nothing, leaves no step behind. */
  end(isKept: boolean): void {
    if (!this.isChanged) return;
    const isNothing = this.view.state.doc.toString() === this.before;
    if ((!isKept || isNothing) && this.view.state.field(lastEdit).part === this.part) undo(this.view);
  }
}

/** What makes one text of the other: one stretch, so that the cursor stays where it was outside of it. */
export function difference(before: string, after: string): { from: number; to: number; insert: string } | null {
  if (before === after) return null;
  let from = 0;
  while (from < before.length && before[from] === after[from]) from += 1;
  let tail = 0;
  while (tail < Math.min(before.length, after.length) - from && before.at(-1 - tail) === after.at(-1 - tail)) tail += 1;
  return { from, to: before.length - tail, insert: after.slice(from, after.length - tail) };
}
