// The texts of the workbench, in both languages. The command's own sentences are in command_zh.ts.
import type { Notice } from "./state";
import type { Beside } from "./pictures";
import type { AttributeFacts } from "./report";

export type Language = "en" | "zh";

export interface Texts {
  title: string;
  lead: string;
  skip: string;
  home: string;
  lesson: string;
  exhibits: string;
  open: string;
  drop: string;
  undo: string;
  redo: string;
  script: string;
  file: string;
  parameters: string;
  reset: string;
  options: string;
  optionsHint: string;
  budget: string;
  budgets: { tol: string; px: string; triangles: string };
  budgetHints: { tol: string; px(screen: string, isNear: boolean): string; triangles: string };
  mesh: string;
  shows: { shaded: string; wire: string; normals: string; culled: string };
  section: string;
  cutAt: string;
  sliceAt: string;
  beside: string;
  besides: Record<Beside, string>;
  distanceSays(darkest: string, found: string): string;
  overshadeSays(lanes: string, small: number, triangles: number): string;
  noField: string;
  bakeForSlice: string;
  draft: string;
  /** For a draft whose proof failed or was stopped. */
  draftOnly: string;
  /** Shown if the mesh belongs to an older input. */
  outdated: string;
  waiting: string;
  cancel: string;
  proved: string;
  provedIf: string;
  measured: string;
  estimated: string;
  atMost(value: string): string;
  atLeast(value: string): string;
  unknown: string;
  inPixels(value: string): string;
  triangles: string;
  closed: string;
  yes: string;
  no: string;
  genus: string;
  seconds: string;
  attributes: Record<AttributeFacts["semantic"], string>;
  /** The label of an attribute's error; `which` is its number among several, or the name of a custom one. */
  attributeOff(what: string, which: string): string;
  noNumber: string;
  worst: string;
  short: string;
  sound: string;
  /** Shows `n` places, all or only the first. */
  showPlaces(n: string, isPart: boolean): string;
  place(n: number): string;
  /** The button of a repair; `what` is its effect. */
  cure(what: string): string;
  cureAll: string;
  combine: string;
  how: { union: string; minus: string; intersect: string };
  combineWith: string;
  remove: string;
  levels: string;
  makeLevels: string;
  distance: string;
  level(k: number, n: number, triangles: string): string;
  /** A level's error; its size in pixels if finite, and the distance for one pixel if the eye is nearer. */
  levelError(error: string, pixels: string | null, from: string | null): string;
  withoutLevels: string;
  bake: string;
  cells: string;
  bakeHint: string;
  export: string;
  noExport: string;
  line: string;
  copy: string;
  copied: string;
  share: string;
  /** Of a script that reads files, which a link leaves out. */
  shareScript: string;
  noLink: string;
  notices: Record<Notice, string>;
  dismiss: string;
  footer: string;
  noScript: string;
  error: string;
  atLine(line: number): string;
  /** After a mistake: a bracket that was opened in that line is still open. */
  openedIn(line: number): string;
  /** The mesh has no triangles. */
  noTriangles: string;
  /** The proof has ended, and nothing is known of the error. */
  unproved: string;
}

export const TEXTS: Record<Language, Texts> = {
  en: {
    title: "Workbench",
    lead: "Write a shape or drop a file, choose how much error may be visible, and get triangles with a proof. Nothing leaves this page.",
    skip: "To the picture",
    home: "Chordal",
    lesson: "The lesson",
    exhibits: "Exhibits",
    open: "Open files…",
    drop: "Drop files here: meshes, patches, cages, drawings, fonts, volumes, scripts",
    undo: "Undo",
    redo: "Redo",
    script: "Script",
    file: "File",
    parameters: "Parameters",
    reset: "Reset to defaults",
    options: "More options",
    optionsHint: "as for the command: --iso 60, --extrude 2, --text Word",
    budget: "How much error may be seen?",
    budgets: { tol: "Length", px: "Pixels", triangles: "Triangles" },
    budgetHints: {
      tol: "0.1, 0.1mm, or 0.5% of the diagonal",
      px: (screen, isNear) =>
        isNear
          ? `on this screen, from the distance at which the shape is twice as high as the picture, or farther (you are nearer): ${screen}`
          : `on this screen, from here or farther: ${screen}`,
      triangles: "the best mesh with at most this many",
    },
    mesh: "Mesh",
    shows: { shaded: "Surface", wire: "Edges", normals: "Normals", culled: "Backs culled" },
    section: "Cut open",
    cutAt: "Position of the cut",
    sliceAt: "Height of the cut",
    beside: "Beside it",
    besides: { traced: "Field, sphere-traced", sliced: "Field, a slice", distance: "Distance", overshade: "Overshading" },
    distanceSays: (darkest, found) => `From light to dark: 0 to ${darkest}. At one place the distance is at least ${found}.`,
    overshadeSays: (lanes, small, triangles) =>
      `${lanes} GPU lanes per pixel; ${small} of ${triangles} triangles are too small to be seen from here.`,
    noField: "This shape is not a field. Bake it to see its distance.",
    bakeForSlice: "Sample the distance",
    draft: "A draft with unknown error. The proof is running.",
    draftOnly: "A draft with unknown error: its proof failed or was stopped.",
    outdated: "This is the last valid shape, not the current input.",
    waiting: "Working…",
    cancel: "Stop",
    proved: "proved",
    provedIf: "proved if the assumptions hold",
    measured: "measured",
    estimated: "estimated",
    atMost: (value) => `off by at most ${value}`,
    atLeast: (value) => `off by ${value} somewhere`,
    unknown: "error not known yet",
    inPixels: (value) => `${value} px on this screen`,
    triangles: "Triangles",
    closed: "Closed and manifold",
    yes: "yes",
    no: "no",
    genus: "Genus",
    seconds: "Seconds",
    attributes: { normal: "Normals", tangent: "Tangents", texcoord: "Texture coordinates", color: "Colours", custom: "Attribute" },
    attributeOff: (what, which) => `${what}${which && ` ${which}`}, measured error`,
    noNumber: "not a number",
    worst: "Go to the worst place",
    short: "The budget was not met; this is the best that was reached.",
    sound: "No defects were found: the mesh is sound.",
    showPlaces: (n, isPart) => (isPart ? `Show the first ${n}` : n === "1" ? "Show it" : `Show all ${n}`),
    place: (n) => `Turn to place ${n}`,
    cure: (what) => `Repair: ${what}`,
    cureAll: "Repair all",
    combine: "Combine with",
    how: { union: "Unite", minus: "Subtract", intersect: "Intersect" },
    combineWith: "Choose a file…",
    remove: "Remove",
    levels: "Levels of detail",
    makeLevels: "Build levels for one pixel",
    distance: "Distance",
    level: (k, n, triangles) => `level ${k} of ${n}: ${triangles} triangles`,
    levelError: (error, pixels, from) =>
      `off by at most ${error}` +
      (pixels === null ? "" : `, which is at most ${pixels} px from here`) +
      (from === null ? "" : `; at most one pixel beyond a distance of ${from}`),
    withoutLevels: "Back to the mesh",
    bake: "Bake into a field",
    cells: "Cells along the longest side",
    bakeHint: "The samples replace the shape; mesh them to get triangles again.",
    export: "Export",
    noExport: "There is nothing to export: the current input gives no shape. The certificate shows why.",
    line: "The same in code",
    copy: "Copy",
    copied: "Copied",
    share: "The address of this page contains the shape and the budget.",
    shareScript: "The address of this page contains the script and the budget, but not the files that the script reads: it will ask for them.",
    noLink: "The address does not contain this: a link holds only a single small file, as it was opened or written.",
    notices: {
      damaged: "The address was damaged; this is the first example.",
      "too-large": "These files are more than 600 MB, which a browser cannot hold. The command can.",
      stopped: "Stopped. The previous result is shown.",
      unread: "This could not be read; it may be a folder.",
      unloaded: "The command could not be loaded, because of the network or the host. The next change tries again.",
      undrawn: "The file was written, but this page cannot draw it, because it is compressed. Its export is what the command writes.",
      trapped: "The run was out of memory or stack in this browser. A larger budget, or the command on your machine, may succeed.",
    },
    dismiss: "Dismiss",
    footer: "The command runs in this page, as WebAssembly. Nothing is sent anywhere.",
    noScript: "The workbench needs JavaScript and WebAssembly. On your machine the command does the same work:",
    error: "Error:",
    atLine: (line) => `Line ${line}:`,
    openedIn: (line) => `A bracket of line ${line} is not closed.`,
    noTriangles: "Nothing of the shape is larger than the error that may be seen, so the mesh is empty. Allow a smaller one.",
    unproved: "error not proved",
  },
  zh: {
    title: "工作台",
    lead: "写一个形状，或放入一个文件；说明允许看出多大误差；带走三角形和它的证明。一切都在本页内完成，不上传任何内容。",
    skip: "跳到图形",
    home: "Chordal",
    lesson: "课程",
    exhibits: "展品",
    open: "打开文件…",
    drop: "把文件拖到这里：网格、曲面片、控制网格、矢量图、字体、体数据、脚本",
    undo: "撤销",
    redo: "重做",
    script: "脚本",
    file: "文件",
    parameters: "参数",
    reset: "恢复原值",
    options: "更多选项",
    optionsHint: "写法同命令行：--iso 60、--extrude 2、--text Word",
    budget: "允许看出多大误差？",
    budgets: { tol: "长度", px: "像素", triangles: "三角形数" },
    budgetHints: {
      tol: "0.1、0.1mm，或对角线的 0.5%",
      px: (screen, isNear) =>
        isNear ? `在这块屏幕上，从形状有画面两倍高的距离或更远处看（现在更近）：${screen}` : `在这块屏幕上，从此处或更远处看：${screen}`,
      triangles: "不超过这个数目的最佳网格",
    },
    mesh: "网格",
    shows: { shaded: "表面", wire: "边", normals: "法线", culled: "剔除背面" },
    section: "剖开",
    cutAt: "剖切位置",
    sliceAt: "剖切高度",
    beside: "旁边显示",
    besides: { traced: "场：球面追踪", sliced: "场：切片", distance: "距离", overshade: "过度着色" },
    distanceSays: (darkest, found) => `由浅到深：0 到 ${darkest}。有一处的距离至少为 ${found}。`,
    overshadeSays: (lanes, small, triangles) => `GPU 为每个像素着色 ${lanes} 次；${triangles} 个三角形中有 ${small} 个从这里看小到看不见。`,
    noField: "这个形状不是场。烘焙后即可看到距离。",
    bakeForSlice: "对距离采样",
    draft: "草稿，误差未知；证明正在进行。",
    draftOnly: "草稿，误差未知：证明失败或已停止。",
    outdated: "显示的是上一个成功的形状，不是当前输入。",
    waiting: "正在计算…",
    cancel: "停止",
    proved: "已证明",
    provedIf: "在所列假设下已证明",
    measured: "实测",
    estimated: "估计",
    atMost: (value) => `误差至多 ${value}`,
    atLeast: (value) => `某处误差 ${value}`,
    unknown: "误差尚不可知",
    inPixels: (value) => `在这块屏幕上为 ${value} 像素`,
    triangles: "三角形",
    closed: "封闭且为流形",
    yes: "是",
    no: "否",
    genus: "亏格",
    seconds: "用时（秒）",
    attributes: { normal: "法线", tangent: "切线", texcoord: "纹理坐标", color: "颜色", custom: "属性" },
    attributeOff: (what, which) => `${what}${which && ` ${which} `}误差（实测）`,
    noNumber: "不是数",
    worst: "转到误差最大处",
    short: "预算未能满足；这是达到的最好结果。",
    sound: "没有发现缺陷：网格完好。",
    showPlaces: (n, isPart) => (isPart ? `显示前 ${n} 处` : `显示 ${n} 处`),
    place: (n) => `转到第 ${n} 处`,
    cure: (what) => `修复：${what}`,
    cureAll: "全部修复",
    combine: "与另一形状组合",
    how: { union: "并", minus: "差", intersect: "交" },
    combineWith: "选择文件…",
    remove: "移除",
    levels: "细节层次",
    makeLevels: "按一个像素生成各层次",
    distance: "距离",
    level: (k, n, triangles) => `第 ${k} 层（共 ${n} 层）：${triangles} 个三角形`,
    levelError: (error, pixels, from) =>
      `误差至多 ${error}` +
      (pixels === null ? "" : `，从此处看至多 ${pixels} 像素`) +
      (from === null ? "" : `；距离达到 ${from} 后不超过一个像素`),
    withoutLevels: "回到网格",
    bake: "烘焙成场",
    cells: "最长边方向的单元数",
    bakeHint: "样本取代原来的形状；再网格化就能回来。",
    export: "导出",
    noExport: "没有可导出的内容：当前输入没有得到形状，原因见证书。",
    line: "等效命令",
    copy: "复制",
    copied: "已复制",
    share: "本页地址中含有形状和预算。",
    shareScript: "本页地址中含有脚本和预算，不含脚本读取的文件；打开时会再次询问。",
    noLink: "地址中不含这些内容：只有单个小文件，且保持打开或写成时的样子，才能放进链接。",
    notices: {
      damaged: "地址已损坏；这是第一个示例。",
      "too-large": "这些文件超过 600 MB，浏览器装不下；命令可以处理。",
      stopped: "已停止。显示的是之前的结果。",
      unread: "无法读取：也许是文件夹。",
      unloaded: "命令未能加载：网络或服务器没有给出文件。下一次改动会重试。",
      undrawn: "文件已生成，但经过压缩，本页无法显示。导出的内容与命令行写出的相同。",
      trapped: "这次运行在浏览器里耗尽了内存或栈。放宽预算，或在你的机器上运行命令，也许可行。",
    },
    dismiss: "关闭",
    footer: "命令以 WebAssembly 形式在本页运行。任何数据都不会发送出去。",
    noScript: "工作台需要 JavaScript 和 WebAssembly。在你的机器上，可以用命令完成同样的工作：",
    error: "错误：",
    atLine: (line) => `第 ${line} 行：`,
    openedIn: (line) => `第 ${line} 行有一个括号没有闭合。`,
    noTriangles: "形状的各处都小于允许的误差，网格因此是空的。请减小允许的误差。",
    unproved: "误差未能证明",
  },
};
