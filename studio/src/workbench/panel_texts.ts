// The texts of the panels beside the picture that are about files: exports, scripts in files, the shelf, what is asked for.
import type { Example } from "./examples";
import type { Language } from "./texts";

interface PanelTexts {
  exportHint: string;
  exportWaiting(name: string): string;
  exportWritten(name: string, size: string): string;
  exportFailed(name: string): string;
  exportNoProof: string;
  exportChanged: string;
  carried(file: string, script: string): string;
  carriedRunning: string;
  carriedVerdicts: Record<"re-proved" | "not re-proved" | "refuted", string>;
  carriedUnknown: string;
  showFile(name: string): string;
  dismiss: string;
  shelf: string;
  scriptName: string;
  save: string;
  saveInPlace: string;
  saveDownload: string;
  saveRefused: string;
  keep: string;
  isSaved: string;
  isInBrowser: string;
  isNotKept: string;
  inBrowserOnly: string;
  shelfFaults: Record<"refused" | "full", (most: string) => string>;
  shelfLimit(most: string): string;
  close: string;
  newScript: string;
  openStar: string;
  empty: string;
  deleted(name: string): string;
  restore: string;
  duplicate: string;
  duplicateOf(name: string): string;
  delete: string;
  deleteOf(name: string): string;
  examplesTitle: string;
  examples: Record<Example, string>;
  ask: string;
  askFile(name: string): string;
  askFontArgument: string;
  chooseFont: string;
  chooseFile: string;
  askText: string;
  askHeight: string;
  raise: string;
  askLevel: string;
  levelRange(low: string, high: string): string;
  levelSuggested(level: string): string;
  levelReset: string;
  touching: string;
  /** The same in the line below the picture. */
  touchingShort: string;
  /** Goes to the k-th of several places where the same parts touch. */
  goToPlace(k: number): string;
  /** A contact at a point; the lines of the script that made the two parts, if they are known. */
  touchingSays(at: string, lines: readonly string[] | null): string;
  touchingCure: string;
  edgesSay(n: string): string;
  goThere: string;
}

export const PANEL_TEXTS: Record<Language, PanelTexts> = {
  en: {
    exportHint: "The mesh above, as it was proved, with its certificate. GLB and 3MF also carry the script. Tiles and levels are made anew.",
    exportWaiting: (name) => `${name} is being made.`,
    exportWritten: (name, size) => `${name}: ${size} written.`,
    exportFailed: (name) => `${name} was not written.`,
    exportNoProof: "There is no proved mesh of this input: its proof was stopped or failed.",
    exportChanged: "The shape changed before it was proved. Press again for the new one.",
    carried: (file, script) => `${file} carries its script, so ${script} was opened.`,
    carriedRunning: "The file is being proved again from it.",
    carriedVerdicts: {
      "re-proved": "Every claim of the file was proved again from it.",
      "not re-proved": "Not every claim of the file was proved again:",
      refuted: "A claim of the file is wrong:",
    },
    carriedUnknown: "The file itself was not proved again.",
    showFile: (name) => `Show ${name} itself`,
    dismiss: "Dismiss",
    shelf: "Scripts and examples",
    scriptName: "Name",
    save: "Save .star",
    saveInPlace: "Ctrl+S saves into the same file",
    saveDownload: "Ctrl+S downloads the file",
    saveRefused: "The file could not be written; the script is still kept in this browser.",
    keep: "Keep this script",
    isSaved: "Saved to a file",
    isInBrowser: "Kept in this browser, with changes that no file has",
    isNotKept: "Not kept: the next script replaces it",
    inBrowserOnly: "changes that no file has",
    shelfFaults: {
      refused: () => "This browser does not let the page keep anything. Save scripts to files before you leave.",
      full: (most) => `The shelf is full (${most}): the last changes are not kept. Delete a script, or save it to a file.`,
    },
    shelfLimit: (most) => `Kept in this browser only, ${most} at most; clearing its data clears them. Fonts and other files that scripts read are kept beside them, 64 MB at most.`,
    close: "Close",
    newScript: "New script",
    openStar: "Open a .star file…",
    empty: "Nothing here yet. A script that you keep is listed here, and is there again when you come back.",
    deleted: (name) => `${name} was deleted.`,
    restore: "Undo",
    duplicate: "Duplicate",
    duplicateOf: (name) => `Duplicate ${name}`,
    delete: "Delete",
    deleteOf: (name) => `Delete ${name}`,
    examplesTitle: "Examples",
    examples: {
      bracket: "Bracket",
      enclosure: "Enclosure for a circuit board",
      gear: "Gear",
      vase: "Vase",
      angle_bracket: "Angle bracket",
      twisted_bolt: "Bolt",
      badge: "Badge in three colours",
      block: "Drilled block",
      gyroid_cube: "Gyroid in a cube",
      gyroid: "Gyroid in a ball",
      creature: "Creature",
      blobs: "Melting drops",
      sponge: "Menger's sponge",
    },
    ask: "What is still missing",
    askFile: (name) => `The script reads ${name}, which is not open here.`,
    askFontArgument: "text() sets its letters in a font, and the script names none. Choose a TrueType or OpenType file.",
    chooseFont: "Choose the font…",
    chooseFile: "Choose the file…",
    askText: "Which text should the font set?",
    askHeight: "Raise to a height (empty: leave it flat)",
    raise: "Raise it",
    askLevel: "Surface at the value",
    levelRange: (low, high) => `The samples are from ${low} to ${high}.`,
    levelSuggested: (level) => `Suggested: ${level}.`,
    levelReset: "Use the suggested value",
    touching: "Parts that only touch",
    touchingShort: "parts only touch",
    goToPlace: (k) => `Go to place ${k}`,
    touchingSays: (at, lines) =>
      (lines ? (lines[0] === lines[1] ? `Parts made in line ${lines[0]} touch` : `Parts made in lines ${lines[0]} and ${lines[1]} touch`) : "Two parts touch") +
      ` at (${at}) without overlapping.`,
    touchingCure: "Let them overlap by a little more than the error that may be seen, or move them apart by as much.",
    edgesSay: (n) => `Edges with more than two triangles, where parts touch: ${n}.`,
    goThere: "Go there",
  },
  zh: {
    exportHint: "导出的就是上面已证明的网格，连同证书。GLB 和 3MF 还带有脚本。瓦片和层次则重新生成。",
    exportWaiting: (name) => `正在生成 ${name}。`,
    exportWritten: (name, size) => `已写出 ${name}，${size}。`,
    exportFailed: (name) => `没有写出 ${name}。`,
    exportNoProof: "当前输入没有已证明的网格：证明已停止或失败。",
    exportChanged: "证明完成之前形状已经改变。如要导出新的形状，请再按一次。",
    carried: (file, script) => `${file} 带有自己的脚本，因此打开了 ${script}。`,
    carriedRunning: "正在由脚本重新证明这个文件。",
    carriedVerdicts: {
      "re-proved": "文件的每一项声明都已由脚本重新证明。",
      "not re-proved": "文件的声明没有全部重新证明：",
      refuted: "文件有一项声明是错的：",
    },
    carriedUnknown: "文件本身没有重新证明。",
    showFile: (name) => `显示 ${name} 本身`,
    dismiss: "关闭",
    shelf: "脚本与示例",
    scriptName: "名称",
    save: "保存 .star",
    saveInPlace: "Ctrl+S 存回同一个文件",
    saveDownload: "Ctrl+S 下载文件",
    saveRefused: "文件没有写成；脚本仍保存在本浏览器中。",
    keep: "保留这个脚本",
    isSaved: "已存为文件",
    isInBrowser: "保存在本浏览器中；有改动尚未存为文件",
    isNotKept: "未保留：打开另一个脚本就会被取代",
    inBrowserOnly: "有改动尚未存为文件",
    shelfFaults: {
      refused: () => "浏览器不允许本页保存内容。离开之前请把脚本存为文件。",
      full: (most) => `书架已满（${most}），最近的改动没有保存。请删除一个脚本，或把它存为文件。`,
    },
    shelfLimit: (most) => `只保存在本浏览器中，总共至多 ${most}；清除浏览数据会一并清除。脚本读取的字体等文件也保存在旁边，至多 64 MB。`,
    close: "关闭",
    newScript: "新建脚本",
    openStar: "打开 .star 文件…",
    empty: "这里还是空的。你保留的脚本会列在这里，下次打开时仍在。",
    deleted: (name) => `已删除 ${name}。`,
    restore: "撤销",
    duplicate: "复制一份",
    duplicateOf: (name) => `把 ${name} 复制一份`,
    delete: "删除",
    deleteOf: (name) => `删除 ${name}`,
    examplesTitle: "示例",
    examples: {
      bracket: "支架",
      enclosure: "电路板外壳",
      gear: "齿轮",
      vase: "花瓶",
      angle_bracket: "角码",
      twisted_bolt: "螺栓",
      badge: "三色徽章",
      block: "钻孔方块",
      gyroid_cube: "立方体中的 Gyroid 曲面",
      gyroid: "球中的 Gyroid 曲面",
      creature: "小怪物",
      blobs: "相融的水滴",
      sponge: "门格海绵",
    },
    ask: "还缺什么",
    askFile: (name) => `脚本要读取 ${name}，但这里没有打开它。`,
    askFontArgument: "text() 要用一款字体来排文字，而脚本没有指定。请选择一个 TrueType 或 OpenType 文件。",
    chooseFont: "选择字体…",
    chooseFile: "选择文件…",
    askText: "用这款字体排什么文字？",
    askHeight: "拉伸高度（留空则保持平面）",
    raise: "拉伸成实体",
    askLevel: "等值面的取值",
    levelRange: (low, high) => `采样值从 ${low} 到 ${high}。`,
    levelSuggested: (level) => `建议取 ${level}。`,
    levelReset: "改用建议值",
    touching: "只是相接的部分",
    touchingShort: "有些部分只是相接",
    goToPlace: (k) => `转到第 ${k} 处`,
    touchingSays: (at, lines) =>
      (lines ? (lines[0] === lines[1] ? `第 ${lines[0]} 行做出的两部分` : `第 ${lines[0]} 行和第 ${lines[1]} 行做出的部分`) : "有两部分") +
      `在 (${at}) 处相接，但没有重叠。`,
    touchingCure: "请让它们重叠（略多于允许的误差），或分开同样的距离。",
    edgesSay: (n) => `有 ${n} 条边连着两个以上的三角形，各部分在那里相接。`,
    goThere: "转到那里",
  },
};
