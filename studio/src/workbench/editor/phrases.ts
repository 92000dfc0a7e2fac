// The editor's own texts, besides the script and the help on its functions.
import type { Language } from "../texts";

export interface EditorPhrases {
  /** Instructions for screen readers. */
  keys: string;
  /** Shown instead of a function's help if the cursor is in none. */
  hint: string;
  /** The same for touch screens. */
  hintForTouch: string;
  /** Between two sentences. */
  gap: string;
  asDistance(worth: string): string;
  line(n: number): string;
  less: string;
  more: string;
  parameter: string;
  word: string;
  ownName: string;
  /** Translations of CodeMirror's own texts. */
  editor: Record<string, string>;
}

export const EDITOR_PHRASES: Record<Language, EditorPhrases> = {
  en: {
    keys: "Tab leaves the editor. Alt with arrow up or down changes the number at the cursor, with Shift ten times as much. Control and space completes a name. F8 goes to the error.",
    hint: "Drag numbers, or Alt + ↑ ↓; Ctrl + Space completes.",
    hintForTouch: "Drag a number, or tap it for − and +.",
    gap: " ",
    asDistance: (worth) => `The value is: ${worth}.`,
    line: (n) => `Line ${n}`,
    less: "One step less",
    more: "One step more",
    parameter: "parameter",
    word: "word",
    ownName: "in this script",
    editor: {},
  },
  zh: {
    keys: "按 Tab 键离开编辑器。按住 Alt 再按上、下方向键，可改变光标处的数字；同时按住 Shift，步长变为十倍。Ctrl 加空格补全名称。F8 跳到出错处。",
    hint: "拖动数字，或按 Alt + ↑ ↓。Ctrl + 空格补全。",
    hintForTouch: "拖动数字，或点一下再用 − 和 + 改变。",
    gap: "",
    asDistance: (worth) => `函数值作为距离：${worth}。`,
    line: (n) => `第 ${n} 行`,
    less: "减一步",
    more: "加一步",
    parameter: "参数",
    word: "关键字",
    ownName: "本脚本中的名称",
    editor: {
      Completions: "补全",
      "Control character": "控制字符",
      "Selection deleted": "已删除所选内容",
      close: "关闭",
      to: "至",
      Undo: "撤销",
      Redo: "重做",
    },
  },
};
