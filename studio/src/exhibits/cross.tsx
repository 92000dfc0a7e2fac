// The cross product of two edges of a triangle: its direction is the normal, half its length the area.
import { Choice, Figure as Data } from "../view/parts";
import { type Picture, type Vec3, type View, eyeOf } from "../viewer";
import { CornerLabels } from "./CornerLabels";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { points, view, word } from "./fragment";
import { FRAME } from "./frame_texts";
import { Knob } from "./Knob";
import { PAINT } from "./paint";
import { Scene } from "./Scene";
import type { Language } from "./say";

interface State {
  corners: readonly Vec3[];
  order: "012" | "021";
  view: View;
}

interface Answer {
  edges: [Vec3, Vec3];
  fourth: Vec3;
  normal: Vec3 | null;
  product: Vec3 | null;
  area: number;
  seen: "front" | "back" | "edge";
}

const HOME: View = { azimuth: -52, elevation: 24, distance: 7, target: [0, 0, 0.75] };
const WITHIN = 2.5;
const defaults: State = {
  corners: [
    [-0.8, -0.8, 0],
    [0.9, -0.7, 0],
    [-0.5, 0.6, 0.25],
  ],
  order: "012",
  view: HOME,
};
/** The corners in the order of the winding. */
const cornersOf = ({ corners, order }: State): [Vec3, Vec3, Vec3] =>
  order === "012" ? [corners[0]!, corners[1]!, corners[2]!] : [corners[0]!, corners[2]!, corners[1]!];

interface Texts extends CommonTexts {
  figure: string;
  corner(name: string): string;
  at(x: string, y: string, z: string): string;
  order: string;
  label: string;
  formula: string;
  edge(n: number): string;
  product: string;
  normal: string;
  seen: Record<Answer["seen"], string>;
  degenerate: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: `Drag a corner: it moves in the plane of the picture. ${FRAME.en.turn}{keys} Tab to a corner, arrows move it, Page Up and Page Down away from you and back.`,
    figure: "A triangle in space, two of its edges as arrows, and their cross product",
    corner: (name) => `Corner ${name}`,
    at: (x, y, z) => `x ${x}, y ${y}, z ${z}`,
    order: "Order of the corners",
    label: "Area: half the length of the cross product",
    formula: "n = (v₁ − v₀) × (v₂ − v₀)",
    edge: (n) => `v${"₀₁₂"[n]} − v₀`,
    product: "n",
    normal: "n / |n|",
    seen: {
      front: "The arrow points to your side: you see the front, and the corners run counter-clockwise.",
      back: "The arrow points away from you: you see the back, and the corners run clockwise.",
      edge: "You look along the triangle and see neither side.",
    },
    degenerate: "The corners are on one line: the product is zero, there is no area and no normal.",
    story: [
      "The *cross product* of two edges is perpendicular to both, so it points straight out of the triangle. Its length is the area of the parallelogram that the edges span, *twice the triangle*. Divided by its length it is the unit normal, and one formula has given normal, area and side.",
      "Swap two corners and the product turns round, at the same length: (v₂ − v₀) × (v₁ − v₀) = −n. That is why *winding* decides which side is the front, and why meshes whose triangles wind at random cannot be lit.",
      "The longer the product, the larger the triangle; so the sum of unnormalized products around a vertex is a normal weighted by area, for free.",
    ],
    attempts: [
      "Drag v₁ until the three corners are nearly on one line. What is left of the arrow?",
      "Change the order of the corners, then turn the figure until you see the front again.",
    ],
  },
  zh: {
    hint: `拖动顶点，它在画面所在的平面内移动。${FRAME.zh.turn}{keys}按 Tab 选中顶点，方向键移动，Page Up 和 Page Down 推远、拉近。`,
    figure: "空间中的三角形，两条边画成箭头，另有它们的叉积",
    corner: (name) => `顶点 ${name}`,
    at: (x, y, z) => `x ${x}，y ${y}，z ${z}`,
    order: "顶点次序",
    label: "面积：叉积长度的一半",
    formula: "n = (v₁ − v₀) × (v₂ − v₀)",
    edge: (n) => `v${"₀₁₂"[n]} − v₀`,
    product: "n",
    normal: "n / |n|",
    seen: {
      front: "箭头指向你这一侧：看到的是正面，顶点逆时针排列。",
      back: "箭头背离你：看到的是背面，顶点顺时针排列。",
      edge: "视线正好沿着三角形，哪一面都看不到。",
    },
    degenerate: "三个顶点共线：叉积为零，没有面积，也没有法线。",
    story: [
      "两条边的*叉积*同时垂直于两者，所以笔直地指向三角形之外；它的长度是两条边张成的平行四边形的面积，也就是*三角形面积的两倍*。除以自身的长度，便是单位法线。一个公式，法线、面积、正反面都有了。",
      "交换两个顶点，叉积掉头，长度不变：(v₂ − v₀) × (v₁ − v₀) = −n。所以正反面由*环绕方向*决定；三角形的环绕方向杂乱无章，光照就算不对。",
      "三角形越大，叉积越长。把一个顶点周围的叉积不加归一地相加，得到的正是按面积加权的法线，不费额外功夫。",
    ],
    attempts: [
      "拖动 v₁，让三个顶点几乎共线：箭头还剩多长？",
      "改变顶点次序，再转动图形，直到重新看见正面。",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
const floats = (...points: readonly Vec3[]) => new Float32Array(points.flat());
const plus = (a: Vec3, b: Vec3, t = 1): Vec3 => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];

/** A shaft with a head of two strokes, whose plane contains `beside`. */
function arrow(from: Vec3, along: Vec3, beside: Vec3): Vec3[] {
  const tip = plus(from, along);
  const length = Math.hypot(...along) || 1;
  const wide = 0.07 / (Math.hypot(...beside) || 1);
  const neck = plus(tip, along, -Math.min(0.16, 0.5 * length) / length);
  return [from, tip, plus(neck, beside, wide), tip, plus(neck, beside, -wide), tip];
}

function pictureOf({ state, answer }: Page): Picture {
  const corners = cornersOf(state);
  const [a, b, c] = corners;
  const { edges, fourth, product } = answer;
  const grid: Vec3[] = [];
  for (let i = -4; i <= 4; i++) grid.push([-2, i / 2, 0], [2, i / 2, 0], [i / 2, -2, 0], [i / 2, 2, 0]);
  return {
    layers: [
      { kind: "lines", id: "grid", positions: floats(...grid), paint: "--line", width: 1, isUnder: true },
      {
        kind: "mesh",
        id: "triangle",
        positions: floats(a, b, c),
        indices: new Uint32Array([0, 1, 2]),
        paint: PAINT.front,
        back: PAINT.back,
        shading: "flat",
        sides: "both",
      },
      { kind: "lines", id: "parallelogram", positions: floats(b, fourth, fourth, c, b, c), paint: "--soft", width: 1.4 },
      { kind: "lines", id: "edges", positions: floats(...arrow(a, edges[0], edges[1]), ...arrow(a, edges[1], edges[0])), paint: "--ink", width: 2.6 },
      ...(product
        ? ([{ kind: "lines", id: "product", positions: floats(...arrow(a, product, edges[0])), paint: "--gap", width: 3, isOnTop: true }] as const)
        : []),
    ],
  };
}

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill } = page;
  const names = state.order === "012" ? ["v₀", "v₁", "v₂"] : ["v₀", "v₂", "v₁"];
  const middle = state.corners.reduce<Vec3>((sum, p) => plus(sum, p, 1 / 3), [0, 0, 0]);
  return (
    <Scene
      name={texts.figure}
      help="hint"
      picture={pictureOf(page)}
      view={state.view}
      home={HOME}
      look={(view) => set({ view })}
      isStill={isStill}
      over={(at) => (
        <>
          <CornerLabels at={at} corners={state.corners} middle={middle} names={names} />
          {answer.product && <Tip at={at.to(plus(state.corners[0]!, answer.product))} />}
          {state.corners.map((place, i) => (
            <Knob
              key={i}
              name={texts.corner(names[i]!)}
              spoken={texts.at(say.fixed(place[0]), say.fixed(place[1]), say.fixed(place[2]))}
              place={place}
              at={at}
              isStill={isStill}
              within={WITHIN}
              ground={0}
              move={(change) => set(({ corners }) => ({ corners: corners.map((old, k) => (k === i ? change(old) : old)) }))}
            />
          ))}
        </>
      )}
    />
  );
}

function Tip({ at: [x, y] }: { at: readonly [number, number, number] }) {
  return (
    <text class="label" x={x + 18} y={y - 4}>
      n
    </text>
  );
}

function liveNumber({ answer, say, texts }: Page): LiveNumber {
  return {
    value: answer.area,
    shown: say.fixed(answer.area, 3),
    label: texts.label,
    meaning: answer.product ? texts.seen[answer.seen] : texts.degenerate,
    tone: !answer.product ? "bad" : answer.seen === "front" ? "good" : "plain",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const vector = (name: string, value: Vec3 | null) =>
    value
      ? value.map((x, k) => (
          <Data key={k} name={`${name}-${k}`} value={x}>
            {say.fixed(x)}
            {k < 2 ? ", " : ""}
          </Data>
        ))
      : "–";
  return (
    <>
      <Choice
        name="order"
        legend={texts.order}
        value={state.order}
        options={[
          { value: "012", label: "v₀ v₁ v₂" },
          { value: "021", label: "v₀ v₂ v₁" },
        ]}
        choose={(order) => set({ order })}
      />
      <p class="formula">{texts.formula}</p>
      <dl class="vectors">
        {answer.edges.map((edge, i) => (
          <div key={i}>
            <dt>{texts.edge(i + 1)}</dt>
            <dd>{vector(`edge-${i}`, edge)}</dd>
          </div>
        ))}
        <div>
          <dt>{texts.product}</dt>
          <dd>{vector("product", answer.product)}</dd>
        </div>
        <div>
          <dt>{texts.normal}</dt>
          <dd>{vector("normal", answer.normal)}</dd>
        </div>
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    corners: ["p", points<Vec3>(3, 3, [[-WITHIN, WITHIN], [-WITHIN, WITHIN], [-WITHIN, WITHIN]])],
    order: ["c", word("012", "021")],
    view: ["o", view],
  },
  question: (state) => ({ corners: cornersOf(state), eye: eyeOf(state.view) }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
