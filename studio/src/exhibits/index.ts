// The exhibits in the lesson's order. Each has a page in two languages: `<id>.html` and `<id>.zh.html`.
import type { AnyExhibit } from "./exhibit";
import type { Language } from "./say";

type Both = Record<Language, string>;

export interface Entry {
  id: string;
  part: 1 | 2 | 3 | 4 | 5;
  title: Both;
  /** One sentence that the exhibit demonstrates. */
  claim: Both;
  load(): Promise<{ default: AnyExhibit }>;
}

/** The titles of the lesson's five parts. */
export const PARTS: Record<Entry["part"], Both> = {
  1: { en: "The triangle is the atom", zh: "三角形是原子" },
  2: { en: "The mesh stores millions", zh: "网格存下百万个三角形" },
  3: { en: "Authored smooth", zh: "用光滑的曲线曲面造型" },
  4: { en: "The other answer: f(x) = 0", zh: "另一种回答：f(x) = 0" },
  5: { en: "The cost", zh: "代价" },
};

export const EXHIBITS: readonly Entry[] = [
  {
    id: "quad",
    part: 1,
    title: { en: "Three corners or four", zh: "三个顶点还是四个顶点" },
    claim: {
      en: "Three points always lie in one plane. A fourth can leave it.",
      zh: "三点必共面，第四点却可以离开这个平面。",
    },
    load: () => import("./quad"),
  },
  {
    id: "inside",
    part: 1,
    title: { en: "Inside, by three signs", zh: "三个符号判定内外" },
    claim: {
      en: "A point is inside a triangle if it lies on the same side of all three edges.",
      zh: "点位于三条边的同一侧，就在三角形内。",
    },
    load: () => import("./inside"),
  },
  {
    id: "pixels",
    part: 1,
    title: { en: "Three signs for every pixel", zh: "每个像素问三个符号" },
    claim: {
      en: "A pixel is filled if its centre is on the same side of all three edges; on a shared edge a rule picks one owner.",
      zh: "像素中心在三条边的同一侧就填充；落在公共边上，由规则指定归谁。",
    },
    load: () => import("./pixels"),
  },
  {
    id: "weights",
    part: 1,
    title: { en: "Three weights", zh: "三个权重" },
    claim: {
      en: "Three corners blend linearly in one way only. Four corners leave a choice.",
      zh: "三个顶点的线性混合方式唯一，四个顶点就要做选择。",
    },
    load: () => import("./weights"),
  },
  {
    id: "tangent",
    part: 1,
    title: { en: "The third arrow", zh: "第三支箭头" },
    claim: {
      en: "Texture coordinates decide the tangent, and a mirrored texture has the other hand.",
      zh: "纹理坐标决定切线；纹理一镜像，手性就反过来。",
    },
    load: () => import("./tangent"),
  },
  {
    id: "fan",
    part: 1,
    title: { en: "Any polygon, n − 2 triangles", zh: "任意多边形，n − 2 个三角形" },
    claim: {
      en: "Whichever diagonals you choose, a polygon of n corners gives n − 2 triangles.",
      zh: "不管选哪几条对角线，n 个顶点的多边形总是剖成 n − 2 个三角形。",
    },
    load: () => import("./fan"),
  },
  {
    id: "indexed",
    part: 2,
    title: { en: "Store each corner once", zh: "每个顶点只存一次" },
    claim: {
      en: "About six triangles share a vertex, so an index makes a mesh less than half as large.",
      zh: "一个顶点约由六个三角形共用，用索引存储，网格大小不到一半。",
    },
    load: () => import("./indexed"),
  },
  {
    id: "cross",
    part: 2,
    title: { en: "Two edges, one normal", zh: "两条边，一条法线" },
    claim: {
      en: "The cross product of two edges gives the normal, the area and the side at once.",
      zh: "两条边的叉积，一次给出法线、面积和正反面。",
    },
    load: () => import("./cross"),
  },
  {
    id: "normals",
    part: 2,
    title: { en: "Where normals live", zh: "法线放在哪里" },
    claim: {
      en: "Faceted or round is a matter of normals, not of triangles.",
      zh: "看起来有棱还是圆滑，取决于法线，而不是三角形。",
    },
    load: () => import("./normals"),
  },
  {
    id: "culling",
    part: 2,
    title: { en: "Which way round", zh: "环绕方向" },
    claim: {
      en: "The order of three corners says which side is the front, and culling relies on it.",
      zh: "三个顶点的次序决定哪面是正面，背面剔除只认这个次序。",
    },
    load: () => import("./culling"),
  },
  {
    id: "doctor",
    part: 2,
    title: { en: "The mesh doctor", zh: "网格医生" },
    claim: {
      en: "A mesh has an inside if every edge joins exactly two triangles with matching orientation.",
      zh: "每条边恰好连接两个方向一致的三角形，网格才分得出内外。",
    },
    load: () => import("./doctor"),
  },
  {
    id: "bernstein",
    part: 3,
    title: { en: "Four weights and a hull", zh: "四个权重与凸包" },
    claim: {
      en: "Four weights that are never negative and sum to one keep a curve in the hull of its points.",
      zh: "四个权重都不为负、总和为一，曲线就留在控制点的凸包内。",
    },
    load: () => import("./bernstein"),
  },
  {
    id: "runge",
    part: 3,
    title: { en: "One polynomial or many", zh: "一个多项式还是许多段" },
    claim: {
      en: "If one point moves, a polynomial through many moves between all the others.",
      zh: "一个多项式穿过许多点：一点移动，其余各点之间处处都动。",
    },
    load: () => import("./runge"),
  },
  {
    id: "spline",
    part: 3,
    title: { en: "How far a point reaches", zh: "一个点能管多远" },
    claim: {
      en: "A local spline moves four pieces with a point, a smoother one a little of everything.",
      zh: "局部的样条只随一个点动四段；更光滑的样条，处处都动一点。",
    },
    load: () => import("./spline"),
  },
  {
    id: "joins",
    part: 3,
    title: { en: "Where curves meet", zh: "曲线相接之处" },
    claim: {
      en: "C0 allows a kink; C1 has none and still breaks a reflection; equal curvature, G2, keeps it smooth.",
      zh: "C0 允许折角；C1 没有折角，反射的条纹却仍会折；曲率也相等（G2），条纹才连续通过。",
    },
    load: () => import("./joins"),
  },
  {
    id: "ride",
    part: 3,
    title: { en: "Riding along", zh: "坐上去走一趟" },
    claim: {
      en: "On a C1 path the acceleration jumps at every joint; on a C2 path it does not.",
      zh: "C1 路径的加速度每到接点就突变，C2 路径不会。",
    },
    load: () => import("./ride"),
  },
  {
    id: "patch",
    part: 3,
    title: { en: "Sixteen points, one surface", zh: "十六个点，一张曲面" },
    claim: {
      en: "A patch is a curve whose four points slide along four curves; sixteen weights sum to one.",
      zh: "曲面片是一条曲线：它的四个控制点沿四条曲线滑动；十六个权重总和为一。",
    },
    load: () => import("./patch"),
  },
  {
    id: "cage",
    part: 3,
    title: { en: "From cage to limit", zh: "从控制网格到极限曲面" },
    claim: {
      en: "Each round of subdivision has four times the faces and leaves about a quarter of the error.",
      zh: "每细分一次，面数变为四倍，误差约降到四分之一。",
    },
    load: () => import("./cage"),
  },
  {
    id: "pull",
    part: 3,
    title: { en: "Pull the cage", zh: "拉动控制网格" },
    claim: {
      en: "A corner of the cage moves most the surface near it: on a cube, by three eighths of its way.",
      zh: "控制网格的一个顶点，牵动最多的是近旁的曲面：在立方体上，曲面走它的八分之三。",
    },
    load: () => import("./pull"),
  },
  {
    id: "cracks",
    part: 3,
    title: { en: "One side, cut once", zh: "公共边只分一次" },
    claim: {
      en: "Two patches crack if each cuts their common side into its own number of segments.",
      zh: "两片各按各的段数剖分公共边，就会裂开。",
    },
    load: () => import("./cracks"),
  },
  {
    id: "field",
    part: 4,
    title: { en: "A rule instead of a list", zh: "用规则代替清单" },
    claim: {
      en: "One value of a field gives the side by its sign and the distance by its size; a mesh has to be searched.",
      zh: "场用一个符号分出内外，用一个值给出距离；网格则要搜索。",
    },
    load: () => import("./field"),
  },
  {
    id: "tracing",
    part: 4,
    title: { en: "Rays that leap", zh: "跳着走的射线" },
    claim: {
      en: "The value is a safe step, so rays leap; rays that graze the surface take many steps.",
      zh: "场的值就是安全的步长，所以射线可以跳着走；掠过表面的要走很多步。",
    },
    load: () => import("./tracing"),
  },
  {
    id: "csg",
    part: 4,
    title: { en: "Booleans in one line", zh: "一行布尔运算" },
    claim: {
      en: "Minimum and maximum get every sign right; the value stops being a distance.",
      zh: "取最小、取最大，符号处处正确，值却不再处处是距离。",
    },
    load: () => import("./csg"),
  },
  {
    id: "blend",
    part: 4,
    title: { en: "Shapes that flow together", zh: "流到一起的形状" },
    claim: {
      en: "A smooth minimum fills the seam of a union; its value is a lower bound of the distance.",
      zh: "光滑最小值填满并集的接缝，它的值是距离的下界。",
    },
    load: () => import("./blend"),
  },
  {
    id: "booleans",
    part: 4,
    title: { en: "Where a mesh cracks", zh: "网格在哪里裂开" },
    claim: {
      en: "One sign for each point cannot crack; a mesh that is cut in rounded numbers can.",
      zh: "每一点一个符号，裂不开；用舍入的数去切网格，就会裂。",
    },
    load: () => import("./booleans"),
  },
  {
    id: "squares",
    part: 4,
    title: { en: "From samples to lines", zh: "从样本到线" },
    claim: {
      en: "A lattice of samples cuts sharp corners off; a mesher that knows the parts keeps them.",
      zh: "格点采样会切掉尖角；网格化算法若知道形状由哪些部分组成，就能保住它。",
    },
    load: () => import("./squares"),
  },
  {
    id: "cubes",
    part: 4,
    title: { en: "A surface from cells", zh: "由单元拼成的曲面" },
    claim: {
      en: "A surface crosses few of the cells, and what an edge does inside one is cut off.",
      zh: "曲面只穿过少数单元，落在单元内部的棱会被切掉。",
    },
    load: () => import("./cubes"),
  },
  {
    id: "network",
    part: 4,
    title: { en: "A rule that was learned", zh: "学出来的规则" },
    claim: {
      en: "A network’s occupancy says on which side a point is, and not how far away the surface is.",
      zh: "网络的占据值说得出一点在哪一侧，说不出表面有多远。",
    },
    load: () => import("./network"),
  },
  {
    id: "baking",
    part: 4,
    title: { en: "There and back", zh: "一来一回" },
    claim: {
      en: "A mesh baked to a grid and back: each way has a proved bound, and the two add up.",
      zh: "网格烘焙到格点上，再转换回来：每一程都有已证明的上界，两者相加。",
    },
    load: () => import("./baking"),
  },
  {
    id: "budget",
    part: 5,
    title: { en: "What half the error costs", zh: "误差减半的代价" },
    claim: {
      en: "Half the error takes about twice the triangles, whether a surface is given as patches, a cage or a field.",
      zh: "误差减半，三角形约加倍，无论曲面写成曲面片、控制网格还是场。",
    },
    load: () => import("./budget"),
  },
  {
    id: "overshade",
    part: 5,
    title: { en: "The cliff below a pixel", zh: "小于像素的悬崖" },
    claim: {
      en: "Triangles below a pixel cost four times as much and show nothing more.",
      zh: "小于一个像素的三角形，代价是四倍，却不多显示任何东西。",
    },
    load: () => import("./overshade"),
  },
  {
    id: "shimmer",
    part: 5,
    title: { en: "Too small to see", zh: "小得看不见" },
    claim: {
      en: "Triangles smaller than a pixel make a picture shimmer while it turns.",
      zh: "比像素还小的三角形，会让转动的画面闪烁。",
    },
    load: () => import("./shimmer"),
  },
  {
    id: "levels",
    part: 5,
    title: { en: "One pixel, near and far", zh: "远近都是一个像素" },
    claim: {
      en: "The error that matters is on the screen: from ten times as far, a small part of the triangles keeps it below a pixel.",
      zh: "要紧的是屏幕上的误差：远到十倍，只用一小部分三角形，误差就不到一个像素。",
    },
    load: () => import("./levels"),
  },
  {
    id: "adaptive",
    part: 5,
    title: { en: "Finest where it shows", zh: "看得见的地方才细" },
    claim: {
      en: "Triangles crowd where a surface bends, near the eye and along its outline.",
      zh: "三角形集中在弯曲处、近处和轮廓线上。",
    },
    load: () => import("./adaptive"),
  },
  {
    id: "mountain",
    part: 5,
    title: { en: "A teapot and a mountain", zh: "茶壶与山" },
    claim: {
      en: "Within a pixel each, a mountain takes thousands of triangles, as a teapot on the desk does, and not millions.",
      zh: "都以一个像素为限，一座山和桌上的茶壶一样，要几千个三角形，而不是几百万。",
    },
    load: () => import("./mountain"),
  },
  {
    id: "questions",
    part: 5,
    title: { en: "Six questions", zh: "六个问题" },
    claim: {
      en: "Six questions, six numbers: each can be answered by moving something.",
      zh: "六个问题，六个数字：每个都能动手找到答案。",
    },
    load: () => import("./questions"),
  },
];

/** The widget is a stop of the tour, too: after this exhibit, or at the end of its part. */
export const WIDGET = { part: 3, after: "pull", file: { en: "index.html", zh: "zh.html" } } as const;

/** A stop of the tour: an exhibit, or the widget. */
export type Stop = Entry | typeof WIDGET;

/** All stops, in order. */
export const STOPS: readonly Stop[] = (() => {
  const after = EXHIBITS.findIndex(({ id }) => id === WIDGET.after) + 1;
  const index = after || EXHIBITS.filter(({ part }) => part <= WIDGET.part).length;
  return [...EXHIBITS.slice(0, index), WIDGET, ...EXHIBITS.slice(index)];
})();

/** The file of a stop's page. */
export const fileOfStop = (stop: Stop, language: Language) => ("id" in stop ? fileOf(stop.id, language) : stop.file[language]);

/** The file of an exhibit's page. */
export const fileOf = (id: string, language: Language) => (language === "en" ? `${id}.html` : `${id}.${language}.html`);
