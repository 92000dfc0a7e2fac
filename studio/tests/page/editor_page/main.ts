// A page with only the editor, for its tests: it records the editor's notifications, and tests can control it.
import { EDITOR_PHRASES, type FunctionRow, createEditor, tableIn } from "../../../src/workbench/editor";

const query = new URLSearchParams(location.search);
const language = query.get("lang") === "zh" ? "zh" : "en";
document.documentElement.lang = language;
document.documentElement.dataset["theme"] = query.get("theme") ?? "light";
const changes: [string, boolean][] = [];
const editor = createEditor(document.getElementById("place")!, {
  text: query.get("text") ?? "",
  label: language === "zh" ? "脚本" : "Script",
  phrases: EDITOR_PHRASES[language],
  change: (text, isDragging) => changes.push([text, isDragging]),
});
const setTable = async (rows: FunctionRow[], words: string[]) => editor.setTable(await tableIn(language, rows), words);
Object.assign(window, { editor, changes, setTable });
