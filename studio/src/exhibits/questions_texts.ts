// The six questions and their answers in both languages.
import type { Texts } from "./questions";
import type { Language } from "./say";

export const QUESTIONS = ["triangles", "normals", "winding", "joins", "fields", "cost"] as const;
export type Question = (typeof QUESTIONS)[number];

export const texts: Record<Language, Texts> = {
  en: {
    hint: "Choose a question, answer it for yourself, then look at the number and at the exhibit that shows it.",
    figure: "Six cards, one for each question, with a small picture and a number",
    choose: "Question",
    questions: {
      triangles: "Why triangles?",
      normals: "How is a face normal computed, and what makes shading flat or smooth?",
      winding: "What does winding encode, and why does culling depend on it?",
      joins: "What are C0, C1 and C2, and why use many pieces of low degree?",
      fields: "What are meshes good and bad at, and what are fields?",
      cost: "Are more triangles always better?",
    },
    short: {
      triangles: "out of plane",
      normals: "vertices of a cube",
      winding: "holes in a ball",
      joins: "class, jump of curvature",
      fields: "distance by one value",
      cost: "shaded per pixel",
    },
    answers: {
      triangles:
        "Three points always lie in one plane, are convex, and interpolate the values at them in only one way. A fourth can leave the plane, and then the surface depends on the diagonal.",
      normals:
        "The cross product of two sides, scaled to length one. With one normal per face the shading is flat; averaged at shared vertices it is smooth. A hard edge keeps the normals of both faces, so a cube has 24 vertices and not 8.",
      winding:
        "Which side is the front: seen from there the corners run counter-clockwise. Culling skips triangles that show their back, half of a closed shape or more, and relies on the order. A triangle with the wrong order becomes a hole.",
      joins:
        "C0: the curves meet. C1: with the same direction and speed. C2: with the same bending, too. Here they are C1, and the curvature still jumps, which a reflection shows. One polynomial through many points swings and moves everywhere; pieces stay local.",
      fields:
        "A mesh is drawn at once; its inside and its booleans need a search. A field gives inside, distance and booleans in a line; to be drawn it has to be traced or meshed. Engines use both and convert, with a bound for each way.",
      cost: "Until every chord is within a pixel, yes. Beyond that they show nothing new, and once they are smaller than a pixel each pixel is shaded four times.",
    },
    see: "Shown in",
    widget: "Two curves joined",
    story: [
      "Six questions are left for you. Each has a number, the one that its exhibit shows when it is opened, computed by the core while you read. *Go there, move something*, and see how it changes. If an answer is not what you expected, try to break the claim.",
      "*How do you represent a shape?* As points that can be listed and drawn, or as a rule that can be evaluated at any point; everything else followed from that.",
      "One sentence sums it all up: *decide how much error is allowed, and ask for a proof of the error that was made.* The program behind these pages does that for whole files: chordal mesh teapot.bpt --px 1.",
    ],
    attempts: [
      "Answer all six without looking. Which one took longest?",
      "Take the third to its exhibit, and turn the ball until the number is zero.",
    ],
  },
  zh: {
    hint: "选一个问题，先自己回答，再看数字，以及展示它的展品。",
    figure: "六张卡片，每个问题一张，有小图和数字",
    choose: "问题",
    questions: {
      triangles: "为什么用三角形？",
      normals: "面法线怎样计算？什么决定是平面着色还是平滑着色？",
      winding: "环绕方向表示什么？背面剔除为什么依赖它？",
      joins: "C0、C1、C2 是什么？为什么要用许多低次的小段？",
      fields: "网格和场各擅长什么，又不擅长什么？",
      cost: "三角形总是越多越好吗？",
    },
    short: {
      triangles: "离开平面",
      normals: "立方体的顶点",
      winding: "球上的孔",
      joins: "类别与曲率突变",
      fields: "一次求值得到的距离",
      cost: "每像素着色",
    },
    answers: {
      triangles: "三点必共面，必为凸形，顶点上的量只有一种混合方式。第四点可以离开平面，这时曲面取决于对角线怎么取。",
      normals:
        "两条边的叉积，再单位化。每个面各用自己的，就是平面着色；在公共顶点上取平均，着色就平滑。硬边两者都要，所以立方体有 24 个顶点，而不是 8 个。",
      winding:
        "表示哪面是正面：从正面看，顶点按逆时针排列。剔除会略过背对视点的三角形，封闭形状有一半以上，它只认次序。翻转一个三角形，就成了洞。",
      joins:
        "C0：相接；C1：方向和速度也相同；C2：弯曲也相同。这里是 C1，曲率仍有突变，反光会把它显出来。一个多项式穿过许多点就会摆动，而且牵一发动全身；小段只影响局部。",
      fields:
        "网格拿来就能画，内外和布尔运算却要搜索。场一行就能回答内外、距离和布尔运算，要画却得追踪或网格化。引擎两者兼备，互相转换，每一程都有上界。",
      cost: "在每条弦的误差降到一个像素以内之前，是的。再往后就看不出来了；三角形小于一个像素时，每个像素要着色四次。",
    },
    see: "见展品",
    widget: "两条曲线相接",
    story: [
      "还有六个问题留给你。每个问题有一个数字，就是对应展品打开时显示的那一个，由内核在你阅读时算出。*到那里动手移动一样东西*，看数字怎样变。答案若出乎意料，就试着推翻它的论断。",
      "*形状该怎样写下来？*写成可以列出、可以画的点，或者写成任何点都能代入的规则；其余一切都由此而来。",
      "它们的共同点是一句话：*先决定可以损失多少，再要求证明损失了多少。*这些页面背后的程序对整个文件做的正是这件事：chordal mesh teapot.bpt --px 1。",
    ],
    attempts: ["不看答案回答全部六题，哪一题花的时间最长？", "到第三题的展品去，转动球，直到数字变为零。"],
  },
};
