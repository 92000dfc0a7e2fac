// A mesh baked to a grid of distances and meshed again: each way has an error, and the bounds add up.
import { Choice, Row, Slider } from "../view/parts";
import { type Picture, type Vec3, type View, facing } from "../viewer";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { number, view, word } from "./fragment";
import { FRAME } from "./frame_texts";
import { Scene } from "./Scene";
import type { Language } from "./say";

const SHAPES = ["cylinder", "cube", "teapot"] as const;

interface State {
  shape: (typeof SHAPES)[number];
  cells: number;
  view: View;
}

interface Mesh {
  positions: Float32Array;
  indices: Uint32Array;
}

interface Answer {
  mesh: Mesh;
  back: Mesh;
  off: Float32Array;
  cell: number;
  samples: number;
  triangles: [number, number];
  there: number | null;
  home: number | null;
  bound: number | null;
  measured: number;
  worst: [Vec3, Vec3];
}

const [FEWEST, MOST] = [6, 36] as const;
const HOME: View = { azimuth: 32, elevation: 24, distance: 6.2, target: [0, 0, 0] };
const defaults: State = { shape: "cylinder", cells: 12, view: HOME };

interface Texts extends CommonTexts {
  figure: string;
  cells: string;
  across(n: number): string;
  shape: string;
  shapes: Record<State["shape"], string>;
  label: string;
  unproved: string;
  meaning(measured: string, share: string): string;
  there: string;
  home: string;
  sum: string;
  measured: string;
  /** A button that turns the view to the worst place. */
  turn: string;
  samples: string;
  cell: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: FRAME.en.turn,
    figure: "A mesh as a wire, and the mesh that came back from its grid, coloured by its error; a red dot at the worst place",
    cells: "Cells along the longest side",
    across: (n) => `${n} cells`,
    shape: "Shape",
    shapes: { cylinder: "a cylinder", cube: "a cube", teapot: "a teapot" },
    label: "Proved bound, there and back",
    unproved: "With this lattice nothing can be proved.",
    meaning: (measured, share) =>
      `No point is farther off than this. The worst, at the red dot, is off by ${measured}: ${share} of the bound.`,
    there: "Mesh to grid, at most",
    home: "Grid to mesh, at most",
    sum: "Both, added",
    measured: "Measured",
    turn: "Turn to the worst place",
    samples: "Samples",
    cell: "Edge of a cell",
    story: [
      "To *bake* a mesh, sample its signed distance at every point of a lattice; to get back, march through the cells. Each way has an error, and for each the core *proves a bound*: how far the zero set of the interpolated samples is from the mesh, and how far the new mesh is from that zero set. By the triangle inequality *the two bounds add up*.",
      "The measured error is smaller, because the worst places of the two steps seldom coincide. Further steps would add their bounds to the sum.",
      "Half the cell, about half the error, and several times the samples: eight times as many once there are many. For smooth shapes the error falls faster; sharp edges slow it down.",
    ],
    attempts: [
      "Double the cells: by how much do the bounds fall, and the samples grow?",
      "Look where it is orange to red. What do these places have in common?",
    ],
  },
  zh: {
    hint: FRAME.zh.turn,
    figure: "线框为原网格；由格点转换回来的网格按误差着色，红点处误差最大",
    cells: "最长边方向的单元数",
    across: (n) => `${n} 个单元`,
    shape: "形状",
    shapes: { cylinder: "圆柱", cube: "立方体", teapot: "茶壶" },
    label: "往返误差已证明的上界",
    unproved: "用这样的格点，什么都证明不了。",
    meaning: (measured, share) => `任何一点的误差都不超过它。最坏处在红点，误差 ${measured}，为上界的 ${share}。`,
    there: "网格到格点，至多",
    home: "格点到网格，至多",
    sum: "两者之和",
    measured: "实测",
    turn: "转到误差最大处",
    samples: "样本数",
    cell: "单元边长",
    story: [
      "*烘焙*网格，就是在格点上逐点求有向距离；要转换回来，就逐个单元走一遍。每一程都有误差，核心对每一程都*证明一个上界*：插值的零面离网格多远，新网格离零面多远。由三角不等式，*两个上界可以相加*。",
      "实测值小一些，因为两步的最坏处很少碰到一起。再多几步，就再加几项。",
      "单元边长减半，误差约减半，样本要多好几倍，本来就多时是八倍。光滑形状的误差下降得更快，是锐边拖慢了它。",
    ],
    attempts: [
      "把单元数加倍：上界下降多少，样本增加多少？",
      "看看哪里呈橙色到红色，这些地方有什么共同点？",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;

/** `measured` minus the error of each vertex, because the ramp runs from dark to light and no error should be light. */
let inverted: { of: Float32Array; values: Float32Array } | undefined;

function pictureOf({ answer, isStill }: Page): Picture {
  const { mesh, back, off, measured, worst } = answer;
  if (inverted?.of !== off) inverted = { of: off, values: off.map((x) => measured - x) };
  return {
    layers: [
      {
        kind: "mesh",
        id: "back",
        ...back,
        values: { of: inverted.values, range: [0, measured], ramp: "heat" },
        paint: "#7ea6d8",
        shading: "flat",
        sides: isStill ? "front" : "both",
      },
      { kind: "wire", id: "before", ...mesh, paint: "#4a7fc1", width: 1.6 },
      { kind: "lines", id: "off", positions: new Float32Array(worst.flat()), paint: "--gap", width: 3, isMark: true },
      { kind: "points", id: "worst", positions: new Float32Array(worst.flat()), paint: "--gap", size: 10, isMark: true },
    ],
  };
}

function Figure({ page }: { page: Page }) {
  const { state, texts, set, isStill } = page;
  return (
    <Scene
      name={texts.figure}
      help="hint"
      picture={pictureOf(page)}
      view={state.view}
      home={HOME}
      look={(view) => set({ view })}
      isStill={isStill}
    />
  );
}

function liveNumber({ answer, say, texts }: Page): LiveNumber {
  const { bound, measured } = answer;
  return {
    value: bound,
    shown: bound === null ? "—" : say.fixed(bound, 3),
    label: texts.label,
    meaning: bound === null ? texts.unproved : texts.meaning(say.fixed(measured, 3), say.percent(measured / bound)),
    tone: bound !== null && measured <= bound ? "good" : "bad",
  };
}

const WIDE = 300;

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const { there, home, bound, measured } = answer;
  const most = Math.max(bound ?? 0, measured);
  const wide = (value: number) => (WIDE * value) / most;
  const rows = [
    ["there", texts.there, there],
    ["home", texts.home, home],
    ["sum", texts.sum, bound],
    ["measured", texts.measured, measured],
    ["cell", texts.cell, answer.cell],
  ] as const;
  return (
    <>
      <Slider
        id="cells"
        label={texts.cells}
        shown={String(state.cells)}
        spoken={texts.across(state.cells)}
        low={FEWEST}
        high={MOST}
        value={state.cells}
        choose={(cells) => set({ cells })}
      />
      <Choice
        name="shape"
        legend={texts.shape}
        value={state.shape}
        options={SHAPES.map((value) => ({ value, label: texts.shapes[value] }))}
        choose={(shape) => set({ shape })}
      />
      <button type="button" onClick={() => set(({ view }) => ({ view: facing(answer.worst[0], view, HOME.target) }))}>
        {texts.turn}
      </button>
      <svg
        class="bytes"
        viewBox={`0 0 ${WIDE} 62`}
        role="img"
        aria-label={texts.sum + say.marks.colon + say.fixed(bound ?? 0, 3) + say.marks.stop + texts.measured + say.marks.colon + say.fixed(measured, 3)}
      >
        <rect class="positions" x="0" y="4" height="20" width={wide(there ?? 0)} />
        <rect class="indices" x={wide(there ?? 0)} y="4" height="20" width={wide((bound ?? 0) - (there ?? 0))} />
        <rect class="lost" x="0" y="34" height="20" width={wide(measured)} />
      </svg>
      <dl>
        {rows.map(([name, label, value]) => (
          <Row key={name} class={`of-${name}`} name={name} label={label} value={value}>
            {value === null ? "—" : say.fixed(value, 3)}
          </Row>
        ))}
        <Row name="samples" label={texts.samples} value={answer.samples}>
          {say.whole(answer.samples)}
        </Row>
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: { shape: ["s", word(...SHAPES)], cells: ["n", number(FEWEST, MOST)], view: ["o", view] },
  question: ({ shape, cells }) => ({ shape, cells }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
