// A page with nothing but the editor, for its tests: what it says to its page is kept, and it can be spoken to from outside.
import { EDITOR_PHRASES, type FunctionRow, createEditor, tableIn } from "../../../src/workbench/editor";

const query = new URLSearchParams(location.search);
const language = query.get("lang") === "zh" ? "zh" : "en";
document.documentElement.lang = language;
document.documentElement.dataset["theme"] = query.get("theme") ?? "light";
const told: [string, boolean][] = [];
const editor = createEditor(document.getElementById("place")!, {
  text: query.get("text") ?? "",
  label: language === "zh" ? "脚本" : "Script",
  phrases: EDITOR_PHRASES[language],
  change: (text, isDragging) => told.push([text, isDragging]),
});
const setTable = async (rows: FunctionRow[], words: string[]) => editor.setTable(await tableIn(language, rows), words);
Object.assign(window, { editor, told, setTable });
