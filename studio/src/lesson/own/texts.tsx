// The texts of a shape of the reader's own, in both languages. They are loaded with it.
import type { ComponentChildren } from "preact";
import type { Language } from "../../exhibits/say";
import type { StationId } from "../outline";
import type { Shading } from "./shape";

export interface OwnTexts {
  /** The dialogue. */
  bring: string;
  lead: string;
  choose: string;
  formats: string;
  write: string;
  take: string;
  examples: string;
  loads: string;
  taking(name: string): string;
  noTriangles: string;
  cancel: string;
  close: string;
  back: string;
  /** The line at the top. */
  travels(name: string): string;
  first: string;
  notKept: string;
  /** At all stations. */
  yours(name: string): string;
  picture: string;
  line: string;
  covered: string;
  stations: Record<StationId, string>;
  budget: string;
  triangles: string;
  inFile: string;
  off: string;
  short: string;
  vertices: string;
  positions: string;
  perVertex: string;
  indexed: string;
  unindexed: string;
  storage: string;
  stored: Record<"indexed" | "unindexed", string>;
  shading: string;
  shadings: Record<Shading, string>;
  verticesOf: string;
  isClosed: string;
  isManifold: string;
  yes: string;
  no: string;
  components: string;
  inside: string;
  noInside: string;
  places(n: string): string;
  terms: string;
  outside: string;
  ruleOff: string;
  worth: Record<string, string>;
  cells: string;
  samples: string;
  spacing: string;
  samplesOff: string;
  backTriangles: string;
  distance: string;
  spokenAt(distance: string, triangles: string): string;
  size: string;
  clipped: string;
  upClose: string;
  shown: string;
  shownOff: string;
  level: string;
  from: string;
  screen(width: number, height: number): string;
  trueSize: string;
  broughtAndLeft(budget: string, length: ComponentChildren, triangles: ComponentChildren, off: ComponentChildren, known: string): ComponentChildren;
  openBench: string;
  benchNote: string;
}

export const OWN_TEXTS: Record<Language, OwnTexts> = {
  en: {
    bring: "Bring your own shape",
    lead: "The lesson carries a teapot. Put a shape of yours beside it, and it travels along: each stop says of it what it says of the teapot.",
    choose: "Choose a file…",
    formats: "or drop it here: GLB, STL, OBJ, PLY, 3MF, a shape script (.star), and whatever else the command reads",
    write: "Or write it, in a few lines",
    take: "Take these lines along",
    examples: "Or one of these",
    loads: "The command is loaded when you take something along: once, some megabytes. Your file stays in this browser.",
    taking: (name) => `Making triangles of ${name}…`,
    noTriangles: "The command made no triangles of it.",
    cancel: "Stop",
    close: "Close",
    back: "Back to the teapot",
    travels: (name) => `${name} travels along.`,
    first: "To its first stop",
    notKept: "This browser does not keep it: after a reload the teapot is alone again.",
    yours: (name) => `Your shape: ${name}`,
    picture: "Your shape",
    line: "Command that does the same",
    covered: "Its numbers are shown after your guess above.",
    stations: {
      triangles: "In triangles",
      buffers: "In two buffers",
      normals: "Where its normals live",
      sound: "Whether it has an inside",
      field: "Into a field, and back",
      levels: "Near and far",
      bound: "You brought a budget; you leave with a bound",
    },
    budget: "Error allowed, as a share of its size",
    triangles: "Triangles",
    inFile: "Triangles in the file",
    off: "Off by at most",
    short: "The budget was not met; this is the best that was reached.",
    vertices: "Vertices",
    positions: "Different places among them",
    perVertex: "Triangles at a vertex, mean",
    indexed: "Bytes with an index",
    unindexed: "Bytes without an index",
    storage: "Stored",
    stored: { indexed: "with an index", unindexed: "corner by corner" },
    shading: "Normals",
    shadings: { flat: "flat", smooth: "smooth", "crease=30deg": "creased at 30°" },
    verticesOf: "Vertices with a normal each",
    isClosed: "Closed",
    isManifold: "Manifold",
    yes: "yes",
    no: "no",
    components: "Pieces",
    inside: "Every edge has exactly two triangles: inside and outside are clear.",
    noInside: "So inside and outside are not clear everywhere. What was found:",
    places: (n) => `The first places are marked in the picture: ${n}.`,
    terms: "Terms of its rule",
    outside: "Outside, its value is",
    ruleOff: "Meshed from the rule itself, off by at most",
    worth: { "exact distance": "the exact distance", "lower bound": "a lower bound of the distance", sign: "a sign" },
    cells: "Cells along the longest side",
    samples: "Samples",
    spacing: "Spacing",
    samplesOff: "A sample is off by at most",
    backTriangles: "Triangles, meshed again",
    distance: "How far away",
    spokenAt: (distance, triangles) => `${distance}, ${triangles} triangles`,
    size: "Its size on that screen, in pixels",
    clipped: "Larger than this picture; drawn as large as it goes.",
    upClose: "The same triangles, held up close",
    shown: "Triangles that are enough",
    shownOff: "Off by at most, in pixels",
    level: "Level",
    from: "From a distance of",
    screen: (width, height) => `One pixel may be seen, on a screen of ${width} × ${height} pixels. All of its levels:`,
    trueSize: "At its true size",
    broughtAndLeft: (budget, length, triangles, off, known) => (
      <>
        You allowed {budget} of its size, which is a length of {length}. You leave with {triangles} triangles that are off by at most {off}: {known}.
      </>
    ),
    openBench: "Open it in the workbench",
    benchNote: "Another budget, the worst place, repairs, exports: there it is yours to change.",
  },
  zh: {
    bring: "带上你自己的形状",
    lead: "课程带着一把茶壶走到底。把你的形状放在它旁边，就会一路同行：每一站对茶壶说什么，也对它说什么。",
    choose: "选择文件…",
    formats: "或拖到这里：GLB、STL、OBJ、PLY、3MF、形状脚本（.star），以及命令能读的其他格式",
    write: "或者写几行脚本",
    take: "带上这几行",
    examples: "或者选一个",
    loads: "带上形状时才加载命令，只加载一次，有几兆字节。你的文件留在这个浏览器里。",
    taking: (name) => `正在把 ${name} 变成三角形…`,
    noTriangles: "命令没有由它得到三角形。",
    cancel: "停止",
    close: "关闭",
    back: "回到茶壶",
    travels: (name) => `${name} 一路同行。`,
    first: "去它的第一站",
    notKept: "这个浏览器没有保留它：重新加载后又只有茶壶。",
    yours: (name) => `你的形状：${name}`,
    picture: "你的形状",
    line: "等效命令",
    covered: "先在上面猜一猜，再看它的数字。",
    stations: {
      triangles: "化为三角形",
      buffers: "存进两个缓冲",
      normals: "它的法线在哪里",
      sound: "它有没有内部",
      field: "变成场，再变回来",
      levels: "近看与远看",
      bound: "带着预算来，带着上界走",
    },
    budget: "允许的误差，相对于它的大小",
    triangles: "三角形",
    inFile: "文件中的三角形",
    off: "误差至多",
    short: "预算未能满足；这是达到的最好结果。",
    vertices: "顶点",
    positions: "其中不同的位置",
    perVertex: "每个顶点的三角形数（平均）",
    indexed: "带索引时的字节数",
    unindexed: "不带索引时的字节数",
    storage: "存储方式",
    stored: { indexed: "带索引", unindexed: "逐角存储" },
    shading: "法线",
    shadings: { flat: "平面", smooth: "光滑", "crease=30deg": "折痕 30°" },
    verticesOf: "各带一条法线的顶点",
    isClosed: "封闭",
    isManifold: "流形",
    yes: "是",
    no: "否",
    components: "分量",
    inside: "每条边恰好属于两个三角形：内外分明。",
    noInside: "因此并非处处内外分明。发现：",
    places: (n) => `图中标出了最先发现的 ${n} 处。`,
    terms: "规则中的项数",
    outside: "外部的值是",
    ruleOff: "直接由规则网格化，误差至多",
    worth: { "exact distance": "精确距离", "lower bound": "距离的下界", sign: "只有符号" },
    cells: "最长边上的单元数",
    samples: "样本",
    spacing: "间距",
    samplesOff: "样本的误差至多",
    backTriangles: "重新网格化的三角形",
    distance: "离多远",
    spokenAt: (distance, triangles) => `${distance}，${triangles} 个三角形`,
    size: "在那块屏幕上的大小（像素）",
    clipped: "比这幅图还大，画到放得下为止。",
    upClose: "同样的三角形，拿到眼前",
    shown: "够用的三角形",
    shownOff: "误差至多（像素）",
    level: "层次",
    from: "从这个距离起",
    screen: (width, height) => `屏幕为 ${width} × ${height} 像素，允许看出一个像素。它的各个层次：`,
    trueSize: "真实大小",
    broughtAndLeft: (budget, length, triangles, off, known) => (
      <>
        你允许的误差是它大小的 {budget}，即长度 {length}。你带走 {triangles} 个三角形，误差至多 {off}：{known}。
      </>
    ),
    openBench: "在工作台中打开它",
    benchNote: "换一个预算、看误差最大处、修复、导出：在那里随你改动。",
  },
};
