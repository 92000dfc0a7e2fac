// The look of the editor, in the page's colours: custom properties are inherited by the shadow tree, so themes apply.
import { HighlightStyle, syntaxHighlighting } from "@codemirror/language";
import type { Extension } from "@codemirror/state";
import { EditorView } from "@codemirror/view";
import { tags } from "@lezer/highlight";

/** Touch screens. WCAG 2.5.5 asks for targets of 44 by 44 CSS pixels. */
const FINGER = "@media (pointer: coarse)";
const row = { display: "flex", gap: "var(--space-3)" };
const focusRing = { outline: "3px solid var(--focus)", outlineOffset: "0" };
const floating = {
  backgroundColor: "var(--raised)",
  color: "var(--ink)",
  border: "1px solid var(--line)",
  borderRadius: "var(--radius)",
};

const theme = EditorView.theme({
  "&": { height: "100%", backgroundColor: "var(--raised)", color: "var(--ink)" },
  "&.cm-focused": focusRing,
  // Horizontal strokes drag numbers, and lines are wrapped, so only vertical panning is left to the browser. Set on the whole
  // text, because a number's element is replaced when its text changes, and Chromium then uses its ancestor's value.
  ".cm-scroller": { font: "0.82rem/1.55 var(--mono)", overflow: "auto", touchAction: "pan-y pinch-zoom" },
  ".cm-scroller.cm-dragging, .cm-scroller.cm-dragging *": { cursor: "ew-resize !important" },
  ".cm-content": { caretColor: "var(--ink)", minHeight: "6rem", minWidth: "0" },
  ".cm-gutters": { backgroundColor: "var(--raised)", color: "var(--soft)", border: "0", borderRight: "1px solid var(--line)" },
  ".cm-activeLine": { backgroundColor: "color-mix(in srgb, var(--grid) 45%, transparent)" },
  ".cm-activeLineGutter": { backgroundColor: "var(--grid)", color: "var(--ink)" },
  "&.cm-focused .cm-matchingBracket": { backgroundColor: "var(--curve)", color: "inherit" },
  "&.cm-focused .cm-nonmatchingBracket": { backgroundColor: "transparent", color: "var(--gap)" },

  // A number must be recognizable as a handle without hovering, too.
  ".cm-number": { cursor: "ew-resize", borderBottom: "1px dotted var(--other)", position: "relative" },
  ".cm-number:hover": { borderBottomStyle: "solid", backgroundColor: "color-mix(in srgb, var(--other) 14%, transparent)" },

  ".cm-problem": { textDecoration: "underline wavy var(--gap)", textUnderlineOffset: "0.2em", textDecorationSkipInk: "none" },
  ".cm-problemSpot": { boxShadow: "inset 0 -2px var(--gap)" },
  ".cm-gutterElement.cm-problemLine": { color: "var(--gap)", fontWeight: "700", boxShadow: "inset 3px 0 var(--gap)" },
  ".cm-problemText": { color: "var(--gap)", whiteSpace: "pre-wrap", overflowWrap: "anywhere" },

  ".cm-panels": { backgroundColor: "var(--paper)", color: "var(--ink)", font: "var(--text-small)/1.5 var(--sans)", zIndex: "1" },
  ".cm-panels.cm-panels-bottom": { borderTop: "1px solid var(--line)" },
  // Empty but not hidden: a hidden element is no live region.
  ".cm-problemPanel:not(:empty)": { ...row, alignItems: "baseline", padding: "var(--space-1) var(--space-3)" },
  // Of one height while one writes, so that the editor does not jump when the cursor moves: two lines. Before, as high as the hint.
  ".cm-below": { ...row, alignItems: "start", maxHeight: "3.1rem", overflow: "auto", padding: "var(--space-1) var(--space-3)" },
  "&.cm-focused .cm-below": { height: "3.1rem" },
  ".cm-help": { flex: "1", minWidth: "0", color: "var(--soft)" },
  ".cm-help p, .cm-card p": { margin: "0", font: "var(--text-small)/1.5 var(--sans)" },
  ".cm-usage": { font: "var(--text-small)/1.5 var(--mono)", color: "var(--ink)", overflowWrap: "anywhere" },
  ".cm-usage b": { color: "var(--chain)", textDecoration: "underline" },
  ".cm-stepper": { display: "flex", gap: "var(--space-2)", alignItems: "center" },
  ".cm-stepper[hidden]": { display: "none" },
  ".cm-stepper code": { font: "var(--text-control) var(--mono)", minWidth: "3ch", textAlign: "center" },
  ".cm-panels button": {
    font: "inherit",
    minWidth: "2rem",
    minHeight: "2rem",
    padding: "0 var(--space-2)",
    flex: "none",
    color: "var(--ink)",
    backgroundColor: "var(--raised)",
    border: "1px solid var(--line)",
    borderRadius: "var(--radius)",
    cursor: "pointer",
  },
  ".cm-panels button:focus-visible": { outline: "3px solid var(--focus)", outlineOffset: "1px" },

  ".cm-tooltip": floating,
  ".cm-tooltip.cm-tooltip-hover": { maxWidth: "min(32rem, 90vw)" },
  ".cm-tooltip .cm-card": { padding: "var(--space-2) var(--space-3)" },
  ".cm-tooltip p.cm-card": { margin: "0", font: "var(--text-small)/1.5 var(--sans)" },
  ".cm-tooltip.cm-tooltip-autocomplete > ul": { fontFamily: "var(--mono)", fontSize: "var(--text-small)", maxHeight: "14rem" },
  ".cm-tooltip.cm-tooltip-autocomplete > ul > li": { padding: "0.15rem var(--space-2)" },
  ".cm-tooltip-autocomplete ul li[aria-selected]": { backgroundColor: "var(--chain)", color: "var(--raised)" },
  ".cm-completionDetail": { color: "var(--soft)", fontStyle: "normal" },
  "li[aria-selected] .cm-completionDetail": { color: "inherit" },
  ".cm-completionMatchedText": { textDecoration: "underline", textDecorationThickness: "2px" },
  ".cm-tooltip.cm-completionInfo": { ...floating, padding: "0", maxWidth: "min(22rem, 80vw)" },

  // There it would cover the other completions; the panel below has the same text.
  "@media (max-width: 40rem)": { ".cm-tooltip.cm-completionInfo": { display: "none" } },
  [FINGER]: {
    // Below 16 px, phones zoom the page when a text is edited.
    ".cm-scroller": { fontSize: "16px", lineHeight: "2" },
    // 20 px of digits and 12 px above and below make 44.
    ".cm-number::after": { content: "''", position: "absolute", inset: "-12px -13px" },
    ".cm-panels button": { minWidth: "44px", minHeight: "44px" },
    ".cm-tooltip.cm-tooltip-autocomplete > ul > li": { padding: "0.6rem var(--space-2)" },
  },
});

const highlight = HighlightStyle.define([
  { tag: [tags.keyword, tags.operatorKeyword, tags.controlKeyword, tags.definitionKeyword], color: "var(--focus)" },
  { tag: [tags.function(tags.variableName), tags.function(tags.definition(tags.variableName))], color: "var(--chain)" },
  { tag: [tags.number, tags.bool, tags.null], color: "var(--other)" },
  { tag: tags.string, color: "var(--good)" },
  { tag: tags.comment, color: "var(--soft)", fontStyle: "italic" },
]);

export const look: Extension = [theme, syntaxHighlighting(highlight)];
