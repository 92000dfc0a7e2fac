// The command's sentences, as the page shows them: options in words; in Chinese, findings by the codes and the values that a
// report gives for them, errors and assumptions by their English text. A sentence that is in no table stays English, an error
// after what its code says.
import { cureTexts } from "../core/cures";
import { ERRORS } from "./errors_zh";
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

/** A sentence of the command by its code, with the values in it. */
export interface Sentence {
  code: string;
  values?: Readonly<Record<string, string>>;
}

type Values = Readonly<Record<string, string>>;

/** What a finding means; the code of a defect is the name of its count. */
export const MEANINGS: Record<string, string | ((values: Values) => string)> = {
  boundary_edges: "曲面到此为止，因此没有内部。",
  non_manifold_edges: "曲面在那里分叉，分不出下一个面是哪个。",
  non_manifold_vertices: "几片曲面只在一点相接，那里的面不构成单一的扇形。",
  t_junctions: "一个顶点落在邻面的边上：可能露出裂缝。",
  inconsistent_edges: "那里的两个三角形有一个背面朝外。",
  inside_out: "正面朝向内部。",
  self_intersections: "三角形在不该相遇处相遇，内外不明。",
  duplicate_faces: "两个三角形占同一位置，像素会闪烁。",
  duplicate_vertices: "曲面在坐标相同的点之间断开。",
  collapsed_faces: "两个角是同一个顶点，面积为零。",
  zero_area_faces: "三个顶点在一条直线上，没有法线。",
  slivers: "长度超过高的 100 倍，法线不可靠。",
  unused_vertices: "没有三角形用到它。",
  "filling-may-cross": "填补的三角形可能穿过曲面，补后请检查自相交。",
  "nearly-joined": ({ vertices, within }) => `其中 ${vertices} 个边界顶点与别的顶点相距不超过 ${within}，焊接可使其相连。`,
};

/** What to do about a finding that no repair mends. */
export const ADVICE: Record<string, string> = {
  self_intersections: "请在制作它的程序中把它们移开，或并成一个实体；环绕数仍能判断内外。",
  slivers: "若有原来的形状，请重新网格化；平滑法线比平直法线可靠。",
  inconsistent_edges: "曲面只有一侧，如莫比乌斯带：请把它剪开，或两面都绘制。",
  boundary_edges: "只有一侧的曲面无法封闭：先剪开，使它有两侧，再补孔。",
  duplicate_vertices: "请保留：焊接后曲面会在那里分叉或相接。",
  "open-sheet": "这是开放的曲面，或有分叉：可以保留，或在制作它的程序中赋予厚度。",
  "split-and-keep-apart": "请用 `chordal mend --split-nonmanifold` 写成 OBJ 或 PLY：这种格式会把坐标相同的点重新连在一起。",
};
/** The advice on any other defect. */
const LOOK = "请在制作它的程序中查看。";

/** The assumptions of a proof. They are sentences of whoever made them, a script's author among them, and have no code. */
const ASSUMPTIONS: readonly (readonly [RegExp, (...values: string[]) => string])[] = [
  [/^values of the interpolant between samples are taken as rounded to f64$/, () => "样本之间的插值按舍入到双精度的值计。"],
  [/^no part of the outlines and no gap in them appears or vanishes in the polygons that replace them$/, () => "用多边形代替轮廓时，没有部分或缝隙出现或消失。"],
  [/^the mesh is not closed, and points whose winding number is above a half count as inside$/, () => "网格不封闭，环绕数大于一半的点算作内部。"],
  [/^what is farther from a shape than the bound of its triangles is on the same side of both$/, () => "到形状的距离超过其三角形误差上界的点，对两者都在同一侧。"],
  [/^no region on the wrong side was missed by the (\d+) points whose winding numbers were compared$/, (n) => `比较了 ${n} 个点的环绕数，没有漏掉内外相反的区域。`],
  [/^a shape whose distance was computed anew is replaced by triangles, which are up to (\S+) away from it$/, (most) => `重新计算距离的形状由三角形代替，两者相距至多 ${most}。`],
  [/^the computed signs of the field are right at (\d+) samples where rounding could change them$/, (n) => `有 ${n} 个样本的符号可能因舍入而变，计算出的符号都正确。`],
  [
    /^along the triangles of a mesh that is open or crosses itself, nothing is thinner than (\S+): .* \((\d+) places could have one\)$/,
    (thin, n) => `网格开放或自相交，沿其三角形没有比 ${thin} 更薄的东西：样本之间没有薄膜、缝隙或凸起（有 ${n} 处可能存在）。`,
  ],
  [/^the field has no interior points outside the box from (.*) to (.*)$/, (low, high) => `在从 ${low} 到 ${high} 的盒子之外，场没有内部点。`],
  [/^the sign expression has the sign of the field's value everywhere$/, () => "符号表达式处处与场的值同号。"],
  [/^an outline that crosses itself is cut at its crossings, which moves it by at most (\S+)$/, (most) => `自相交的轮廓在交点处切开，移动至多 ${most}。`],
  [/^a displacement takes off no more than its amplitude, (.*)$/, (amplitude) => `位移削去的不超过其振幅 ${amplitude}。`],
];

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
  tessellate: "曲面细分",
};

function said({ code, values = {} }: Sentence): string | undefined {
  const translation = MEANINGS[code];
  return typeof translation === "function" ? translation(values) : translation;
}

/** Replaces the command's options in a sentence by words. */
const worded = (english: string): string =>
  english
    .replace("which `inspect --self-intersections` shows afterwards", "which a search for self-intersections shows afterwards")
    .replace(/which `mend --weld=[^`]+` joins/, "which welding joins");

/** The options for welding over a distance that a sentence names: only the reader can decide on that repair. A report of an
 * older command has no sentences. */
export const joining = (sentences: readonly Sentence[] = []): readonly string[] =>
  sentences.flatMap(({ code, values }) => (code === "nearly-joined" && values?.["within"] ? [`--weld=${values["within"]}`] : []));

const spoken = (language: Language, english: string, chinese: string | undefined): Spoken => {
  if (language === "en") return { text: english };
  return chinese === undefined ? { text: english, lang: "en" } : { text: chinese };
};

/** The meaning of a finding. If any of its sentences is unknown, it stays English as a whole. */
export function meaningIn(language: Language, { means, sentences = [] }: { means: string; sentences?: readonly Sentence[] }): Spoken {
  const all = sentences.map(said);
  return spoken(language, worded(means), all.length === 0 || all.includes(undefined) ? undefined : all.join(""));
}

/** The advice on a finding. */
export function adviceIn(language: Language, { of, advice, advice_code: code = null }: { of: string; advice: string | null; advice_code?: string | null }): Spoken | null {
  if (advice === null) return null;
  return spoken(language, worded(advice), code === null ? undefined : (ADVICE[code] ?? (code === of ? LOOK : undefined)));
}

/** An assumption of a proof. */
export function assumptionIn(language: Language, english: string): Spoken {
  for (const [pattern, chinese] of ASSUMPTIONS) {
    const match = pattern.exec(english);
    if (match) return spoken(language, english, chinese(...match.slice(1)));
  }
  return spoken(language, english, undefined);
}

/** The sentences about mistakes are many, and loaded for Chinese readers alone. */
let sentences: typeof import("./sentences") | undefined;
export const loadSentences = async (): Promise<void> => {
  sentences = await import("./sentences");
};

/** An error. A sentence that has no translation stays English, after what its code says in Chinese. */
export interface Failed extends Spoken {
  lead?: string;
}

export function faultIn(language: Language, { text, code }: { text: string; code?: string | undefined }): Failed {
  if (language === "en") return { text };
  const chinese = sentences?.chineseOf(text);
  if (chinese !== undefined) return { text: chinese };
  // The codes of a GLB are those of Khronos' validator, in capitals.
  const lead = code === undefined ? undefined : ERRORS[/^[A-Z_]+$/.test(code) ? "glb" : code];
  // What a script says itself may be Chinese.
  const lang = /\p{Script=Han}/u.test(text) ? {} : ({ lang: "en" } as const);
  return { ...(lead === undefined ? {} : { lead }), text, ...lang };
}

/** A line that a script printed, or that a function added to them. */
export const lineIn = (language: Language, line: string): string => (language === "zh" ? sentences?.noteOf(line) : undefined) ?? line;

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
