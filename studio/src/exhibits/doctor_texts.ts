// The texts of the mesh doctor, in their own file because they are many.
import { type Cure, cureTexts } from "../core/cures";
import type { CommonTexts } from "./exhibit";
import { FRAME } from "./frame_texts";
import type { Language } from "./say";

export const PATIENTS = ["hole", "seam", "crack", "flipped", "branch", "double"] as const;
export type Patient = (typeof PATIENTS)[number];
export type Defect =
  | "boundary_edges"
  | "non_manifold_edges"
  | "non_manifold_vertices"
  | "t_junctions"
  | "inconsistent_edges"
  | "inside_out"
  | "self_intersections"
  | "duplicate_faces"
  | "duplicate_vertices"
  | "collapsed_faces"
  | "zero_area_faces"
  | "slivers"
  | "unused_vertices";

export interface Texts extends CommonTexts {
  figure: string;
  patient: string;
  patients: Record<Patient, string>;
  label: string;
  /** Below the picture: the mesh has no inside. */
  sick: string;
  /** Below the picture: it has an inside, but some defects are left. */
  left: string;
  /** Below the picture: no defect is left. */
  well(volume: string): string;
  findings: string;
  places: string;
  /** If there are more than are listed. */
  firstPlaces(n: string): string;
  place(n: number): string;
  nothing: string;
  /** Its name in the singular, in the plural, and its meaning. */
  defects: Record<Defect, readonly [string, string, string]>;
  cures: Record<Cure, string>;
  done: string;
  changed(what: string, n: string): string;
  comma: string;
  /** The end of a repair's report if no point moved. */
  still: string;
  moved(n: string): string;
  undo: string;
  facts: Record<"closed" | "manifold" | "oriented", string>;
  yes: string;
  no: string;
  volume: string;
  noVolume: string;
}

/** A number with its noun; after 1, the first word is in the singular. */
const counted = (n: string, words: string): string => `${n} ${n === "1" ? words.replace("vertices", "vertex").replace(/^(\S+?)s\b/, "$1") : words}`;

/** The report of a repair, by the change that it counts. */
const CHANGES: Record<Language, Record<string, string>> = {
  en: {
    welded_vertices: "vertices welded",
    merged_rows: "rows merged",
    collapsed_faces: "triangles collapsed",
    dropped_faces: "triangles dropped",
    dropped_vertices: "vertices dropped",
    turned_faces: "triangles turned",
    split_vertices: "vertices split",
    split_edges: "edges split",
    filled_holes: "holes filled",
    added_faces: "triangles added",
    added_vertices: "vertices added",
    resolved_t_junctions: "T-junctions resolved",
    left_holes: "holes left",
    left_faces: "triangles left",
    left_t_junctions: "T-junctions left",
    left_unorientable: "one-sided components left as they are",
  },
  zh: {
    welded_vertices: "个顶点已焊接",
    merged_rows: "行已合并",
    collapsed_faces: "个三角形已坍缩",
    dropped_faces: "个三角形已删除",
    dropped_vertices: "个顶点已删除",
    turned_faces: "个三角形已翻转",
    split_vertices: "个顶点已拆分",
    split_edges: "条边已拆分",
    filled_holes: "个孔已填补",
    added_faces: "个三角形已添加",
    added_vertices: "个顶点已添加",
    resolved_t_junctions: "个 T 形接点已消除",
    left_holes: "个孔保留",
    left_faces: "个三角形保留",
    left_t_junctions: "个 T 形接点保留",
    left_unorientable: "个单侧分量保留",
  },
};

export const DOCTOR: Record<Language, Texts> = {
  en: {
    hint: FRAME.en.turn,
    figure: "A defective mesh with its defects in red; backs are orange",
    patient: "Patient",
    patients: {
      hole: "a hole",
      seam: "triangle soup",
      crack: "a crack",
      flipped: "wrong winding",
      branch: "a branch",
      double: "twice the same",
    },
    label: "Kinds of faults",
    sick: "The promise is broken. A slicer, a solver or a boolean would have to guess what is inside, or refuse.",
    left: "Closed, manifold and consistently wound: it has an inside. But it has a defect that a drawing or a print would show.",
    well: (volume) => `Closed, manifold and consistently wound: it has an inside, and its volume is ${volume}.`,
    findings: "Findings",
    places: "Where",
    firstPlaces: (n) => `The first ${n}`,
    place: (n) => `Turn to place ${n}`,
    nothing: "Nothing.",
    defects: {
      boundary_edges: ["boundary edge", "boundary edges", "With only one triangle, the surface ends there and has no inside."],
      non_manifold_edges: [
        "edge of three triangles or more",
        "edges of three triangles or more",
        "Sheets branch there, so that the next face is ambiguous.",
      ],
      non_manifold_vertices: [
        "vertex of several fans",
        "vertices of several fans",
        "Sheets touch in a point, so that its faces form no single fan.",
      ],
      t_junctions: ["T-junction", "T-junctions", "A vertex lies in a neighbour’s edge: a crack may show."],
      inconsistent_edges: [
        "edge of opposite winding",
        "edges of opposite winding",
        "One of the two triangles there shows its back.",
      ],
      inside_out: ["component inside out", "components inside out", "The front faces the inside."],
      self_intersections: [
        "self-intersection",
        "self-intersections",
        "Triangles meet where they should not, and inside is ambiguous.",
      ],
      duplicate_faces: ["duplicate triangle", "duplicate triangles", "Two triangles lie in the same place, and their pixels flicker."],
      duplicate_vertices: ["duplicate vertex", "duplicate vertices", "The surface is cut apart between equal points."],
      collapsed_faces: ["collapsed triangle", "collapsed triangles", "Two corners are the same vertex, so that the area is zero."],
      zero_area_faces: [
        "triangle of no area",
        "triangles of no area",
        "All corners lie on one line, so that there is no normal.",
      ],
      slivers: ["sliver", "slivers", "More than 100 times as long as high, so that the normal is unreliable."],
      unused_vertices: ["unused vertex", "unused vertices", "No triangle has a corner there."],
    },
    cures: cureTexts("button"),
    done: "What was done",
    changed: (what, n) => counted(n, CHANGES.en[what] ?? what),
    comma: ", ",
    still: "nothing moved",
    moved: (n) => `moved by at most ${n}`,
    undo: "Take the last one back",
    facts: { closed: "Closed", manifold: "Manifold", oriented: "Consistently wound" },
    yes: "yes",
    no: "no",
    volume: "Volume",
    noVolume: "has none",
    story: [
      "A mesh is only a list of triangles. That they make a *surface with an inside* is a promise about their edges: exactly two triangles at each, which run along it in opposite ways. The core *counts* exactly where the promise is broken, and changes nothing; a repair is a step that you choose.",
      "Files break the promise in few ways. A triangle is missing. Every triangle has vertices of its own, so nothing is connected. A neighbour was subdivided, and its new vertex lies inside an edge. Some triangles are wound the wrong way. Two solids share an edge. Triangles are there twice.",
      "A repair reports its changes and a proved bound on how far the surface moved. Most repairs move nothing at all.",
      "The order matters. Soup has a boundary everywhere, but filling its holes would give every triangle a back; it has to be welded first. The button shows the first repair that helps.",
    ],
    attempts: [
      "Repair all six. Which need more than one step, and why?",
      "Repair the branch. It is one piece before; how can it become two solids without moving a point?",
    ],
  },
  zh: {
    hint: FRAME.zh.turn,
    figure: "有病的网格，病灶为红色，背面为橙色",
    patient: "示例",
    patients: {
      hole: "有孔",
      seam: "散乱三角形",
      crack: "有裂缝",
      flipped: "环绕方向错",
      branch: "有分叉",
      double: "重复",
    },
    label: "缺陷的种类",
    sick: "约定被破坏了：切片、求解或布尔运算只能猜测哪里是内部，或者拒绝。",
    left: "封闭、流形、环绕方向一致：它有内部。但还有多余的东西，绘制或打印时会显出来。",
    well: (volume) => `封闭、流形、环绕方向一致：它有内部，体积为 ${volume}。`,
    findings: "诊断",
    places: "位置",
    firstPlaces: (n) => `前 ${n} 处`,
    place: (n) => `转到第 ${n} 处`,
    nothing: "没有发现缺陷。",
    defects: {
      boundary_edges: ["条边界边", "条边界边", "那里只有一个三角形：曲面到此为止，因此没有内部。"],
      non_manifold_edges: ["条边连着三个以上的三角形", "条边连着三个以上的三角形", "曲面在那里分叉，分不出下一个面是哪个。"],
      non_manifold_vertices: ["个顶点连着多个扇形", "个顶点连着多个扇形", "几片曲面只在一点相接，绕它一周走不通。"],
      t_junctions: ["个 T 形接点", "个 T 形接点", "一个顶点落在邻面的边上：可能露出裂缝。"],
      inconsistent_edges: ["条边两侧方向不一致", "条边两侧方向不一致", "那里的两个三角形有一个背面朝外。"],
      inside_out: ["个分量里外颠倒", "个分量里外颠倒", "正面朝向内部。"],
      self_intersections: ["处自相交", "处自相交", "三角形在不该相遇处相遇，内外不明。"],
      duplicate_faces: ["个重复的三角形", "个重复的三角形", "两个三角形占同一位置，像素会闪烁。"],
      duplicate_vertices: ["个重复的顶点", "个重复的顶点", "曲面在坐标相同的点之间断开。"],
      collapsed_faces: ["个坍缩的三角形", "个坍缩的三角形", "两个角是同一个顶点，什么也没有覆盖。"],
      zero_area_faces: ["个零面积三角形", "个零面积三角形", "三个顶点在一条直线上，没有法线。"],
      slivers: ["个狭长三角形", "个狭长三角形", "长度超过高的 100 倍，法线不可靠。"],
      unused_vertices: ["个未使用的顶点", "个未使用的顶点", "没有三角形用到它。"],
    },
    cures: cureTexts("zh"),
    done: "已做的修复",
    changed: (what, n) => `${n} ${CHANGES.zh[what] ?? what}`,
    comma: "，",
    still: "没有移动任何点",
    moved: (n) => `移动不超过 ${n}`,
    undo: "撤销上一步",
    facts: { closed: "封闭", manifold: "流形", oriented: "环绕方向一致" },
    yes: "是",
    no: "否",
    volume: "体积",
    noVolume: "无",
    story: [
      "网格只是一串三角形。它们能构成*有内部的曲面*，靠的是关于边的约定：每条边恰有两个三角形，且沿边走向相反。核心精确*统计*约定在哪里被破坏，但什么也不改；修复要由你指名，另行执行。",
      "文件违反约定的方式不多：少了一个三角形；每个三角形各有自己的顶点，彼此互不相连；邻面切得更细，新顶点落在一条不知道它的边上；有些三角形环绕方向反了；两个实体共用一条边；有东西重复了。",
      "修复会说明做了什么、曲面最多移动了多少，并且有证明。多数修复根本不移动任何点。",
      "次序很重要。散乱的三角形处处是边界，若先补孔，每个三角形都会多出一个背面；应当先焊接。按钮上显示的是第一个有效的修复。",
    ],
    attempts: [
      "修复全部六个。哪些需要不止一步？为什么？",
      "治好“有分叉”的那个：原来是一块，没有移动任何点，怎么就成了两个实体？",
    ],
  },
};
