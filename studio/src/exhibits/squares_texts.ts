// The texts of the exhibit on marching squares and cubes, in both languages.
import type { Texts } from "./squares";
import type { Language } from "./say";

export const texts: Record<Language, Texts> = {
  en: {
    hint: "Drag the shapes; the slider sets the cells. In the cube press a corner to switch it, and drag to turn.{keys} Arrow keys move shapes and slider and turn the cube.",
    look: "Look at",
    looks: { lattice: "a lattice", cube: "one cube" },
    figure: "A square, a triangle and a disc sampled on a lattice, and the lines that are drawn from the samples",
    cells: "Cells along the figure",
    along: (n) => `${n} cells`,
    parts: { square: "Square", wedge: "Triangle", disc: "Disc" },
    at: (x, y) => `x ${x}, y ${y}`,
    method: "Lines by",
    squares: "marching squares",
    corners: "the core’s mesher",
    label: "Largest error",
    meaning: {
      squares: (cells, segments) =>
        `That is ${cells} of a cell, at the red mark: with ${segments} segments, because the samples do not contain the corner.`,
      corners: (cells, segments) =>
        `That is ${cells} of a cell, with ${segments} segments only: corners have vertices of their own, and straight sides need no more.`,
    },
    ambiguous: "Ambiguous cells",
    segments: "Segments",
    ofCell: "In cells",
    cube: {
      figure: "A cube whose eight corners are inside or outside, and the triangles of marching cubes in it",
      label: "Ambiguous faces",
      none: "All corners are on one side: no surface passes here.",
      one: (triangles) =>
        triangles === "1"
          ? "Each face can be joined in one way only, and one triangle does it."
          : `Each face can be joined in one way only, and ${triangles} triangles do it.`,
      two: (readings) =>
        `${readings} ways to join the crossings; red is the one that was not chosen. The core cuts each inside corner off separately: the adjacent cube has the same four signs and does the same, so no hole opens.`,
      tip: (lost) =>
        `Three crossings, one triangle: the tip of the box (green) is ${lost} of a cell away. Any shape around this corner has these signs.`,
      corners: "Inside",
      corner: (n) => `Corner ${n}`,
      preset: "Patterns",
      presets: {
        corner: "one corner",
        edge: "two on an edge",
        diagonal: "a face’s diagonal",
        opposite: "opposite corners",
        every: "every other corner",
        sharp: "a sharp corner",
      },
      triangles: "Triangles",
      pieces: "Pieces of surface",
      readings: "Ways to join the crossings",
      patterns: "Patterns with such a face",
      of: (n, all) => `${n} of ${all}`,
      lost: "Length cut off the tip, in cells",
    },
    story: [
      "To draw a field, sample it on a lattice: where neighbours differ in sign, the outline passes between them. Joining these crossings cell by cell is *marching squares*; with triangles in cubes, *marching cubes*. A sharp corner inside a cell was never sampled, and is cut off. A mesher that knows the parts puts a vertex there.",
      "The two values say where a crossing lies: between −1 and 3, a quarter of the way. If the signs *alternate* around a cell, four crossings can be joined in two ways, and the samples do not say which is right: separate parts may be joined. It takes a rule, the same for both neighbours, or the mesh gets a hole.",
      "In space a cell is a cube with eight signs: 256 patterns, each with its triangles in a table. Two cubes have to agree on the face that they share, and nearly half of all patterns have an ambiguous face.",
      "Twice as many cells cut off half as much of a corner on average; how much exactly depends on where in its cell the corner lies. The error of a smooth outline falls with the square of the cell. All errors here are enclosed between two proved bounds; shown is the upper one.",
    ],
    attempts: [
      "Double the cells: how far does the error fall? Then take the core’s mesher.",
      "Look at one cube and switch its corners. How many ambiguous faces can it have?",
    ],
  },
  zh: {
    hint: "形状可以拖动，滑块改变单元数。在立方体里，点按顶点切换内外，拖动旋转。{keys}方向键移动形状和滑块、旋转立方体。",
    look: "观察",
    looks: { lattice: "格点", cube: "一个立方体" },
    figure: "在格点上采样的正方形、三角形和圆盘，以及由样本连成的线",
    cells: "宽度方向的单元数",
    along: (n) => `${n} 个单元`,
    parts: { square: "正方形", wedge: "三角形", disc: "圆盘" },
    at: (x, y) => `x ${x}，y ${y}`,
    method: "连线方法",
    squares: "移动正方形",
    corners: "核心的网格化",
    label: "最大误差",
    meaning: {
      squares: (cells, segments) => `合 ${cells} 个单元，在红色标记处：共 ${segments} 条线段，样本并不知道那里有尖角。`,
      corners: (cells, segments) => `合 ${cells} 个单元，只用 ${segments} 条线段：尖角上有自己的顶点，直边不需要更多。`,
    },
    ambiguous: "有两种连法的单元",
    segments: "线段数",
    ofCell: "合单元",
    cube: {
      figure: "八个顶点各在内或在外的立方体，以及移动立方体法在其中画出的三角形",
      label: "有两种连法的面",
      none: "顶点都在同一侧，这里没有曲面经过。",
      one: (triangles) => `每个面都只有一种连法，共 ${triangles} 个三角形。`,
      two: (readings) =>
        `交点共有 ${readings} 种连法，红线是没有采用的。核心总是把内部的顶点各自切开：相邻立方体看到同样的四个符号，做法相同，就不会出孔。`,
      tip: (lost) => `三个交点，一个三角形：盒子的尖角（绿色）离它 ${lost} 个单元。凡是包住这个顶点的形状，符号都一样。`,
      corners: "在内部的顶点",
      corner: (n) => `顶点 ${n}`,
      preset: "符号组合",
      presets: {
        corner: "一个顶点",
        edge: "一条边的两端",
        diagonal: "面的对角",
        opposite: "体对角",
        every: "相间的顶点",
        sharp: "尖角",
      },
      triangles: "三角形数",
      pieces: "曲面的块数",
      readings: "交点的连法",
      patterns: "含这种面的组合",
      of: (n, all) => `${all} 种中的 ${n} 种`,
      lost: "切掉的尖角（单元）",
    },
    story: [
      "要画出一个场，就在格点上求它的值：相邻格点符号不同，轮廓就从中间经过。逐个单元把交点连起来，就是*移动正方形法*；换成立方体里的三角形，就是*移动立方体法*。单元内部的尖角从未采样，于是被切掉；网格化算法若知道场由哪些部分组成，会在那里放一个顶点。",
      "两个值决定交点的位置：−1 与 3 之间，在四分之一处。若单元四个顶点的符号*交替*，四个交点就有两种连法，样本无法判断该用哪一种：分开的部分可能连在一起。必须有一条规则，相邻单元都遵守，否则网格会出孔。",
      "在空间中，单元是有八个符号的立方体：共 256 种组合，各自的三角形列在一张表里。两个立方体必须在公共面上一致，而近一半的组合含有歧义的面。",
      "单元数加倍，切掉的尖角平均只减半，具体取决于尖角在单元中的位置；而光滑轮廓的误差随单元大小的平方下降。这里的误差都夹在两个已证明的界之间，显示的是上界。",
    ],
    attempts: ["把单元数加倍，误差下降多少？再改用核心的网格化。", "看一个立方体，切换它的顶点：最多能有几个有歧义的面？"],
  },
};
