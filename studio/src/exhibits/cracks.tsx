// Two adjacent patches: subdivided by their own numbers they crack, with a shared subdivision of their common side they do not.
import { Choice, Row, Slider } from "../view/parts";
import { type Picture, type View, eyeOf } from "../viewer";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { number, view, word } from "./fragment";
import { FRAME } from "./frame_texts";
import { PAINT } from "./paint";
import { Scene } from "./Scene";
import type { Language } from "./say";
import { SEAM_VIEW } from "./spout";

interface State {
  right: number;
  cut: "own" | "shared";
  patches: Patches;
  view: View;
}

interface Answer {
  mesh: { positions: Float32Array; indices: Uint32Array };
  of: Uint32Array;
  seams: [Float32Array, Float32Array];
  width: number;
  at: [number, number, number];
  pixels: number | null;
  lonely: number;
  components: number;
  triangles: number;
  off: [number, number];
}

type Patches = "hill" | "spout";
const HOMES: Record<Patches, View> = {
  hill: { azimuth: -128, elevation: 22, distance: 10.5, target: [-0.3, 0, -0.1] },
  spout: SEAM_VIEW,
};
/** The subdivision of the left patch, which is fixed. */
const LEFT = 3;
const COUNTS = [1, 12] as const;
const defaults: State = { right: 5, cut: "own", patches: "hill", view: HOMES.hill };

interface Texts extends CommonTexts {
  figure: string;
  handle: string;
  spoken(n: number): string;
  cut: string;
  own: string;
  shared: string;
  patches: string;
  of: Record<Patches, string>;
  label: string;
  width: string;
  lonely: string;
  pieces: string;
  triangles: string;
  gapes(pixels: string): string;
  same: string;
  closed(length: string): string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: FRAME.en.turn,
    figure: "Two curved patches side by side, in triangles, and the side that they share",
    handle: "Segments of the right patch",
    spoken: (n) => `${n} along each side; the left patch has ${LEFT}`,
    cut: "The shared side is cut",
    own: "by each patch",
    shared: "once, for both",
    patches: "Patches of",
    of: { hill: "a hill", spout: "a teapot’s spout" },
    label: "Widest crack, in pixels",
    width: "The same as a length",
    lonely: "Vertices without a partner",
    pieces: "Pieces of surface",
    triangles: "Triangles",
    gapes: (pixels) => `One curve, two chains of chords: between them the background shows, up to ${pixels} pixels wide in a picture 480 pixels high.`,
    same: "Both patches happen to have the same number: the same vertices, and no crack.",
    closed: (length) => `One side, cut once: both patches use the same vertices by index. It is within ${length} of the curve, as with the right patch’s own number.`,
    story: [
      "Two patches with a common side are one surface: they have the same control points there. Their triangles need not agree. A side in three segments and the same side in five are *two different chains of chords*, and the background shows between them. So *how finely a side is cut may depend on that side alone*.",
      "Even with six on one side and three on the other, where every second vertex has a partner, the vertices between have none and lie on a long edge or just off it: *T-junctions*. On a straight side nothing gapes, and yet rounding lets single pixels show through. Printing, booleans and physics need an inside, and fail on them.",
      "That is a rule and not a repair, and it needs only data that both patches have. Chordal cuts each shared side once, by its own curve and the budget, and both patches take those vertices by index. However they are cut inside, the seam is closed.",
    ],
    attempts: [
      "Try 6 and 12, multiples of three: are all vertices of the left side on the right one? Is the crack gone?",
      "Cut the side once, then move the slider through all its stops: 0 everywhere.",
    ],
  },
  zh: {
    hint: FRAME.zh.turn,
    figure: "并排的两片曲面的三角网格，以及它们的公共边",
    handle: "右片的分段数",
    spoken: (n) => `每边 ${n} 段；左片 ${LEFT} 段`,
    cut: "公共边的剖分",
    own: "各分各的",
    shared: "只分一次，两片共用",
    patches: "哪两片",
    of: { hill: "小丘", spout: "壶嘴" },
    label: "最宽裂缝（像素）",
    width: "对应的长度",
    lonely: "没有对应的顶点",
    pieces: "曲面块数",
    triangles: "三角形",
    gapes: (pixels) => `一条曲线，两条折线：两者之间露出背景，在 480 像素高的画面中最宽 ${pixels} 像素。`,
    same: "两片的分段数恰好相同：顶点相同，没有裂缝。",
    closed: (length) => `一条边只分一次：两片按索引共用同样的顶点。它与曲线的距离不超过 ${length}，与右片自行分段时相同。`,
    story: [
      "有公共边的两片是同一个曲面：边上的控制点完全相同，三角形却未必。同一条边分三段和分五段，是*两条不同的折线*，分开的地方就能看穿。所以*一条边分得多细，只能由这条边本身决定*。",
      "即使一侧六段、另一侧三段，每隔一个顶点就有对应，中间的顶点仍是孤立的，落在一条长边上，或略微偏离它：这就是 *T 形接点*。边是直的时候没有裂缝，舍入误差却会让个别像素漏出背景。凡是要分内外的，打印、布尔运算、物理模拟，都过不了这道缝。",
      "这是一条规则，不是修补，用到的只是两片都有的数据。Chordal 按公共边自身的曲线和误差预算只分一次，两片按索引取用这些顶点。片内怎样剖分都不要紧，公共边总是闭合的。",
    ],
    attempts: [
      "取 6 和 12 这样的三的倍数：左边的顶点都在右边上吗？裂缝消失了吗？",
      "改成只分一次，再把滑块拖过每一档：始终是 0。",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
const SEAMS = ["#b3261e", "#123c8c"] as const;

function pictureOf({ answer }: Page): Picture {
  const { positions, indices } = answer.mesh;
  return {
    layers: [
      {
        kind: "mesh",
        id: "patches",
        positions,
        indices,
        groups: { of: answer.of, paints: [PAINT.front, PAINT.other] },
        paint: PAINT.front,
        back: PAINT.back,
        shading: "flat",
        sides: "both",
      },
      { kind: "wire", id: "wire", positions, indices, paint: "#24446b", width: 0.7 },
      ...answer.seams.map(
        (seam, i) =>
          ({ kind: "lines", id: `seam-${i}`, positions: chain(seam), paint: SEAMS[i]!, width: 2.2 }) as const,
      ),
      ...answer.seams.map(
        (seam, i) => ({ kind: "points", id: `ends-${i}`, positions: seam, paint: SEAMS[i]!, size: 8 - 3 * i }) as const,
      ),
    ],
  };
}

/** The segments of a polyline, two points each. */
function chain(points: Float32Array): Float32Array {
  const n = points.length / 3 - 1;
  const ends = new Float32Array(6 * n);
  for (let i = 0; i < n; i++) ends.set(points.subarray(3 * i, 3 * i + 6), 6 * i);
  return ends;
}

function Figure({ page }: { page: Page }) {
  const { state, texts, set, isStill } = page;
  return (
    <Scene
      name={texts.figure}
      help="hint"
      picture={pictureOf(page)}
      view={state.view}
      home={HOMES[state.patches]}
      look={(view) => set({ view })}
      isStill={isStill}
    />
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  const pixels = answer.pixels ?? 0;
  return {
    value: answer.pixels,
    shown: pixels === 0 ? "0" : say.number(pixels),
    label: texts.label,
    meaning: state.cut === "shared" ? texts.closed(say.number(answer.off[1])) : pixels === 0 ? texts.same : texts.gapes(say.number(pixels)),
    tone: pixels === 0 ? "good" : "bad",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const rows = [
    ["width", texts.width, answer.width, say.number(answer.width)],
    ["lonely", texts.lonely, answer.lonely, say.whole(answer.lonely)],
    ["components", texts.pieces, answer.components, say.whole(answer.components)],
    ["triangles", texts.triangles, answer.triangles, say.whole(answer.triangles)],
  ] as const;
  return (
    <>
      <Slider
        id="right"
        label={texts.handle}
        shown={say.whole(state.right)}
        spoken={texts.spoken(state.right)}
        low={COUNTS[0]}
        high={COUNTS[1]}
        value={state.right}
        choose={(right) => set({ right })}
      />
      <Choice
        name="cut"
        legend={texts.cut}
        value={state.cut}
        options={[
          { value: "own", label: texts.own },
          { value: "shared", label: texts.shared },
        ]}
        choose={(cut) => set({ cut })}
      />
      <Choice
        name="patches"
        legend={texts.patches}
        value={state.patches}
        options={(["hill", "spout"] as const).map((value) => ({ value, label: texts.of[value] }))}
        choose={(patches) => set({ patches, view: HOMES[patches] })}
      />
      <dl>
        {rows.map(([name, label, value, shown]) => (
          <Row key={name} name={name} label={label} value={value}>
            {shown}
          </Row>
        ))}
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: { right: ["n", number(...COUNTS)], cut: ["c", word("own", "shared")], patches: ["p", word("hill", "spout")], view: ["o", view] },
  // The view is rounded as in the address, so that the same address always gives the same number.
  question: ({ right, cut, patches, view: from }) => ({
    left: LEFT,
    right,
    cut,
    patches,
    eye: eyeOf(view.read(view.write(from)) ?? from),
    target: (view.read(view.write(from)) ?? from).target,
  }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
