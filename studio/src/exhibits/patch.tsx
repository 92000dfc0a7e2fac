// A bicubic patch: sixteen points to move, their weights painted on the surface, and a curve that slides across.
import { Choice, Row, Slider } from "../view/parts";
import { type Layer, type Picture, type Vec3, type View, eyeOf, rampStops } from "../viewer";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { number, points, view, word } from "./fragment";
import { FRAME } from "./frame_texts";
import { Knob } from "./Knob";
import { PAINT } from "./paint";
import { Scene } from "./Scene";
import type { Language } from "./say";
import { SPOUT, SPOUT_VIEW } from "./spout";

interface State {
  control: readonly Vec3[];
  chosen: number;
  u: number;
  v: number;
  show: "weights" | "triangles";
  pixels: number;
  view: View;
}

interface Surface {
  positions: Float32Array;
  indices: Uint32Array;
}

interface Answer {
  surface: Surface;
  normals: Float32Array;
  painted: Float32Array;
  point: Vec3;
  normal: Vec3 | null;
  weights: number[];
  sum: number;
  chosen: number;
  rails: Float32Array[];
  sliding: Vec3[];
  slid: Float32Array;
  triangles: { mesh: Surface; count: number; bound: number; evidence: string } | null;
}

const HOME: View = { azimuth: -58, elevation: 30, distance: 9.6, target: [0, 0, 0.3] };
const WITHIN = 3;
const SIDE = [-1.8, -0.6, 0.6, 1.8];
const HEIGHTS = [
  [0, 0.5, 0.2, -0.4],
  [0.4, 1.7, 1.5, 0.3],
  [0.2, 1.3, 1.9, 0.6],
  [-0.5, 0.3, 0.6, 0.1],
];
const SHAPES = {
  hill: { control: HEIGHTS.flatMap((row, i) => row.map((z, j): Vec3 => [SIDE[j]!, SIDE[i]!, z])), view: HOME },
  spout: { control: SPOUT, view: SPOUT_VIEW },
} as const satisfies Record<string, Pick<State, "control" | "view">>;
type Shape = keyof typeof SHAPES;
const defaults: State = {
  ...SHAPES.hill,
  chosen: 10,
  u: 0.6,
  v: 0.5,
  show: "weights",
  pixels: 2,
};
const PIXELS = [0.25, 0.5, 1, 2, 4, 8, 16] as const;

interface Texts extends CommonTexts {
  figure: string;
  control(name: string): string;
  at(x: string, y: string, z: string): string;
  show: string;
  weights: string;
  triangles: string;
  u: string;
  v: string;
  budget: string;
  pixels(n: string): string;
  label(name: string): string;
  share(name: string, percent: string): string;
  labelTriangles: string;
  proved(pixels: string, bound: string): string;
  tooClose: string;
  scale(name: string): string;
  sum: string;
  all: string;
  weightOf(name: string): string;
  begin: string;
  shapes: Record<Shape, string>;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: `Drag any of the sixteen points, and the surface follows. ${FRAME.en.turn}{keys} Tab to a point, arrows move it in the picture, Page Up and Page Down away from you and back.`,
    figure: "A curved patch with a net of sixteen control points",
    control: (name) => `Control point ${name}`,
    at: (x, y, z) => `x ${x}, y ${y}, z ${z}`,
    show: "Paint",
    weights: "the weight of the chosen point",
    triangles: "triangles within a budget",
    u: "u, along the sliding curve",
    v: "v, across: it slides",
    budget: "Pixel budget",
    pixels: (n) => `${n} px`,
    label: (name) => `Weight of ${name} at the dot`,
    share: (name, percent) => `${percent} of the dot’s position comes from ${name}. The sixteen weights sum to one, and none is negative.`,
    labelTriangles: "Triangles",
    proved: (pixels, bound) => `No point of the patch is farther than ${bound} units from these triangles: proved, and less than ${pixels} from where you look. Zoom, and it is meshed again.`,
    tooClose: "The eye is so close that no number of triangles can be promised.",
    scale: (name) => `From 0 to the largest weight of ${name}`,
    sum: "Sum of the weights",
    all: "All weights",
    weightOf: (name) => `Weight of ${name}`,
    begin: "Begin with",
    shapes: { hill: "a hill", spout: "half of a teapot’s spout" },
    story: [
      "A *tensor-product* patch is a curve of curves. Each column of four control points is a cubic Bézier; at v, their four points are the control points of another one, the thick curve, and the surface is what it sweeps as v runs from 0 to 1. Each point weighs in with a product of two *Bernstein* polynomials, Bᵢ(v) · Bⱼ(u).",
      "No weight is negative and they sum to one, so the patch stays in the *convex hull* of its points. It touches only the four corners; the other twelve pull at it. Every point influences the whole patch a little: local control comes from using many patches.",
      "A renderer draws triangles. How many is a matter of the *budget*: an error in pixels becomes a length at this distance, the second derivatives bound the error of each part, and flat parts take few triangles.",
    ],
    attempts: [
      "Press each of the points and see which part of the surface it owns.",
      "Choose triangles and halve the budget. By what factor does their number grow?",
    ],
  },
  zh: {
    hint: `十六个点都可以拖，曲面随之变形。${FRAME.zh.turn}{keys}按 Tab 选点，方向键在画面内移动，Page Up 和 Page Down 推远、拉近。`,
    figure: "一片曲面和由十六个控制点组成的控制网",
    control: (name) => `控制点 ${name}`,
    at: (x, y, z) => `x ${x}，y ${y}，z ${z}`,
    show: "着色",
    weights: "选中点的权重",
    triangles: "预算之内的三角形",
    u: "u：沿着滑动的曲线",
    v: "v：曲线滑到哪里",
    budget: "像素预算",
    pixels: (n) => `${n} 像素`,
    label: (name) => `${name} 在圆点处的权重`,
    share: (name, percent) => `圆点的位置有 ${percent} 来自 ${name}。十六个权重都不为负，总和为一。`,
    labelTriangles: "三角形",
    proved: (pixels, bound) => `已证明：曲面上没有一点离这些三角形超过 ${bound} 个单位，从你的位置看不超过 ${pixels}。拉近或推远，网格会重新生成。`,
    tooClose: "视点太近，多少三角形都无法保证。",
    scale: (name) => `从 0 到 ${name} 的最大权重`,
    sum: "权重总和",
    all: "全部权重",
    weightOf: (name) => `${name} 的权重`,
    begin: "从哪个形状开始",
    shapes: { hill: "小丘", spout: "半个壶嘴" },
    story: [
      "*张量积*曲面是“曲线的曲线”。每列四个控制点是一条三次贝塞尔曲线；取参数 v，四列各得一点，这四点又是另一条曲线（图中粗线）的控制点。v 从 0 走到 1，粗线扫过的就是曲面。每个控制点的权重是两个*伯恩斯坦*多项式之积：Bᵢ(v) · Bⱼ(u)。",
      "权重都不为负，总和为一，所以曲面留在控制点的*凸包*内。它只经过四个角点，其余十二个点只是牵引。每个点对整片曲面都有一点影响；要局部控制，就得用许多片。",
      "渲染器画的是三角形，画多少由*预算*决定：像素误差按距离换算成长度，二阶导数给出每一小片的误差上界，平的地方只要很少几个三角形。",
    ],
    attempts: [
      "逐个点按控制点，看每个点管着曲面的哪一块。",
      "改看三角形，把预算减半：三角形变成几倍？",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
const floats = (...points: readonly Vec3[]) => new Float32Array(points.flat());
const nameOf = (row: number) => `P${"₀₁₂₃"[row >> 2]}${"₀₁₂₃"[row % 4]}`;

/** Points of a line, each but the ends twice. */
const strip = (line: Float32Array) => {
  const ends = new Float32Array(Math.max(line.length / 3 - 1, 0) * 6);
  for (let i = 0; 6 * i < ends.length; i++) ends.set(line.subarray(3 * i, 3 * i + 6), 6 * i);
  return ends;
};

function joined(parts: readonly Float32Array[]): Float32Array {
  const whole = new Float32Array(parts.reduce((sum, part) => sum + part.length, 0));
  parts.reduce((start, part) => (whole.set(part, start), start + part.length), 0);
  return whole;
}

function pictureOf({ state, answer, isStill }: Page): Picture {
  const net = [0, 1, 2, 3].flatMap((i) =>
    [0, 1, 2].flatMap((j) => [state.control[4 * i + j]!, state.control[4 * i + j + 1]!, state.control[4 * j + i]!, state.control[4 * (j + 1) + i]!]),
  );
  const { triangles } = answer;
  const isMeshed = state.show === "triangles" && triangles !== null;
  const surface: Layer[] = isMeshed
    ? [
        { kind: "mesh", id: "triangles", ...triangles.mesh, paint: PAINT.front, shading: "flat", sides: "both" },
        { kind: "wire", id: "wire", ...triangles.mesh, paint: "#24446b", width: 0.9 },
      ]
    : [
        {
          kind: "mesh",
          id: "surface",
          ...answer.surface,
          normals: answer.normals,
          values: { of: answer.painted, range: [0, Math.max(0.05, ...answer.painted)], ramp: "share" },
          paint: PAINT.front,
          shading: isStill ? "flat" : "smooth",
          sides: "both",
        },
      ];
  return {
    layers: [
      ...surface,
      { kind: "lines", id: "net", positions: floats(...net), paint: "--ghost", width: 1.2, isOnTop: true },
      ...(isMeshed
        ? []
        : ([
            // One layer, since each is built anew at every move.
            { kind: "lines", id: "rails", positions: joined([...answer.rails, floats(...answer.sliding)].map(strip)), paint: "--soft", width: 1.4, isOnTop: true },
            { kind: "points", id: "sliding", positions: floats(...answer.sliding), paint: "--soft", size: 7, isOnTop: true },
            { kind: "lines", id: "slid", positions: strip(answer.slid), paint: "--ink", width: 3.4, isOnTop: true },
            { kind: "points", id: "dot", positions: floats(answer.point), paint: "--gap", size: 11, isOnTop: true },
          ] as const)),
    ],
  };
}

function Figure({ page }: { page: Page }) {
  const { state, texts, say, set, isStill } = page;
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
          {state.control.map((place, i) => (
            <Knob
              key={i}
              name={texts.control(nameOf(i))}
              spoken={texts.at(say.fixed(place[0]), say.fixed(place[1]), say.fixed(place[2]))}
              place={place}
              at={at}
              isStill={isStill}
              within={WITHIN}
              isClose
              isFaint={i !== state.chosen}
              ground={-1}
              chosen={() => set({ chosen: i })}
              move={(change) => set(({ control }) => ({ control: control.map((old, k) => (k === i ? change(old) : old)) }))}
            />
          ))}
          <Name at={at.to(state.control[state.chosen]!)} name={nameOf(state.chosen)} />
        </>
      )}
    />
  );
}

function Name({ at: [x, y], name }: { at: readonly [number, number, number]; name: string }) {
  return (
    <text class="label" x={x} y={y - 15}>
      {name}
    </text>
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  if (state.show === "triangles") {
    const { triangles } = answer;
    return {
      value: triangles?.count ?? null,
      shown: triangles ? say.whole(triangles.count) : "–",
      label: texts.labelTriangles,
      meaning: triangles ? texts.proved(texts.pixels(say.number(state.pixels)), say.number(triangles.bound)) : texts.tooClose,
      tone: triangles?.evidence === "proved" ? "good" : "plain",
    };
  }
  const name = nameOf(state.chosen);
  return {
    value: answer.chosen,
    shown: say.fixed(answer.chosen, 3),
    label: texts.label(name),
    meaning: texts.share(name, say.percent(answer.chosen)),
    tone: "plain",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const share = (id: "u" | "v") => (
    <Slider
      id={id}
      label={texts[id]}
      shown={say.fixed(state[id])}
      low={0}
      high={1}
      step={0.01}
      value={state[id]}
      choose={(value) => set({ [id]: value })}
    />
  );
  return (
    <>
      <Choice
        name="show"
        class="stacked"
        legend={texts.show}
        value={state.show}
        options={[
          { value: "weights", label: texts.weights },
          { value: "triangles", label: texts.triangles },
        ]}
        choose={(show) => set({ show })}
      />
      {state.show === "weights" ? (
        <>
          {share("v")}
          {share("u")}
          <div>
            <svg class="ramp-scale" viewBox="0 0 80 6" preserveAspectRatio="none" aria-hidden="true">
              {rampStops("share").map((color, i) => (
                <rect key={i} x={10 * i} width={10.2} height={6} fill={color} />
              ))}
            </svg>
            <p class="aside">{texts.scale(nameOf(state.chosen))}</p>
          </div>
          <div class="weight-grid" role="group" aria-label={texts.all}>
            {[3, 2, 1, 0].flatMap((i) =>
              [0, 1, 2, 3].map((j) => {
                const row = 4 * i + j;
                return (
                  <button
                    key={row}
                    type="button"
                    aria-pressed={row === state.chosen}
                    aria-label={`${texts.weightOf(nameOf(row))}: ${say.fixed(answer.weights[row]!, 2)}`}
                    onClick={() => set({ chosen: row })}
                  >
                    {say.fixed(answer.weights[row]!, 2)}
                  </button>
                );
              }),
            )}
          </div>
          <dl>
            <Row name="sum" label={texts.sum} value={answer.sum}>
              {say.fixed(answer.sum, 3)}
            </Row>
          </dl>
        </>
      ) : (
        <Slider
          id="pixels"
          label={texts.budget}
          shown={texts.pixels(say.number(state.pixels))}
          low={0}
          high={PIXELS.length - 1}
          value={Math.max(PIXELS.findIndex((pixels) => pixels >= state.pixels), 0)}
          choose={(i) => set({ pixels: PIXELS[i]! })}
        />
      )}
      <div>
        <p class="aside">{texts.begin}</p>
        <div class="buttons">
          {(["hill", "spout"] as const).map((shape) => (
            <button key={shape} type="button" onClick={() => set(SHAPES[shape])}>
              {texts.shapes[shape]}
            </button>
          ))}
        </div>
      </div>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    control: ["p", points<Vec3>(16, 16, [[-WITHIN, WITHIN], [-WITHIN, WITHIN], [-WITHIN, WITHIN]])],
    chosen: ["n", number(0, 15)],
    u: ["u", number(0, 1, 100)],
    v: ["w", number(0, 1, 100)],
    show: ["b", word("weights", "triangles")],
    pixels: ["h", number(0.25, 16, 100)],
    view: ["o", view],
  },
  question: ({ control, u, v, chosen, pixels, view }) => ({ control, u, v, chosen, pixels, eye: eyeOf(view), target: view.target }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
