// The texts of the workbench's panels, its tool bar and its status line, in both languages.
import type { Language } from "../texts";
import type { Side } from "../stage/orbit";
import type { PanelName } from "./layout";

export interface LayoutTexts {
  panels: string;
  panel: Record<PanelName, string>;
  /** The panel's button on a phone, if it is shorter. */
  short: Record<PanelName, string>;
  close: string;
  resize: Record<PanelName, string>;
  tools: string;
  look: string;
  from: string;
  sides: Record<Side | "fit", string>;
  parallel: string;
  grid: string;
  sizes: string;
  status: string;
  nothing: string;
  triangles(n: string): string;
  /** The mesh is of an earlier input. */
  older: string;
  /** The unit of lengths: a symbol, or words if the shape has none. */
  noUnit: string;
  square(size: string): string;
  help: string;
  hint: string;
  hintTouch: string;
  secondsLeft(seconds: string): string;
  minutesLeft(minutes: string): string;
  asItIs: string;
  said: string;
  toScript: string;
  /** After an option. */
  leftOut: string;
}

export const LAYOUT_TEXTS: Record<Language, LayoutTexts> = {
  en: {
    panels: "Panels",
    panel: { input: "Script and budget", certificate: "Certificate", findings: "Defects", beside: "Field", change: "Change", export: "Export" },
    short: { input: "Script", certificate: "Proof", findings: "Defects", beside: "Field", change: "Change", export: "Export" },
    close: "Close",
    resize: {
      input: "Size of the panel with the script",
      certificate: "Size of the certificate's panel",
      findings: "Size of the panel with the defects",
      beside: "Size of the field's panel",
      change: "Size of the panel with changes",
      export: "Size of the export panel",
    },
    tools: "Tools of the picture",
    look: "Mesh as",
    from: "View",
    sides: { fit: "Fit", front: "Front", back: "Back", left: "Left", right: "Right", top: "Top", bottom: "Bottom", corner: "Corner" },
    parallel: "Parallel",
    grid: "Grid",
    sizes: "Sizes",
    status: "State",
    nothing: "No shape yet",
    triangles: (n) => (n === "1" ? "1 triangle" : `${n} triangles`),
    older: "of the last valid input",
    noUnit: "units",
    square: (size) => `a square is ${size}`,
    help: "Help",
    hint: "Drag to turn, Shift-drag to shift, wheel to zoom to the pointer, double click to set the pivot. Keys: arrows turn, + and − zoom, Home goes back, 1 to 7 are the sides, P changes the projection, G and D show grid and sizes, M measures, C cuts open, Escape clears.",
    hintTouch: "One finger turns, two zoom and shift; a double tap sets the pivot.",
    secondsLeft: (seconds) => `about ${seconds} s left`,
    minutesLeft: (minutes) => `about ${minutes} min left`,
    asItIs: "The file as it is. Its mesh within the budget is being made.",
    said: "The script says",
    toScript: "Show it in the script",
    leftOut: "is no option of a mesh, so this one was made without it. It may be one of tiles, pictures or levels.",
  },
  zh: {
    panels: "面板",
    panel: { input: "脚本与预算", certificate: "证书", findings: "缺陷", beside: "场", change: "修改", export: "导出" },
    short: { input: "脚本", certificate: "证书", findings: "缺陷", beside: "场", change: "修改", export: "导出" },
    close: "关闭",
    resize: {
      input: "脚本面板的大小",
      certificate: "证书面板的大小",
      findings: "缺陷面板的大小",
      beside: "场面板的大小",
      change: "修改面板的大小",
      export: "导出面板的大小",
    },
    tools: "图形工具",
    look: "网格显示为",
    from: "视图",
    sides: { fit: "适合窗口", front: "前视", back: "后视", left: "左视", right: "右视", top: "俯视", bottom: "仰视", corner: "等轴测" },
    parallel: "平行投影",
    grid: "网格线",
    sizes: "尺寸",
    status: "状态",
    nothing: "还没有形状",
    triangles: (n) => `${n} 个三角形`,
    older: "对应上一个有效输入",
    noUnit: "无单位",
    square: (size) => `每格 ${size}`,
    help: "帮助",
    hint: "拖动旋转，按住 Shift 拖动平移，滚轮朝指针处缩放，双击设定旋转中心。键盘：方向键旋转，+ 和 − 缩放，Home 复位，1 到 7 为各标准视图，P 切换投影，G 和 D 显示网格线和尺寸，M 测量，C 剖开，Esc 清除。",
    hintTouch: "单指旋转，双指缩放和平移，双击设定旋转中心。",
    secondsLeft: (seconds) => `约剩 ${seconds} 秒`,
    minutesLeft: (minutes) => `约剩 ${minutes} 分钟`,
    asItIs: "这是文件原样；符合预算的网格正在生成。",
    said: "脚本输出",
    toScript: "在脚本中显示",
    leftOut: "不是网格的选项，这个网格没有用它；它可能属于瓦片、图片或细节层次。",
  },
};
