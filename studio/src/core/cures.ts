// The repairs of meshes, in the order in which they are applied: the name of each, and its effect in the words of the pages.

/** The effect: in a sentence of the workbench, as a button of the exhibit, and in Chinese. */
const CURES = {
  weld: { en: "weld equal vertices", button: "Weld equal vertices", zh: "焊接重合的顶点" },
  "drop-duplicates": { en: "delete duplicate triangles", button: "Drop repeated triangles", zh: "删除重复的三角形" },
  "drop-degenerate": { en: "delete triangles without area", button: "Drop triangles without area", zh: "删除零面积三角形" },
  "resolve-t-junctions": { en: "split edges at T-junctions", button: "Split edges at T-junctions", zh: "在 T 形接点处拆分边" },
  "split-nonmanifold": { en: "cut the surface apart at its branches", button: "Split where sheets branch", zh: "在分叉处拆开" },
  orient: { en: "orient triangles consistently", button: "Orient triangles consistently", zh: "翻转三角形使方向一致" },
  "fill-holes": { en: "fill holes", button: "Fill the hole", zh: "补孔" },
  "drop-unused": { en: "delete unused vertices", button: "Drop unused vertices", zh: "删除未使用的顶点" },
} as const;

/** A repair, by its name. */
export type Cure = keyof typeof CURES;

/** The names of all. */
export const CURE_NAMES = Object.keys(CURES) as readonly Cure[];

/** The effect of each, in one wording. */
export const cureTexts = (wording: "en" | "button" | "zh"): Record<Cure, string> =>
  Object.fromEntries(CURE_NAMES.map((cure) => [cure, CURES[cure][wording]])) as Record<Cure, string>;
