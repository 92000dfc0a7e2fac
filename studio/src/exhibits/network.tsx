// A learned occupancy: a small network says how surely a point is inside; samples on a lattice and a threshold make a mesh.
import { Choice, Row, Slider } from "../view/parts";
import type { Layer, Picture, Vec3, View } from "../viewer";
import { Chart, chain } from "./Chart";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { number, numbers, view, word } from "./fragment";
import { FRAME } from "./frame_texts";
import { px } from "./Grip";
import { Knob } from "./Knob";
import { PAINT } from "./paint";
import { Scene } from "./Scene";
import type { Language } from "./say";

type Look = "samples" | "both" | "mesh";

interface State {
  look: Look;
  cells: number;
  /** In hundredths. */
  threshold: number;
  probe: Vec3;
  view: View;
}

interface Answer {
  mesh: { positions: Float32Array; indices: Uint32Array } | null;
  edges: Float32Array | null;
  /** The samples above the threshold. */
  inside: Float32Array;
  samples: number;
  n_inside: number;
  triangles: number;
  pieces: number;
  weights: number;
  sizes: number[];
  step: number;
  occupancy: number;
  distance: number;
  /** Along the line through the probe. */
  line: [x: number, occupancy: number, distance: number][];
  boxes: number;
  undecided: number;
}

const [FEWEST, MOST] = [4, 64] as const;
const HOME: View = { azimuth: -58, elevation: 18, distance: 6.4, target: [0, 0, 0] };
const defaults: State = { look: "both", cells: 24, threshold: 50, probe: [0.2, 0, -0.25], view: HOME };

interface Texts extends CommonTexts {
  figure: string;
  look: string;
  looks: Record<Look, string>;
  cells: string;
  along(n: number): string;
  threshold: string;
  probe: string;
  at(x: string, y: string, z: string): string;
  label: string;
  meaning(occupancy: string, distance: string): string;
  empty: string;
  chart: string;
  chartX: string;
  occupancy: string;
  distance: string;
  weights: string;
  samples: string;
  inside: string;
  triangles: string;
  pieces: string;
  excluded: string;
  of(n: string, all: string): string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: `Drag the point to ask the network there. ${FRAME.en.turn}`,
    figure: "The samples that a small network calls inside, and the mesh of the threshold: a ball with a handle",
    look: "Show",
    looks: { samples: "samples", both: "both", mesh: "mesh" },
    cells: "Cells along a side",
    along: (n) => `${n} cells`,
    threshold: "Inside, from an occupancy of",
    probe: "The point that is asked about",
    at: (x, y, z) => `x ${x}, y ${y}, z ${z}`,
    label: "Occupancy at the point",
    meaning: (occupancy, distance) => `The network is ${occupancy} sure that it is inside. The true shape’s surface is ${distance} away; the network does not say so.`,
    empty: "No sample is above the threshold.",
    chart: "Along the line through the point: occupancy, and the true distance",
    chartX: "x",
    occupancy: "occupancy",
    distance: "true distance",
    weights: "Numbers of the network",
    samples: "Samples",
    inside: "of them inside",
    triangles: "Triangles",
    pieces: "Pieces",
    excluded: "Boxes proved to be free of surface",
    of: (n, all) => `${n} of ${all}`,
    story: [
      "A rule need not be written by hand. This one was *learned*: a network of 3, 16, 16 and 1 units, 353 numbers in all, was shown points of a ball with a handle and whether they are inside. It answers any point with an *occupancy* from 0 to 1. To draw it, take samples on a lattice and polygonize the *threshold*: this is how 3-D vision turns what it has learned into triangles.",
      "An occupancy is *not a distance*. It is near 0 or 1 almost everywhere and climbs steeply across the surface, where the network is unsure. So it says on which side a point is, but not how far away the surface is: no safe step for a ray, no offset. Another threshold moves the surface, by a different length at every place.",
      "The curves show both along the line through your point. Each unit is a weighted sum bent by x ÷ √(1 + x²), so the core can evaluate the network over whole boxes by interval arithmetic, and prove for some that no surface of this threshold is in them. The rest stays open, because intervals through two layers are wide.",
    ],
    attempts: [
      "Lower the cells to 8, then raise them: when does the handle get its hole?",
      "Move the threshold from 0.02 to 0.98. Where does the surface move most?",
    ],
  },
  zh: {
    hint: `拖动测试点，问一问网络。${FRAME.zh.turn}`,
    figure: "小型神经网络判为内部的样本，以及阈值处的网格：带提手的球",
    look: "显示",
    looks: { samples: "样本", both: "两者", mesh: "网格" },
    cells: "每边单元数",
    along: (n) => `${n} 个单元`,
    threshold: "占据值高于此即算内部",
    probe: "测试点",
    at: (x, y, z) => `x ${x}，y ${y}，z ${z}`,
    label: "这一点的占据值",
    meaning: (occupancy, distance) => `网络有 ${occupancy} 的把握认为它在内部。真实形状的表面离它 ${distance}，网络却没有说。`,
    empty: "没有样本高于阈值。",
    chart: "过这一点的直线上：占据值与真实距离",
    chartX: "x",
    occupancy: "占据值",
    distance: "真实距离",
    weights: "网络的参数个数",
    samples: "样本数",
    inside: "其中在内部",
    triangles: "三角形数",
    pieces: "块数",
    excluded: "已证明没有曲面的方块",
    of: (n, all) => `${all} 个中的 ${n} 个`,
    story: [
      "规则不一定要人来写，也可以*学*出来：一个神经元为 3、16、16、1 个的网络，一共 353 个参数，看过许多点，知道它们在不在一个带提手的球里。此后问它任何一点，它都给出 0 到 1 之间的*占据值*。要画出来，就在格点上取样，再把*阈值*处的面连成三角形：三维视觉正是这样把学到的东西变成网格的。",
      "占据值*不是距离*。它几乎处处接近 0 或 1，只在网络拿不准的表面附近陡然上升。所以它说得出点在哪一侧，却说不出表面有多远：射线不能拿它当步长，也不能用它做偏移。换一个阈值，曲面就移动，各处移动的多少却不一样。",
      "曲线画的是过这一点的直线上的两个值。每个神经元都是加权和，再用 x ÷ √(1 + x²) 压弯，所以核心能用区间算术对整个方块求值，证明其中一些方块里没有这个阈值的曲面。其余的无法断定，因为区间穿过两层网络就变宽了。",
    ],
    attempts: ["把单元数降到 8，再往上加：提手什么时候才有孔？", "阈值从 0.02 移到 0.98，曲面在哪里移动最多？"],
  },
};

type Page = PageOf<State, Answer, Texts>;

/** The lattice's border: the twelve edges of a cube. */
const BORDER = new Float32Array(
  [0, 1, 2, 3, 4, 5, 6, 7].flatMap((a) =>
    [1, 2, 4].filter((bit) => !(a & bit)).flatMap((bit) => [a, a | bit].flatMap((c) => [0, 1, 2].map((k) => ((c >> k) & 1) * 2 - 1))),
  ),
);

function pictureOf({ state, answer, isStill }: Page): Picture {
  const { mesh, edges, inside } = answer;
  const [, y, z] = state.probe;
  const layers: Layer[] = [
    { kind: "lines", id: "border", positions: BORDER, paint: "--line", width: 1.2 },
    { kind: "lines", id: "line", positions: new Float32Array([-1, y, z, 1, y, z]), paint: "--gap", width: 1.6, isOnTop: true },
  ];
  if (mesh && state.look !== "samples") {
    layers.push({ kind: "mesh", id: "mesh", ...mesh, paint: PAINT.front, shading: "flat", sides: isStill ? "front" : "both", ...(state.look === "both" ? { opacity: 0.75 } : {}) });
    if (!isStill && edges) layers.push({ kind: "lines", id: "wire", positions: edges, paint: "#24446b", width: 0.7 });
  }
  if (state.look !== "mesh" && !(isStill && mesh)) {
    layers.push({ kind: "points", id: "inside", positions: inside, paint: "#b4531f", size: Math.max(2, Math.min(7, 30 * answer.step)) });
  }
  return { layers };
}

function Figure({ page }: { page: Page }) {
  const { state, texts, say, set, isStill } = page;
  const [x, y, z] = state.probe.map((c) => say.fixed(c)) as [string, string, string];
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
        <Knob
          name={texts.probe}
          spoken={`${texts.at(x, y, z)}${say.marks.stop}${liveNumber(page).meaning}`}
          place={state.probe}
          at={at}
          isStill={isStill}
          within={1}
          ground={-1}
          move={(change) => set(({ probe }) => ({ probe: change(probe) }))}
        />
      )}
    />
  );
}

function liveNumber({ answer, say, texts }: Page): LiveNumber {
  const { occupancy, distance } = answer;
  return {
    value: occupancy,
    shown: say.fixed(occupancy, 3),
    label: texts.label,
    meaning: answer.mesh ? texts.meaning(say.percent(occupancy), say.fixed(Math.abs(distance))) : texts.empty,
    tone: "plain",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const threshold = state.threshold / 100;
  const rows = [
    ["weights", texts.weights, answer.weights],
    ["samples", texts.samples, answer.samples],
    ["inside", texts.inside, answer.n_inside],
    ["triangles", texts.triangles, answer.triangles],
    ["pieces", texts.pieces, answer.pieces],
  ] as const;
  const free = answer.boxes - answer.undecided;
  return (
    <>
      <Choice
        name="look"
        legend={texts.look}
        value={state.look}
        options={(["samples", "both", "mesh"] as const).map((value) => ({ value, label: texts.looks[value] }))}
        choose={(look) => set({ look })}
      />
      <Slider
        id="cells"
        label={texts.cells}
        shown={String(state.cells)}
        spoken={texts.along(state.cells)}
        low={FEWEST}
        high={MOST}
        value={state.cells}
        choose={(cells) => set({ cells })}
      />
      <Slider
        id="threshold"
        label={texts.threshold}
        shown={say.fixed(threshold)}
        low={2}
        high={98}
        value={state.threshold}
        choose={(threshold) => set({ threshold })}
      />
      <Chart
        name={texts.chart}
        x={{ low: -1, high: 1, label: texts.chartX, ticks: [-1, -0.5, 0, 0.5, 1].map((x) => [x, say.number(x)]) }}
        y={{ low: -0.6, high: 1.2, label: "", ticks: [-0.5, 0, 0.5, 1].map((y) => [y, say.number(y)]) }}
      >
        {(at) => {
          const [x, y] = at(state.probe[0], answer.occupancy);
          return (
            <>
              <path class="goal" d={chain(at, [[-1, threshold], [1, threshold]])} />
              <path class="drawn second" d={chain(at, answer.line.map(([x, , distance]) => [x, Math.min(distance, 1.2)] as const))} />
              <path class="drawn" d={chain(at, answer.line.map(([x, occupancy]) => [x, occupancy] as const))} />
              <circle class="here" r="6" cx={px(x)} cy={px(y)} />
            </>
          );
        }}
      </Chart>
      <p class="legend of-network">
        <span class="occupancy">{texts.occupancy}</span>
        <span class="distance">{texts.distance}</span>
      </p>
      <dl>
        {rows.map(([name, label, value]) => (
          <Row key={name} name={name} label={label} value={value}>
            {say.whole(value)}
          </Row>
        ))}
        <Row name="free" label={texts.excluded} value={free}>
          {texts.of(say.whole(free), say.whole(answer.boxes))}
        </Row>
      </dl>
    </>
  );
}

const coordinates = numbers(3, 3, number(-1, 1, 100));

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    look: ["s", word("samples", "both", "mesh")],
    cells: ["n", number(FEWEST, MOST)],
    threshold: ["h", number(2, 98)],
    probe: ["p", { write: (value) => coordinates.write(value), read: (text) => coordinates.read(text) as Vec3 | undefined }],
    view: ["o", view],
  },
  question: ({ cells, threshold, probe }) => ({ cells, threshold: threshold / 100, probe }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
