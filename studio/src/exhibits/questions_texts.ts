// The six questions and their answers in both languages.
import type { Texts } from "./questions";
import type { Language } from "./say";

export const QUESTIONS = ["triangles", "normals", "winding", "joins", "fields", "cost"] as const;
export type Question = (typeof QUESTIONS)[number];

export const texts: Record<Language, Texts> = {
  en: {
    hint: "Choose a guess or write an answer; then the card turns.",
    figure: "Six cards, one for each question",
    guess: "What do you say?",
    write: "Or in your own words",
    turn: "Turn the card",
    right: "As you said:",
    wrong: (choice) => `You chose “${choice}” See for yourself:`,
    wrote: (text) => `You wrote: ${text}`,
    label: "Cards turned",
    of: (n, all) => `${n} of ${all}`,
    none: "Each card hides a number. Say first what you think.",
    some: "A number that surprises you is worth a visit to its exhibit.",
    all: "All six. Match the budget to what can be seen, and stop where the eye can no longer tell.",
    again: "Turn all of them back",
    questions: {
      triangles: "Why triangles?",
      normals: "How is a face normal computed, and what makes shading flat or smooth?",
      winding: "What does winding encode, and why does culling depend on it?",
      joins: "What are C0, C1 and C2, and why use many pieces of low degree?",
      fields: "What are meshes good and bad at, and what are fields?",
      cost: "Are more triangles always better?",
    },
    guesses: {
      triangles: {
        all: ["They take less memory than quads.", "They are always flat and convex.", "Round surfaces consist of them."],
        right: 1,
      },
      normals: {
        all: [
          "By the cross product of two sides; by where normals are stored.",
          "By the mean of the corners; by the number of triangles.",
          "By the longest side; by the position of the lamp.",
        ],
        right: 0,
      },
      winding: {
        all: ["Which triangle is drawn first.", "How the texture is turned.", "Which side is the front."],
        right: 2,
      },
      joins: {
        all: [
          "They count control points, and few are quick to draw.",
          "They count derivatives that agree, and pieces keep a change local.",
          "They are degrees: the higher, the smoother.",
        ],
        right: 1,
      },
      fields: {
        all: [
          "A field is exact, and a mesh is always wrong.",
          "A mesh is for solids, and a field for smoke.",
          "A mesh is good to draw, a field to ask and to combine.",
        ],
        right: 2,
      },
      cost: {
        all: ["No: below a pixel they only cost.", "Yes: there is always more to see.", "Yes, if there is memory for them."],
        right: 0,
      },
    },
    answers: {
      triangles:
        "A triangle is always flat and convex, and values at its corners have only one linear blend. A fourth corner can leave the plane, and then the surface depends on the diagonal.",
      normals:
        "The cross product of two sides, scaled to length one. With one normal per face the shading is flat; averaged at shared vertices it is smooth. A hard edge keeps the normals of both faces, so a cube has 24 vertices and not 8.",
      winding:
        "Which side is the front: seen from there the corners run counter-clockwise. Culling skips triangles that show their back, about half of a closed shape, and relies on the order alone. A triangle with the wrong order becomes a hole.",
      joins:
        "C0: the curves meet. C1: with the same direction and speed. C2: with the same second derivatives, and so the same bending. Here they are C1, and the curvature jumps, which a reflection shows; for that, equal curvature (G2) would be enough. One polynomial through many points may swing, and moves between all of them; short pieces keep a change local.",
      fields:
        "A mesh is drawn at once; its inside and its booleans need a search. A distance field gives inside, distance and booleans in a line; to be drawn it has to be traced or meshed. Engines use both and convert, with a bound for each way.",
      cost: "They are, until every chord is within a pixel of the shape. Beyond that they show nothing new, and once they are smaller than a pixel, each pixel is shaded four times.",
    },
    see: "Shown in",
    widget: "Two curves joined",
    story: [
      "Six questions are left for you. On its back each card has a number, the one that its exhibit shows when it is opened. *Go there, move something*, and see how it changes. If an answer is not what you expected, try to break the claim.",
      "*How do you represent a shape?* As points that can be listed and drawn, or as a rule that can be evaluated at any point; everything else followed from that.",
      "One sentence sums it all up: *decide how much error is allowed, and ask for a proof of the error that was made.* The program behind these pages does that for whole files: chordal mesh teapot.bpt --px 1.",
    ],
    attempts: [
      "Answer all six in your own words. Which one took longest?",
      "Take the third to its exhibit, and turn the ball until the number is zero.",
    ],
  },
  zh: {
    hint: "选一个猜测，或写下答案，卡片就能翻面。",
    figure: "六张卡片，每个问题一张",
    guess: "你怎么看？",
    write: "或用自己的话写",
    turn: "翻面",
    right: "你答对了：",
    wrong: (choice) => `你选的是“${choice}”，再看看：`,
    wrote: (text) => `你写的是：${text}`,
    label: "已翻开的卡片",
    of: (n, all) => `${all} 张中的 ${n} 张`,
    none: "每张卡片背面有一个数。先说说你的想法。",
    some: "哪个数出乎意料，就值得去它的展品看看。",
    all: "六张都翻开了。预算要与看得见的相称，眼睛分不出来时就该停下。",
    again: "全部翻回去",
    questions: {
      triangles: "为什么用三角形？",
      normals: "面法线怎样计算？什么决定是平直着色还是平滑着色？",
      winding: "环绕方向表示什么？背面剔除为什么依赖它？",
      joins: "C0、C1、C2 是什么？为什么要用许多低次的小段？",
      fields: "网格和场各擅长什么，又不擅长什么？",
      cost: "三角形总是越多越好吗？",
    },
    guesses: {
      triangles: { all: ["比四边形省内存。", "总是平的，总是凸的。", "圆的曲面本来就由它组成。"], right: 1 },
      normals: {
        all: ["两条边的叉积；看法线存在哪里。", "顶点的平均；看三角形有多少。", "最长的边；看灯放在哪里。"],
        right: 0,
      },
      winding: { all: ["先画哪个三角形。", "纹理转了多少。", "哪一面是正面。"], right: 2 },
      joins: {
        all: ["指控制点的个数；点少画得快。", "指有几阶导数一致；小段能把改动限制在局部。", "指次数；次数越高越光滑。"],
        right: 1,
      },
      fields: {
        all: ["场是精确的，网格总有错。", "网格表示实体，场表示烟雾。", "网格便于绘制，场便于查询和组合。"],
        right: 2,
      },
      cost: { all: ["不是：小于一个像素就只剩代价。", "是：总有更多细节可看。", "是，只要内存装得下。"], right: 0 },
    },
    answers: {
      triangles: "三角形总是平的、凸的，顶点上的量只有一种线性混合。第四个顶点可以离开平面，这时曲面取决于对角线怎么取。",
      normals:
        "两条边的叉积，再单位化。每个面各用自己的，就是平直着色；在公共顶点上取平均，着色就平滑。硬边两者都要，所以立方体有 24 个顶点，而不是 8 个。",
      winding:
        "表示哪面是正面：从正面看，顶点按逆时针排列。剔除会略过背对视点的三角形，在封闭形状上约占一半，它只认次序。翻转一个三角形，就成了孔。",
      joins:
        "C0：相接；C1：方向和速度也相同；C2：二阶导数也相同，弯曲随之一致。这里是 C1，曲率仍有突变，反射会把它显出来；单就反射而言，曲率相等（G2）就够了。一个多项式穿过许多点可能振荡，而且一动全动；小段把改动限制在局部。",
      fields:
        "网格拿来就能画，内外和布尔运算却要搜索。距离场一行就能回答内外、距离和布尔运算，要画却得追踪或网格化。引擎两者兼备，互相转换，每一程都有上界。",
      cost: "在每条弦的误差降到一个像素以内之前，是的。再往后就看不出来了；三角形小于一个像素时，每个像素要着色四次。",
    },
    see: "见展品",
    widget: "两段曲线的拼接",
    story: [
      "还有六个问题留给你。每张卡片的背面有一个数字，就是对应展品打开时显示的那一个。*到那里动手移动一样东西*，看数字怎样变。答案若出乎意料，就试着推翻它的论断。",
      "*形状该怎样写下来？*写成可以列出、可以画的点，或者写成任何点都能代入的规则；其余一切都由此而来。",
      "它们的共同点是一句话：*先决定允许多大误差，再要求证明实际有多大误差。*这些页面背后的程序对整个文件做的正是这件事：chordal mesh teapot.bpt --px 1。",
    ],
    attempts: ["用自己的话回答全部六题，哪一题花的时间最长？", "到第三题的展品去，转动球，直到数字变为零。"],
  },
};
