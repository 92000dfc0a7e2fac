// The editor of shape scripts: CodeMirror with the language's own table, errors at their place, and draggable numbers.
//
// It lives in a shadow tree. There CodeMirror adds its styles as constructable style sheets, which the page's policy
// `style-src 'self'` allows; in the document it would add a <style> element, which the policy blocks.
import { closeBrackets, closeBracketsKeymap } from "@codemirror/autocomplete";
import { defaultKeymap, historyKeymap } from "@codemirror/commands";
import { LanguageSupport, bracketMatching, indentOnInput, indentUnit } from "@codemirror/language";
import { pythonLanguage } from "@codemirror/lang-python";
import { Compartment, EditorState, type Extension } from "@codemirror/state";
import { EditorView, highlightActiveLine, highlightActiveLineGutter, keymap, lineNumbers } from "@codemirror/view";
import type { Language } from "../texts";
import { completion } from "./complete";
import { dragging } from "./dragging";
import { KEYS_ID, help } from "./help";
import { LiveEdit, difference, steps } from "./live";
import type { EditorPhrases } from "./phrases";
import { type EditorError, problemAt, problems, setOthers, setProblem } from "./problem";
import { type FunctionRow, table } from "./table";
import { look } from "./theme";

export { difference } from "./live";
export { type ParamCall, paramsOf, withParam } from "./params";
export { EDITOR_PHRASES, type EditorPhrases } from "./phrases";
export type { EditorError } from "./problem";
export type { FunctionRow } from "./table";

/** The table in a language. The command's own sentences are English. */
export async function tableIn(language: Language, functions: readonly FunctionRow[]): Promise<readonly FunctionRow[]> {
  return language === "zh" ? (await import("./functions_zh")).inChinese(functions) : functions;
}

export interface EditorOptions {
  text: string;
  /** The label for screen readers. */
  label: string;
  phrases: EditorPhrases;
  /** Called after every change by the reader; during a drag each time, and once at its end. */
  change(text: string, isDragging: boolean): void;
  /** Called when the reader moves the cursor, with its place in the text. */
  moved?(place: number): void;
}

export interface ScriptEditor {
  readonly text: string;
  /** Texts with `isDragging` (from a slider of the page) are one step of undo, up to the first without. */
  setText(text: string, isDragging?: boolean): void;
  /** Marks mistakes; the panel below the text shows the first. */
  setErrors(errors: readonly EditorError[]): void;
  /** Functions to complete and explain, and other words to complete. */
  setTable(table: readonly FunctionRow[], words: readonly string[]): void;
  focus(): void;
  /** Selects a part of the text and scrolls to it. */
  reveal(from: number, to: number): void;
  dispose(): void;
}

/** The class of the shadow host, which is the target of the editor's events outside of the shadow tree. */
export const HOST_CLASS = "script-editor";

export function createEditor(parent: HTMLElement, options: EditorOptions): ScriptEditor {
  const { phrases, change } = options;
  const tableConfig = new Compartment();
  // The page is not notified of its own changes.
  let [isOfPage, isRevealing] = [false, false];
  let sliderEdit: LiveEdit | null = null;

  const handles = dragging({ ended: () => change(view.state.doc.toString(), false) });
  const changeListener = EditorView.updateListener.of((update) => {
    if (update.selectionSet && !update.docChanged && !isOfPage && !isRevealing) options.moved?.(update.state.selection.main.head);
    if (update.docChanged && !isOfPage) change(update.state.doc.toString(), handles.isDragging(view));
  });

  const host = document.createElement("div");
  host.className = HOST_CLASS;
  host.style.display = "block";
  host.style.height = "100%";
  const root = host.attachShadow({ mode: "open" });
  const keys = document.createElement("p");
  keys.id = KEYS_ID;
  keys.hidden = true;
  keys.textContent = phrases.keys;
  root.append(keys);
  parent.append(host);

  const extensions: Extension = [
    handles.extension,
    problems,
    lineNumbers(),
    highlightActiveLine(),
    highlightActiveLineGutter(),
    steps,
    new LanguageSupport(pythonLanguage),
    indentUnit.of("    "),
    indentOnInput(),
    bracketMatching(),
    closeBrackets(),
    completion(phrases),
    help(phrases),
    look,
    EditorView.lineWrapping,
    // Tab is not bound, so that it leaves the editor.
    keymap.of([...closeBracketsKeymap, ...defaultKeymap, ...historyKeymap]),
    EditorState.phrases.of(phrases.editor),
    EditorView.contentAttributes.of({ tabindex: "0", "aria-label": options.label, translate: "no" }),
    EditorView.contentAttributes.of({ spellcheck: "false", autocorrect: "off", autocapitalize: "off" }),
    tableConfig.of([]),
    changeListener,
  ];
  const view = new EditorView({ root, parent: root, state: EditorState.create({ doc: options.text, extensions }) });

  return {
    get text() {
      return view.state.doc.toString();
    },
    setText(text, isDragging = false) {
      // CodeMirror normalizes line ends.
      const changes = difference(view.state.doc.toString(), text.replace(/\r\n?/g, "\n"));
      isOfPage = true;
      if (changes) {
        // A drag in the editor would go on at a place that has moved.
        handles.drop(view);
        sliderEdit ??= new LiveEdit(view);
        sliderEdit.change(changes);
      }
      if (!isDragging) {
        sliderEdit?.end(true);
        sliderEdit = null;
      }
      isOfPage = false;
    },
    setErrors(errors) {
      const [first, ...others] = errors.map((error) => problemAt(view.state.doc, error));
      view.dispatch({ effects: [setProblem.of(first ?? null), setOthers.of(others)] });
    },
    setTable(functions, words) {
      const rows = new Map(functions.map((row) => [row.name, row]));
      view.dispatch({ effects: tableConfig.reconfigure(table.of({ rows, words })) });
    },
    focus: () => view.focus(),
    reveal(from, to) {
      const end = Math.min(to, view.state.doc.length);
      isRevealing = true;
      view.dispatch({ selection: { anchor: Math.min(from, end), head: end }, effects: EditorView.scrollIntoView(Math.min(from, end), { y: "center" }) });
      isRevealing = false;
    },
    dispose() {
      view.destroy();
      host.remove();
    },
  };
}
