// Marching cubes of a whole surface: the cells that it crosses, a slice of the samples, and the edges that it cuts off.
import { Choice, Row, Slider } from "../view/parts";
import type { Layer, Picture, View } from "../viewer";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { number, view, words, word } from "./fragment";
import { FRAME } from "./frame_texts";
import { PAINT } from "./paint";
import { type Pull, Scene } from "./Scene";
import type { Language } from "./say";

type Method = "cubes" | "corners";
type Shown = "surface" | "cells" | "slice";

interface State {
  cells: number;
  method: Method;
  shown: readonly Shown[];
  /** The height of the slice, from 0 to 1. */
  slice: number;
  view: View;
}

interface Answer {
  mesh: { positions: Float32Array; indices: Uint32Array };
  edges: Float32Array;
  step: number;
  slice: number;
  /** The samples of the slice, row by row. */
  layer: Float32Array;
  /** The edges of all cells that the surface crosses, two points each. */
  cells: Float32Array;
  crossed: number;
  all: number;
  triangles: number;
  error: number;
  worst: [readonly [number, number, number], readonly [number, number, number]];
}

const [FEWEST, MOST] = [4, 40] as const;
const SHOWN: readonly Shown[] = ["surface", "cells", "slice"];
const HOME: View = { azimuth: -52, elevation: 24, distance: 6.2, target: [0, 0, 0] };
const defaults: State = { cells: 10, method: "cubes", shown: SHOWN, slice: 0.5, view: HOME };

interface Texts extends CommonTexts {
  figure: string;
  cells: string;
  along(n: number): string;
  method: string;
  methods: Record<Method, string>;
  shown: string;
  show: Record<Shown, string>;
  slice: string;
  at(height: string): string;
  label: string;
  meaning: Record<Method, (cells: string, triangles: string) => string>;
  crossed: string;
  of(n: string, all: string): string;
  triangles: string;
  samples: { inside: string; outside: string };
}

const texts: Record<Language, Texts> = {
  en: {
    hint: `Drag the arrow to move the slice. ${FRAME.en.turn}`,
    figure: "A cube, cut by a ball and bored through, as triangles in a lattice of cells; the crossed cells are outlined, and one slice of samples is shown",
    cells: "Cells along a side",
    along: (n) => `${n} cells`,
    method: "Drawn by",
    methods: { cubes: "marching cubes", corners: "the core’s mesher" },
    shown: "Show",
    show: { surface: "surface", cells: "crossed cells", slice: "slice of samples" },
    slice: "Slice",
    at: (height) => `height ${height}`,
    label: "Largest error",
    meaning: {
      cubes: (cells, triangles) => `That is ${cells} of a cell, at the red mark: ${triangles} triangles, and the edges are cut off.`,
      corners: (cells, triangles) => `That is ${cells} of a cell, with ${triangles} triangles: they meet where two parts of the shape do.`,
    },
    crossed: "Cells that the surface crosses",
    of: (n, all) => `${n} of ${all}`,
    triangles: "Triangles",
    samples: { inside: "inside", outside: "outside" },
    story: [
      "*Marching cubes* looks at one cell at a time: eight samples, each inside or outside. If all eight agree, the cell is empty. If not, the surface *crosses* it, and a table says how the crossings on its edges join to triangles. Neighbours see the same samples on the face that they share, so the triangles fit and the mesh is closed.",
      "Twice as many cells along a side are eight times as many samples, but only about four times as many crossed cells: a surface fills a share of the lattice that shrinks. An edge of the shape inside a cell was never sampled. It is *cut off*, by half as much if cells are half as large, and no lattice is fine enough to keep it.",
      "Chordal’s own mesher for fields knows the rule: where the smaller or larger of two parts counts, it puts vertices on the line where both are zero. The error is measured between the two surfaces, in both directions; shown is the proved upper end.",
    ],
    attempts: [
      "Double the cells: how many more are crossed, and how far does the error fall?",
      "Move the slice through the bore: which samples does a cell need to be crossed?",
    ],
  },
  zh: {
    hint: `拖动箭头移动切片。${FRAME.zh.turn}`,
    figure: "被球切去外角、中间钻孔的立方体，在格点里变成三角形；曲面穿过的单元画出了边框，并显示一层样本",
    cells: "每边单元数",
    along: (n) => `${n} 个单元`,
    method: "画法",
    methods: { cubes: "移动立方体", corners: "核心的网格化" },
    shown: "显示",
    show: { surface: "曲面", cells: "穿过的单元", slice: "一层样本" },
    slice: "切片",
    at: (height) => `高度 ${height}`,
    label: "最大误差",
    meaning: {
      cubes: (cells, triangles) => `合 ${cells} 个单元，在红色标记处：${triangles} 个三角形，棱被切掉了。`,
      corners: (cells, triangles) => `合 ${cells} 个单元，${triangles} 个三角形：两部分在哪里相交，三角形就在哪里相接。`,
    },
    crossed: "曲面穿过的单元",
    of: (n, all) => `${all} 个中的 ${n} 个`,
    triangles: "三角形数",
    samples: { inside: "内部", outside: "外部" },
    story: [
      "*移动立方体法*每次只看一个单元：八个样本，各在内或在外。八个一致，单元就是空的；不一致，曲面就*穿过*它，由一张表决定棱上的交点怎样连成三角形。相邻单元在公共面上看到同样的样本，所以三角形对得上，网格封闭。",
      "每边单元数加倍，样本变为八倍，被穿过的单元却只有大约四倍：曲面在格点里所占的份额越来越小。单元内部的棱从未采样，于是被*切掉*；单元小一半，切掉的也只少一半，再细的格点也留不住它。",
      "Chordal 自己的网格化知道这条规则：凡是取两部分中较小或较大者的地方，就把顶点放在两者同为零的线上。误差在两个曲面之间双向测量，显示的是已证明的上界。",
    ],
    attempts: ["单元数加倍：穿过的单元多了多少，误差降到多少？", "让切片穿过钻孔：样本怎样，单元才算被穿过？"],
  },
};

type Page = PageOf<State, Answer, Texts>;

/** The positions of the samples of a slice, inside and outside. */
function samples({ layer, step, slice }: Answer): { inside: Float32Array; outside: Float32Array } {
  const n = Math.round(Math.sqrt(layer.length));
  const [inside, outside]: [number[], number[]] = [[], []];
  layer.forEach((value, row) => (value < 0 ? inside : outside).push((row % n) * step - 1, Math.floor(row / n) * step - 1, slice));
  return { inside: new Float32Array(inside), outside: new Float32Array(outside) };
}

function pictureOf({ state, answer, isStill }: Page): Picture {
  const has = (what: Shown) => state.shown.includes(what);
  const layers: Layer[] = [];
  if (has("surface")) {
    layers.push({ kind: "mesh", id: "surface", ...answer.mesh, paint: PAINT.front, back: PAINT.other, shading: "flat", sides: isStill ? "front" : "both" });
    if (!isStill) layers.push({ kind: "lines", id: "wire", positions: answer.edges, paint: "#24446b", width: 0.8 });
  }
  if (has("cells") && !isStill) layers.push({ kind: "lines", id: "cells", positions: answer.cells, paint: "#c98a12", width: 0.9 });
  if (has("slice")) {
    const { inside, outside } = samples(answer);
    const z = answer.slice;
    layers.push(
      { kind: "lines", id: "rim", positions: new Float32Array([-1, -1, z, 1, -1, z, 1, -1, z, 1, 1, z, 1, 1, z, -1, 1, z, -1, 1, z, -1, -1, z]), paint: "--soft", width: 1.6 },
      { kind: "points", id: "outside", positions: outside, paint: "--ghost", size: 3 },
      { kind: "points", id: "inside", positions: inside, paint: "--ink", size: 6 },
    );
  }
  layers.push({ kind: "points", id: "worst", positions: new Float32Array(answer.worst.flat()), paint: "--gap", size: 10, isOnTop: true });
  return { layers };
}

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill } = page;
  const height = 2 * state.slice - 1;
  const pulls: Pull[] = state.shown.includes("slice")
    ? [
        {
          name: texts.slice,
          spoken: texts.at(say.fixed(answer.slice)),
          value: state.slice,
          low: 0,
          high: 1,
          step: 1 / state.cells,
          at: [1, -1, height],
          along: [1, -1, height + 2],
          move: (change) => set(({ slice }) => ({ slice: Math.round(100 * change(slice)) / 100 })),
        },
      ]
    : [];
  return (
    <Scene
      name={texts.figure}
      help="hint"
      picture={pictureOf(page)}
      view={state.view}
      home={HOME}
      look={(view) => set({ view })}
      isStill={isStill}
      pulls={pulls}
    />
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  return {
    value: answer.error,
    shown: say.fixed(answer.error, 3),
    label: texts.label,
    meaning: texts.meaning[state.method](say.fixed(answer.error / answer.step), say.whole(answer.triangles)),
    tone: state.method === "cubes" ? "bad" : "good",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  return (
    <>
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
      <Choice
        name="method"
        legend={texts.method}
        value={state.method}
        options={(["cubes", "corners"] as const).map((value) => ({ value, label: texts.methods[value] }))}
        choose={(method) => set({ method })}
      />
      <fieldset class="choice shown">
        <legend>{texts.shown}</legend>
        <div class="options">
          {SHOWN.map((what) => (
            <label key={what}>
              <input
                type="checkbox"
                name={what}
                checked={state.shown.includes(what)}
                onChange={() => set(({ shown }) => ({ shown: SHOWN.filter((other) => shown.includes(other) !== (other === what)) }))}
              />
              <span>{texts.show[what]}</span>
            </label>
          ))}
        </div>
      </fieldset>
      <dl>
        <Row name="crossed" label={texts.crossed} value={answer.crossed}>
          {texts.of(say.whole(answer.crossed), say.whole(answer.all))}
        </Row>
        <Row name="triangles" label={texts.triangles} value={answer.triangles}>
          {say.whole(answer.triangles)}
        </Row>
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    cells: ["n", number(FEWEST, MOST)],
    method: ["s", word("cubes", "corners")],
    shown: ["c", words(SHOWN, SHOWN.length)],
    slice: ["h", number(0, 1, 100)],
    view: ["o", view],
  },
  question: ({ cells, method, slice }) => ({ cells, method, slice }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
