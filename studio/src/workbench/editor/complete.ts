// Completion from the language's table, and tooltips on names and errors.
import { type Completion, type CompletionContext, type CompletionResult, autocompletion } from "@codemirror/autocomplete";
import type { Extension } from "@codemirror/state";
import { type EditorView, hoverTooltip } from "@codemirror/view";
import { card } from "./card";
import type { EditorPhrases } from "./phrases";
import { problemField, speak } from "./problem";
import { type Scan, scan } from "./scan";
import { type FunctionRow, callAt, functionAt, parameterName, parametersOf, table } from "./table";
import { tokenBefore } from "./tokens";

const WORD = /[\p{L}_][\p{L}\p{N}_]*/u;
const ONLY_WORD = /^[\p{L}\p{N}_]*$/u;

/** The order of completions, at most 99: parameters of the call first, in their order, then names defined in the script. */
const BOOST = { parameter: 99, own: 1 };

/** Inserts a function with parentheses; the cursor goes between them if it has parameters. */
function called(row: FunctionRow): Completion["apply"] {
  return (view: EditorView, _: Completion, from: number, to: number) => {
    const isCalled = view.state.sliceDoc(to, to + 1) === "(";
    const insert = isCalled ? row.name : `${row.name}()`;
    const inside = isCalled || parametersOf(row).length === 0 ? 0 : 1;
    const anchor = from + insert.length - inside;
    view.dispatch({ changes: { from, to, insert }, selection: { anchor }, userEvent: "input.complete" });
  };
}

/** The names that a script defines, without the names of arguments in calls. */
function definedNames({ text, tokens }: Scan, place: number, isKnown: (name: string) => boolean): string[] {
  const names = new Set<string>();
  tokens.forEach(({ kind, from, to, depth }, k) => {
    const next = tokens[k + 1];
    const isArgument = depth > 0 && next !== undefined && text.slice(next.from, next.to) === "=";
    // A name that is still being typed is not defined yet.
    const isTyped = from < place && place <= to;
    if (kind === "name" && !isArgument && !isTyped) names.add(text.slice(from, to));
  });
  return [...names].filter((name) => !isKnown(name));
}

function complete(phrases: EditorPhrases) {
  return (context: CompletionContext): CompletionResult | null => {
    const word = context.matchBefore(WORD);
    if (!word && !context.explicit) return null;
    const from = word?.from ?? context.pos;
    const scanned = scan(context.state);
    const token = tokenBefore(scanned.tokens, context.pos);
    // A string is over directly after its end; a comment or a number could continue there.
    const isText = token && (token.kind === "string" ? token.to > context.pos : ["comment", "number", "odd"].includes(token.kind));
    if (isText || scanned.text[from - 1] === ".") return null;
    const { rows, words } = context.state.facet(table);
    const call = callAt(scanned.text, scanned.tokens, from, rows);
    const callParameters = call && /[(,]\s*$/.test(scanned.text.slice(0, from)) ? parametersOf(call.row) : [];
    const parameters = callParameters.filter((parameter) => !parameter.startsWith("*"));
    const isKnown = (name: string) => rows.has(name) || words.includes(name);
    const options: Completion[] = [
      ...parameters.map((parameter, k) => ({
        label: `${parameterName(parameter)}=`,
        type: "property",
        detail: phrases.parameter,
        boost: BOOST.parameter - k,
      })),
      ...definedNames(scanned, context.pos, isKnown).map((label) => ({
        label,
        type: "variable",
        detail: phrases.ownName,
        boost: BOOST.own,
      })),
      ...[...rows.values()].map((row) => ({
        label: row.name,
        type: "function",
        detail: row.usage.slice(row.name.length),
        apply: called(row),
        info: () => card(row, -1, phrases),
      })),
      ...words.map((label) => ({ label, type: "keyword", detail: phrases.word })),
    ];
    return { from, options, validFor: ONLY_WORD };
  };
}

function hover(phrases: EditorPhrases): Extension {
  return hoverTooltip(({ state }, place) => {
    const problem = state.field(problemField);
    if (problem && problem.from <= place && place < problem.to) {
      const create = () => {
        const dom = document.createElement("p");
        dom.className = "cm-card cm-problemText";
        dom.textContent = problem.message;
        speak(dom, problem);
        return { dom };
      };
      return { pos: problem.from, end: problem.to, create };
    }
    const { text, tokens } = scan(state);
    const named = functionAt(text, tokens, place, state.facet(table).rows);
    if (!named) return null;
    return { pos: named.token.from, end: named.token.to, create: () => ({ dom: card(named.row, -1, phrases) }) };
  });
}

export function completion(phrases: EditorPhrases): Extension {
  return [autocompletion({ override: [complete(phrases)], icons: false }), hover(phrases)];
}
