// Makes the script's numbers draggable by mouse or finger, and steppable with keys and buttons.
import { type EditorState, EditorSelection, type Extension, RangeSetBuilder } from "@codemirror/state";
import { type Command, Decoration, type DecorationSet, EditorView, ViewPlugin, type ViewUpdate, keymap } from "@codemirror/view";
import { LiveEdit } from "./live";
import { type NumberPlace, STEP, fitting, numberAt, stepped } from "./numbers";
import { scan } from "./scan";

/** The pointer's way for one step, in CSS pixels: a hundred are twenty steps. Chosen by trying. */
const STEP_PX = 5;
/** From this way on a press is a drag, not a click; larger for a finger, which is never still. Chosen by trying. */
const CLICK_PX = { mouse: 3, touch: 8 };
/** How far beside a number a finger still hits it, in CSS pixels: half of the 44 that WCAG 2.5.5 asks for. */
const REACH_PX = 22;

const NUMBER_CLASS = "cm-number";
/** Set on the scrolling element while a number is dragged. */
const DRAGGING_CLASS = "cm-dragging";

export interface DragListener {
  /** Called after a drag, when the text is final. */
  ended(): void;
}

/** A pointer that is down on a number. */
interface Hold {
  pointerId: number;
  isTouch: boolean;
  place: NumberPlace;
  /** The number's text when the pointer came down. */
  literal: string;
  startX: number;
  startY: number;
  /** The position up to which the pointer's way has been turned into steps. */
  steppedX: number;
  tenths: number;
  /** Set once the press has become a drag. */
  edit: LiveEdit | null;
}

const tenthsOf = (event: { shiftKey: boolean; altKey: boolean }): number => {
  if (event.altKey) return STEP.fine;
  return event.shiftKey ? STEP.coarse : STEP.plain;
};

/** Replaces a number by a literal; the cursor stays behind it. */
function put(view: EditorView, edit: LiveEdit, place: NumberPlace, literal: string): NumberPlace {
  const insert = fitting(scan(view.state).text, place, literal);
  const to = place.from + insert.length;
  edit.change({ ...place, insert }, EditorSelection.single(to));
  // `fitting` may put a space in front, which is no part of the number.
  return { from: to - literal.length, to };
}

class NumberHandles {
  decorations: DecorationSet;
  private hold: Hold | null = null;

  constructor(
    private readonly view: EditorView,
    private readonly listener: DragListener,
  ) {
    this.decorations = handles(view);
  }

  update(update: ViewUpdate): void {
    if (update.docChanged || update.viewportChanged) this.decorations = handles(update.view);
  }

  destroy(): void {
    this.release();
  }

  get isHeld(): boolean {
    return this.hold !== null;
  }

  get isDragging(): boolean {
    return this.hold?.edit != null;
  }

  /** Ends a drag and keeps the number as it is. */
  drop(): void {
    if (this.hold) this.finish(true);
  }

  pointerdown(event: PointerEvent): void {
    if (event.button !== 0 || event.ctrlKey || event.metaKey || this.hold) return;
    const isTouch = event.pointerType !== "mouse";
    const place = isTouch ? this.nearest(event) : this.under(event);
    if (!place) return;
    const literal = this.view.state.sliceDoc(place.from, place.to);
    const { clientX, clientY, pointerId } = event;
    this.hold = { pointerId, isTouch, place, literal, startX: clientX, startY: clientY, steppedX: clientX, tenths: 0, edit: null };
    window.addEventListener("pointermove", this.moved);
    window.addEventListener("pointerup", this.lifted);
    window.addEventListener("pointercancel", this.cancelled);
    // Captured, so that Escape ends the drag before the editor's own keys see it.
    window.addEventListener("keydown", this.keyed, true);
  }

  /** Replaces CodeMirror's mouse handling, which would select while dragging. Taps are left to the browser. */
  mousedown(event: MouseEvent): boolean {
    const { hold, view } = this;
    if (!hold || hold.isTouch) return false;
    const place = view.posAtCoords({ x: event.clientX, y: event.clientY }) ?? hold.place.to;
    const line = view.state.doc.lineAt(place);
    let selection = EditorSelection.range(event.shiftKey ? view.state.selection.main.anchor : place, place);
    // A double click selects the number, a triple click its line.
    if (event.detail === 2) selection = EditorSelection.range(hold.place.from, hold.place.to);
    if (event.detail > 2) selection = EditorSelection.range(line.from, line.to);
    view.focus();
    view.dispatch({ selection, userEvent: "select.pointer" });
    return true;
  }

  private readonly moved = (event: PointerEvent): void => {
    const { hold, view } = this;
    if (event.pointerId !== hold?.pointerId) return;
    if (!hold.edit) {
      const [across, along] = [Math.abs(event.clientX - hold.startX), Math.abs(event.clientY - hold.startY)];
      if (across < (hold.isTouch ? CLICK_PX.touch : CLICK_PX.mouse)) return;
      // A vertical stroke scrolls the page.
      if (hold.isTouch && along > across) return this.release();
      hold.edit = new LiveEdit(view);
      view.scrollDOM.classList.add(DRAGGING_CLASS);
      // The pointer is captured by the scroller, because the number's own element is replaced with its text.
      view.scrollDOM.setPointerCapture(event.pointerId);
    }
    event.preventDefault();
    // Whole steps only; the rest of the way counts for the next event.
    const n = Math.trunc((event.clientX - hold.steppedX) / STEP_PX);
    if (n === 0) return;
    hold.steppedX += n * STEP_PX;
    hold.tenths += n * tenthsOf(event);
    // From the text at the start and all steps since, so that the way back leads to the same text.
    hold.place = put(view, hold.edit, hold.place, stepped(hold.literal, hold.tenths));
  };

  private readonly lifted = (event: PointerEvent): void => {
    if (event.pointerId === this.hold?.pointerId) this.finish(true);
  };

  private readonly cancelled = (event: PointerEvent): void => {
    if (event.pointerId === this.hold?.pointerId) this.finish(false);
  };

  private readonly keyed = (event: KeyboardEvent): void => {
    if (event.key !== "Escape" || !this.isDragging) return;
    event.preventDefault();
    event.stopPropagation();
    this.finish(false);
  };

  private finish(isKept: boolean): void {
    const edit = this.hold?.edit;
    if (edit) {
      edit.end(isKept);
      this.release();
      this.listener.ended();
    } else this.release();
  }

  private release(): void {
    this.hold = null;
    this.view.scrollDOM.classList.remove(DRAGGING_CLASS);
    window.removeEventListener("pointermove", this.moved);
    window.removeEventListener("pointerup", this.lifted);
    window.removeEventListener("pointercancel", this.cancelled);
    window.removeEventListener("keydown", this.keyed, true);
  }

  /** The number under a mouse pointer. */
  private under(event: PointerEvent): NumberPlace | undefined {
    const element = event.target instanceof Element ? event.target.closest(`.${NUMBER_CLASS}`) : null;
    return element ? this.placeOf(element) : undefined;
  }

  /** The number nearest to a finger, because the enlarged areas of neighbours overlap. */
  private nearest(event: PointerEvent): NumberPlace | undefined {
    if (!this.under(event)) return undefined;
    let [best, smallest] = [undefined as Element | undefined, REACH_PX];
    for (const element of this.view.contentDOM.querySelectorAll(`.${NUMBER_CLASS}`)) {
      for (const { left, right, top, bottom } of element.getClientRects()) {
        const across = Math.max(left - event.clientX, 0, event.clientX - right);
        const along = Math.max(top - event.clientY, 0, event.clientY - bottom);
        const distance = Math.hypot(across, along);
        if (distance < smallest) [best, smallest] = [element, distance];
      }
    }
    return best && this.placeOf(best);
  }

  private placeOf(element: Element): NumberPlace | undefined {
    // One character into the number, since its start also ends what is before it.
    return numberAt(scan(this.view.state).numbers, this.view.posAtDOM(element) + 1);
  }
}

const handle = Decoration.mark({ class: NUMBER_CLASS });

function handles(view: EditorView): DecorationSet {
  const builder = new RangeSetBuilder<Decoration>();
  const isVisible = (place: NumberPlace) => view.visibleRanges.some(({ from, to }) => place.from >= from && place.to <= to);
  for (const place of scan(view.state).numbers) if (isVisible(place)) builder.add(place.from, place.to, handle);
  return builder.finish();
}

/** The number at the cursor. */
export const numberAtCursor = (state: EditorState): NumberPlace | undefined =>
  numberAt(scan(state).numbers, state.selection.main.head);

/** Changes the number at the cursor, and announces the new value to screen readers. */
export function stepNumber(tenths: number): Command {
  return (view) => {
    const place = numberAtCursor(view.state);
    if (!place) return false;
    const literal = stepped(view.state.sliceDoc(place.from, place.to), tenths);
    const insert = fitting(scan(view.state).text, place, literal);
    view.dispatch({
      changes: { ...place, insert },
      selection: { anchor: place.from + insert.length },
      // Without a user event, quick repetitions are one step of undo, like typing.
      effects: EditorView.announce.of(literal),
      scrollIntoView: true,
    });
    return true;
  };
}

const numberKeys = keymap.of([
  { key: "Alt-ArrowUp", run: stepNumber(STEP.plain), shift: stepNumber(STEP.coarse) },
  { key: "Alt-ArrowDown", run: stepNumber(-STEP.plain), shift: stepNumber(-STEP.coarse) },
]);

export interface Dragging {
  extension: Extension;
  isDragging(view: EditorView): boolean;
  drop(view: EditorView): void;
}

/** Handles for the numbers of one editor. */
export function dragging(listener: DragListener): Dragging {
  const plugin = ViewPlugin.define((view) => new NumberHandles(view, listener), {
    decorations: (handles) => handles.decorations,
    eventHandlers: {
      pointerdown(event) {
        this.pointerdown(event);
      },
      mousedown(event) {
        return this.mousedown(event);
      },
      // Prevents the browser's drag and drop of a selected number.
      dragstart() {
        return this.isHeld;
      },
    },
  });
  return {
    extension: [plugin, numberKeys],
    isDragging: (view) => view.plugin(plugin)?.isDragging ?? false,
    drop: (view) => view.plugin(plugin)?.drop(),
  };
}
