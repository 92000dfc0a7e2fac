// The command's sentences on meshes and on its progress, as the page shows them: options in words, and everything in Chinese,
// looked up by the English text. A text without a translation stays English.
import { cureTexts } from "../core/cures";
import type { Language } from "./texts";

/** A text, with its language if that is not the page's. */
export interface Spoken {
  text: string;
  lang?: "en";
}

/** The names of findings, which follow their number. */
export const NAMES: Record<string, string> = {
  boundary_edges: "条边界边",
  non_manifold_edges: "条边连着三个以上的三角形",
  non_manifold_vertices: "个顶点连着多个扇形",
  t_junctions: "个 T 形接点",
  inconsistent_edges: "条边两侧方向不一致",
  inside_out: "个分量里外颠倒",
  self_intersections: "处自相交",
  duplicate_faces: "个重复的三角形",
  duplicate_vertices: "个重复的顶点",
  collapsed_faces: "个坍缩的三角形",
  zero_area_faces: "个零面积三角形",
  slivers: "个狭长三角形",
  unused_vertices: "个未使用的顶点",
};

/** The effect of a repair, by its option. */
export const CURES = byOption(cureTexts("zh"));

/** The same in English. */
export const CURES_EN = byOption(cureTexts("en"));

function byOption(texts: Record<string, string>): Record<string, string> {
  return Object.fromEntries(Object.entries(texts).map(([cure, text]) => [`--${cure}`, text]));
}

/** Sentences about findings. */
const SENTENCES: Record<string, string> = {
  "the surface ends there, so that it has no inside": "曲面到此为止，因此没有内部。",
  "sheets branch there, so that the next face is ambiguous": "曲面在那里分叉，分不出下一个面是哪个。",
  "sheets touch in a point, so that its faces form no single fan": "几片曲面只在一点相接，那里的面不构成单一的扇形。",
  "a vertex lies in a neighbour's edge: a crack may show": "一个顶点落在邻面的边上：可能露出裂缝。",
  "one of the two triangles there shows its back": "那里的两个三角形有一个背面朝外。",
  "the front faces the inside": "正面朝向内部。",
  "triangles meet where they should not, and inside is ambiguous": "三角形在不该相遇处相遇，内外不明。",
  "two triangles lie in the same place, and their pixels flicker": "两个三角形占同一位置，像素会闪烁。",
  "the surface is cut apart between equal points": "曲面在坐标相同的点之间断开。",
  "two corners are the same vertex, so that the area is zero": "两个角是同一个顶点，面积为零。",
  "all corners lie on one line, so that there is no normal": "三个角在一条直线上，没有法线。",
  "longer than 100 heights, with a weak normal": "长度超过高的 100 倍，法线不可靠。",
  "no triangle has a corner there": "没有三角形用到它。",
  "the filling may cross the surface, which `inspect --self-intersections` shows afterwards":
    "填补的三角形可能穿过曲面，补后请检查自相交。",
  "move them apart or unite the solids in the program that made them; winding numbers still tell what is inside":
    "请在制作它的程序中把它们移开，或合并成一个实体；环绕数仍能判断内外。",
  "mesh the true shape again, if there is one; smooth normals are safer than flat ones":
    "若有原来的形状，请重新网格化；光滑法线比平面法线可靠。",
  "the surface has one side only, as a Möbius strip: cut it open, or draw both sides":
    "曲面只有一侧，如莫比乌斯带：请把它剪开，或两面都绘制。",
  "a surface with one side only stays open: cut it so that it has two, then fill":
    "只有一侧的曲面无法封闭：先剪开，使它有两侧，再补孔。",
  "leave them: if they were welded, sheets would branch or touch there": "请保留：焊接后曲面会在那里分叉或相接。",
  "look at it in the program that made it": "请在制作它的程序中查看。",
  "an open sheet, or sheets that branch: leave it, or give it thickness in the program that made it":
    "这是开放的曲面，或有分叉：可以保留，或在制作它的程序中赋予厚度。",
  "`chordal mend --split-nonmanifold` into OBJ or PLY: this format ties equal positions together again":
    "请用 `chordal mend --split-nonmanifold` 写成 OBJ 或 PLY：这种格式会把坐标相同的点重新连在一起。",
};

const NEARLY_JOINED = /^(\d+) of its boundary vertices are within (\S+) of others, which `mend (--weld=[^`]+)` joins$/;

/** The stages of the command's progress. */
export const STAGES: Record<string, string> = {
  cells: "划分单元",
  combine: "组合",
  contours: "提取轮廓",
  fill: "填充轮廓",
  improve: "改善网格",
  labels: "分离标签",
  measure: "测量误差",
  prove: "证明",
  rasterize: "光栅化",
  render: "渲染",
  surface: "提取表面",
  tessellate: "细分",
};

function sentence(english: string): string | undefined {
  const translation = SENTENCES[english];
  if (translation !== undefined) return translation;
  const joined = NEARLY_JOINED.exec(english);
  if (joined) return `其中 ${joined[1]} 个边界顶点与别的顶点相距不超过 ${joined[2]}，焊接可使其相连。`;
  // Several sentences joined by semicolons: the meaning, then remarks.
  const [first, ...rest] = english.split("; ");
  const [meaning, besides] = [SENTENCES[first!], rest.length ? sentence(rest.join("; ")) : undefined];
  return meaning !== undefined && besides !== undefined ? meaning + besides : undefined;
}

/** Replaces the command's options in a sentence by words. */
const worded = (english: string): string =>
  english
    .replace("which `inspect --self-intersections` shows afterwards", "which a search for self-intersections shows afterwards")
    .replace(/which `mend --weld=[^`]+` joins/, "which welding joins");

/** The options for welding over a distance that a sentence names: only the reader can decide on that repair. */
export function joining(english: string): readonly string[] {
  const options = english.split("; ").map((part) => NEARLY_JOINED.exec(part)?.[3]);
  return options.filter((option) => option !== undefined);
}

const spoken = (language: Language, english: string, chinese: string | undefined): Spoken => {
  if (language === "en") return { text: english };
  return chinese === undefined ? { text: english, lang: "en" } : { text: chinese };
};

/** A sentence about a finding. */
export const sentenceIn = (language: Language, english: string): Spoken => spoken(language, worded(english), sentence(english));

/** The name of a finding, which follows its number. */
export const nameIn = (language: Language, { of, words }: { of: string; words: string }): Spoken =>
  spoken(language, words, NAMES[of]);

/** The effect of a repair; an unknown one is named by its option. */
export function cureIn(language: Language, option: string): string {
  const within = /^--weld=(.+)$/.exec(option)?.[1];
  if (within) return language === "en" ? `weld vertices within ${within}` : `焊接相距不超过 ${within} 的顶点`;
  return (language === "en" ? CURES_EN : CURES)[option] ?? option;
}

export const stageIn = (language: Language, stage: string): Spoken => spoken(language, stage, STAGES[stage]);
