// Numbers of the script as handles: dragged with a mouse or a finger, stepped with keys and buttons.
import { type EditorState, EditorSelection, type Extension, RangeSetBuilder } from "@codemirror/state";
import { type Command, Decoration, type DecorationSet, EditorView, ViewPlugin, type ViewUpdate, keymap } from "@codemirror/view";
import { LiveEdit } from "./live";
import { type NumberPlace, STEP, fitting, numberAt, stepped } from "./numbers";
import { scan } from "./scan";

/** The way of the pointer that is one step, in CSS pixels: a hundred are twenty steps. Chosen by trying. */
const STEP_PX = 5;
/** From how far on it is a drag and no click: a mouse stands still, a finger does not. Chosen by trying. */
const CLICK_PX = { mouse: 3, touch: 8 };
/** How far beside a number a finger still means it, in CSS pixels: half of the 44 that WCAG 2.5.5 asks for. */
const REACH_PX = 22;

const NUMBER_CLASS = "cm-number";
/** On the part that scrolls, for as long as a number is dragged. */
const DRAGGING_CLASS = "cm-dragging";

export interface DragListener {
  /** After a drag: the text is as it stays. */
  ended(): void;
}

/** One pointer that is down on a number. */
interface Hold {
  pointerId: number;
  isTouch: boolean;
  place: NumberPlace;
  /** As it was when the pointer came down. */
  literal: string;
  startX: number;
  startY: number;
  /** Up to where the way has been turned into steps. */
  paidX: number;
  tenths: number;
  /** Once it is a drag. */
  edit: LiveEdit | null;
}

const tenthsOf = (event: { shiftKey: boolean; altKey: boolean }): number => {
  if (event.altKey) return STEP.fine;
  return event.shiftKey ? STEP.coarse : STEP.plain;
};

/** Puts a literal in the place of a number; the cursor stays behind it. */
function put(view: EditorView, edit: LiveEdit, place: NumberPlace, literal: string): NumberPlace {
  const insert = fitting(scan(view.state).text, place, literal);
  const to = place.from + insert.length;
  edit.change({ ...place, insert }, EditorSelection.single(to));
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

  /** Gives the number up that is being dragged, and leaves it as it is. */
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
    this.hold = { pointerId, isTouch, place, literal, startX: clientX, startY: clientY, paidX: clientX, tenths: 0, edit: null };
    window.addEventListener("pointermove", this.moved);
    window.addEventListener("pointerup", this.lifted);
    window.addEventListener("pointercancel", this.cancelled);
    window.addEventListener("keydown", this.keyed, true);
  }

  /** A click with a mouse, in place of CodeMirror's: dragging is not to select. A tap is left to the browser. */
  mousedown(event: MouseEvent): boolean {
    const { hold, view } = this;
    if (!hold || hold.isTouch) return false;
    const place = view.posAtCoords({ x: event.clientX, y: event.clientY }) ?? hold.place.to;
    const line = view.state.doc.lineAt(place);
    let selection = EditorSelection.range(event.shiftKey ? view.state.selection.main.anchor : place, place);
    // The second click of a double one takes the number, the third its line.
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
      // What goes up or down is meant for the page.
      if (hold.isTouch && along > across) return this.release();
      hold.edit = new LiveEdit(view);
      view.scrollDOM.classList.add(DRAGGING_CLASS);
      // The number's own element goes with its text.
      view.scrollDOM.setPointerCapture(event.pointerId);
    }
    event.preventDefault();
    const n = Math.trunc((event.clientX - hold.paidX) / STEP_PX);
    if (n === 0) return;
    hold.paidX += n * STEP_PX;
    hold.tenths += n * tenthsOf(event);
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

  /** The number that a mouse is on. */
  private under(event: PointerEvent): NumberPlace | undefined {
    const element = event.target instanceof Element ? event.target.closest(`.${NUMBER_CLASS}`) : null;
    return element ? this.placeOf(element) : undefined;
  }

  /** The number that a finger means: the areas of neighbours overlap. */
  private nearest(event: PointerEvent): NumberPlace | undefined {
    if (!this.under(event)) return undefined;
    let [best, least] = [undefined as Element | undefined, REACH_PX];
    for (const element of this.view.contentDOM.querySelectorAll(`.${NUMBER_CLASS}`)) {
      for (const { left, right, top, bottom } of element.getClientRects()) {
        const across = Math.max(left - event.clientX, 0, event.clientX - right);
        const along = Math.max(top - event.clientY, 0, event.clientY - bottom);
        const away = Math.hypot(across, along);
        if (away < least) [best, least] = [element, away];
      }
    }
    return best && this.placeOf(best);
  }

  private placeOf(element: Element): NumberPlace | undefined {
    return numberAt(scan(this.view.state).numbers, this.view.posAtDOM(element) + 1);
  }
}

const handle = Decoration.mark({ class: NUMBER_CLASS });

function handles(view: EditorView): DecorationSet {
  const builder = new RangeSetBuilder<Decoration>();
  const seen = (place: NumberPlace) => view.visibleRanges.some(({ from, to }) => place.from >= from && place.to <= to);
  for (const place of scan(view.state).numbers) if (seen(place)) builder.add(place.from, place.to, handle);
  return builder.finish();
}

/** The number that the cursor stands at. */
export const numberAtCursor = (state: EditorState): NumberPlace | undefined =>
  numberAt(scan(state).numbers, state.selection.main.head);

/** Changes the number at the cursor, and says what it is now to who cannot see it. */
export function stepNumber(tenths: number): Command {
  return (view) => {
    const place = numberAtCursor(view.state);
    if (!place) return false;
    const literal = stepped(view.state.sliceDoc(place.from, place.to), tenths);
    const insert = fitting(scan(view.state).text, place, literal);
    view.dispatch({
      changes: { ...place, insert },
      selection: { anchor: place.from + insert.length },
      // Without an event of its own what comes fast is one step of undo, as typing is.
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
      // A number that is selected is changed, and not carried off.
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
