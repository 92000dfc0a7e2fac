// The panel below the text: the error with its place, help on the function at the cursor, and buttons for its number.
import { selectedCompletion } from "@codemirror/autocomplete";
import type { EditorState, Extension } from "@codemirror/state";
import { EditorView, type Panel, type ViewUpdate, showPanel } from "@codemirror/view";
import { card } from "./card";
import { numberAtCursor, stepNumber } from "./dragging";
import { STEP } from "./numbers";
import type { EditorPhrases } from "./phrases";
import { goToProblem, problemField, problemLine, speak } from "./problem";
import { scan } from "./scan";
import { callAt, functionAt, table } from "./table";

export const KEYS_ID = "editor-keys";
export const PROBLEM_ID = "editor-problem";

function button(text: string, label: string, press: () => void): HTMLButtonElement {
  const created = document.createElement("button");
  created.type = "button";
  created.textContent = text;
  if (label) created.setAttribute("aria-label", label);
  // Keeps the focus, and with it a phone's keyboard, in the editor.
  created.addEventListener("pointerdown", (event) => event.preventDefault());
  created.addEventListener("mousedown", (event) => event.preventDefault());
  created.addEventListener("click", press);
  return created;
}

class HelpPanel implements Panel {
  readonly dom = document.createElement("div");
  private readonly problem = document.createElement("div");
  private readonly place: HTMLButtonElement;
  private readonly message = document.createElement("span");
  private readonly help = document.createElement("div");
  private readonly stepper = document.createElement("div");
  private readonly value = document.createElement("code");
  private shownError = "";

  constructor(
    private readonly view: EditorView,
    private readonly phrases: EditorPhrases,
  ) {
    this.place = button("", "", () => goToProblem(view));
    this.problem.id = PROBLEM_ID;
    this.problem.className = "cm-problemPanel";
    // A live region must exist before it is filled, or screen readers ignore it.
    this.problem.setAttribute("role", "status");
    this.problem.setAttribute("aria-live", "polite");
    this.message.className = "cm-problemText";
    this.help.className = "cm-help";
    this.stepper.className = "cm-stepper";
    const [less, more] = [stepNumber(-STEP.plain), stepNumber(STEP.plain)];
    this.stepper.append(button("−", phrases.less, () => less(view)), this.value, button("+", phrases.more, () => more(view)));
    const below = document.createElement("div");
    below.className = "cm-below";
    below.append(this.help, this.stepper);
    this.dom.append(this.problem, below);
    this.show();
  }

  update(update: ViewUpdate): void {
    const { startState, state } = update;
    const shownIn = (state: EditorState) => [state.facet(table), state.field(problemField), selectedCompletion(state)];
    const [before, after] = [shownIn(startState), shownIn(state)];
    if (update.docChanged || update.selectionSet || after.some((part, k) => part !== before[k])) this.show();
  }

  private show(): void {
    const { state } = this.view;
    const problem = state.field(problemField);
    const line = problemLine(state);
    const error = problem && line !== null ? `${line} ${problem.message}` : "";
    // Writing the same text again would make screen readers repeat it.
    if (error !== this.shownError) {
      this.shownError = error;
      this.place.textContent = line === null ? "" : this.phrases.line(line);
      this.message.textContent = problem?.message ?? "";
      speak(this.message, problem);
      this.problem.replaceChildren(...(problem ? [this.place, this.message] : []));
    }
    this.help.replaceChildren(this.helpAtCursor());
    const number = numberAtCursor(state);
    this.stepper.hidden = !number;
    this.value.textContent = number ? state.sliceDoc(number.from, number.to) : "";
  }

  /** Help on the selected completion, else on the name at the cursor, else on the call around it, else a general hint. */
  private helpAtCursor(): Node {
    const { state } = this.view;
    const { head } = state.selection.main;
    const { text, tokens } = scan(state);
    const { rows } = state.facet(table);
    const chosen = rows.get(selectedCompletion(state)?.label ?? "");
    if (chosen) return card(chosen, -1, this.phrases);
    const named = functionAt(text, tokens, head, rows);
    if (named) return card(named.row, -1, this.phrases);
    const call = callAt(text, tokens, head, rows);
    if (call) return card(call.row, call.parameter, this.phrases);
    const hint = document.createElement("p");
    hint.textContent = matchMedia("(pointer: coarse)").matches ? this.phrases.hintForTouch : this.phrases.hint;
    return hint;
  }
}

export function help(phrases: EditorPhrases): Extension {
  return [
    showPanel.of((view) => new HelpPanel(view, phrases)),
    EditorView.contentAttributes.of({ "aria-describedby": KEYS_ID, "aria-errormessage": PROBLEM_ID }),
  ];
}
