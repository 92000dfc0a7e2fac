// The texts that are on every exhibit's page.
import type { Language } from "./say";

interface FrameTexts {
  all: string;
  lesson: string;
  bench: string;
  lead: string;
  path: string;
  language: string;
  skip: string;
  attempts: string;
  previous: string;
  next: string;
  back: string;
  onward: string;
  widget: string;
  widgetClaim: string;
  still: string;
  more: string;
  /** A link from the widget, which is in the middle of the tour, to the first stop. */
  tour(n: number): string;
  /** How to turn a figure in space, and how to move a point of the plane. */
  turn: string;
  drag: string;
  footer: string;
  damaged: string;
  rebuilt: string;
  lost: string;
  part(n: number): string;
  refused(why: string): string;
}

export const FRAME: Record<Language, FrameTexts> = {
  en: {
    bench: "Your own shapes: the workbench",
    all: "Chordal exhibits",
    lesson: "The lesson",
    lead: "Each page has one claim, one handle and one number. Move the handle, watch the number, and see whether you believe the claim. Take them in order, or begin anywhere.",
    path: "All exhibits",
    language: "Language",
    skip: "Skip to the figure",
    attempts: "Try this",
    previous: "Before",
    next: "Next",
    back: "Back",
    onward: "Before and after",
    widget: "How many segments until it looks smooth?",
    widgetClaim: "Twice the segments, a quarter of the error.",
    tour: (n) => `All ${n} stops, from the first`,
    more: "More of it",
    still: "Still picture; it can be moved once the page has loaded (JavaScript and WebAssembly).",
    turn: "Drag to turn.{touch} Two fingers zoom and pan.{mouse} Ctrl and the wheel zoom.{keys} Arrow keys turn, with Shift they pan; + and − zoom, Home goes back.",
    drag: "Drag the point.{keys} Arrow keys move it, with Shift by small steps; Page Up and Page Down by large ones.",
    footer:
      "Every number here is computed by Chordal’s core, the same code as in the command and the library, compiled to WebAssembly. Nothing is sent anywhere. The address contains your changes.",
    damaged: "Part of this address could not be read. Missing values are set to their defaults.",
    rebuilt: "The calculation failed and was restarted. Your settings are kept.",
    lost: "The calculation does not run here: WebAssembly failed several times. The figure no longer follows your changes; reload the page to try again.",
    part: (n) => `Part ${n}`,
    refused: (why) => `The core refused this: ${why}`,
  },
  zh: {
    bench: "做自己的形状：工作台",
    all: "Chordal 展品",
    lesson: "课程",
    lead: "每一页只有一个论断、一个手柄和一个数字。拖动手柄，看数字怎样变，再判断论断是否可信。可以按顺序看，也可以从任何一页开始。",
    path: "全部展品",
    language: "语言",
    skip: "跳到图形",
    attempts: "试一试",
    previous: "上一个",
    next: "下一个",
    back: "返回",
    onward: "前后展品",
    widget: "要分多少段，曲线看起来才光滑？",
    widgetClaim: "段数翻一番，误差剩四分之一。",
    tour: (n) => `全部 ${n} 站，从第一站开始`,
    more: "展开阅读",
    still: "静态图；页面加载完成后即可操作（需要 JavaScript 和 WebAssembly）。",
    turn: "拖动旋转。{touch}双指缩放、平移。{mouse}Ctrl 加滚轮缩放。{keys}方向键旋转，加 Shift 平移，+ 和 − 缩放，Home 复位。",
    drag: "拖动这个点。{keys}方向键移动它，加 Shift 走小步，Page Up 和 Page Down 走大步。",
    footer:
      "这里的每个数字都由 Chordal 的核心算出，与命令行和程序库用的是同一份代码，只是编译成了 WebAssembly。任何数据都不会发送出去。你的改动都记在本页的地址里。",
    damaged: "地址中有一部分无法识别，相应内容已恢复为默认值。",
    rebuilt: "计算出错，已重新启动。你的改动没有丢失。",
    lost: "计算无法在这里运行：WebAssembly 多次出错。图形不会再随操作变化，请重新加载页面再试。",
    part: (n) => `第 ${n} 部分`,
    refused: (why) => `核心拒绝了这个请求：${why}`,
  },
};
