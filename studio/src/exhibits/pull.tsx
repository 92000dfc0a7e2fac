// A cage that is pulled: the limit surface follows its corners, edges become creases, and what a corner influences is painted.
import { Row } from "../view/parts";
import { type Picture, type Projector, type Vec3, type View, rampStops } from "../viewer";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { number, numbers, points, view } from "./fragment";
import { FRAME } from "./frame_texts";
import { px } from "./Grip";
import { Knob } from "./Knob";
import { PAINT } from "./paint";
import { Scene } from "./Scene";
import type { Language } from "./say";

interface State {
  corners: readonly Vec3[];
  creases: readonly number[];
  chosen: number;
  view: View;
}

interface Answer {
  limit: { positions: Float32Array; indices: Uint32Array };
  normals: Float32Array;
  weights: Float32Array;
  edges: [number, number][];
  largest: number;
  touched: number;
  points: number;
}

const HOME: View = { azimuth: -58, elevation: 24, distance: 8.9, target: [0.15, -0.15, -0.05] };
const WITHIN = 3;
const defaults: State = {
  // The upper right corner in front is pulled out.
  corners: Array.from({ length: 8 }, (_, i): Vec3 => {
    const [x, y, z] = [i & 1, (i >> 1) & 1, (i >> 2) & 1].map((bit) => bit * 2.4 - 1.2) as [number, number, number];
    return i === 5 ? [1.7, -1.7, 1.8] : [x, y, z];
  }),
  creases: [],
  chosen: 5,
  view: HOME,
};

interface Texts extends CommonTexts {
  figure: string;
  corner(name: string): string;
  edge(name: string): string;
  at(x: string, y: string, z: string): string;
  label(name: string): string;
  follows(name: string, percent: string): string;
  exactly(name: string): string;
  scale(name: string): string;
  touched: string;
  creases: string;
  points: string;
  bottom: string;
  smooth: string;
  reset: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: `Drag a corner of the cage. Press the small square on an edge to crease it. ${FRAME.en.turn}{keys} Tab, then arrows, Page Up and Page Down for corners, the space bar for edges.`,
    figure: "A cube of control points and the smooth surface in it",
    corner: (name) => `Corner ${name}`,
    edge: (name) => `Crease at edge ${name}`,
    at: (x, y, z) => `x ${x}, y ${y}, z ${z}`,
    label: (name) => `Largest weight of ${name} on the surface`,
    follows: (name, percent) => `Pull ${name} by one unit, and the surface follows by at most ${percent} of it.`,
    exactly: (name) => `All edges at ${name} are creased: the surface goes through it.`,
    scale: (name) => `From 0 to the largest weight of ${name}`,
    touched: "Points of the surface that it moves",
    creases: "Creased edges",
    points: "Points compared",
    bottom: "Crease the bottom",
    smooth: "No creases",
    reset: "As at first",
    story: [
      "Sculptors do not move the surface, but a *cage* around it. Catmull–Clark subdivision turns it into a *limit surface*, and each point of that is a blend of the cage’s corners with weights that sum to one: what is painted here is the *weight* of one corner, and so exactly what moves when you pull it.",
      "On a cube a corner has three edges, and the surface below it follows by three eighths. *Crease* its edges and it follows more: two thirds if two are creased, so that it lies on a crease curve, and all the way if all three are.",
      "A crease is no new geometry, only a tag on an edge. The rules of subdivision take the average along the edge there and ignore what is beside it, so the surface keeps its two sides and has a sharp edge between them.",
    ],
    attempts: [
      "Crease the three edges at the chosen corner one after the other, and watch the number.",
      "Crease the four edges of the bottom, and pull its corners apart.",
    ],
  },
  zh: {
    hint: `拖动控制网格的顶点；点边上的小方块，设置或取消折痕。${FRAME.zh.turn}{keys}按 Tab 选中，顶点用方向键和 Page Up、Page Down 移动，边用空格键切换。`,
    figure: "立方体控制网格，以及它里面的光滑曲面",
    corner: (name) => `顶点 ${name}`,
    edge: (name) => `边 ${name} 的折痕`,
    at: (x, y, z) => `x ${x}，y ${y}，z ${z}`,
    label: (name) => `${name} 在曲面上的最大权重`,
    follows: (name, percent) => `把 ${name} 拉开一个单位，曲面最多跟着走 ${percent}。`,
    exactly: (name) => `${name} 处的边全是折痕：曲面经过这个顶点。`,
    scale: (name) => `从 0 到 ${name} 的最大权重`,
    touched: "受它影响的曲面点",
    creases: "折痕边",
    points: "比较的点数",
    bottom: "底面设为折痕",
    smooth: "取消折痕",
    reset: "恢复原样",
    story: [
      "雕塑师动的不是曲面，而是包在外面的*控制网格*。Catmull–Clark 细分把它变成*极限曲面*，曲面上每一点都是网格顶点的加权平均，权重总和为一。图中着色的就是某个顶点的*权重*：拉动它时，动的正是这些地方。",
      "立方体的顶点连着三条边，它下面的曲面跟着走八分之三。把边设成*折痕*，就跟得更紧：两条边时，曲面点落在折痕曲线上，跟三分之二；三条边全设，就完全跟上。",
      "折痕没有新增几何，只是边上的一个标记。细分到这里只沿着边求平均，不理会两旁，于是曲面两侧各自光滑，中间留下一条棱。",
    ],
    attempts: [
      "把选中顶点的三条边依次设成折痕，看数字怎样变。",
      "把底面四条边设成折痕，再把底面的顶点拉开。",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
const floats = (...points: readonly Vec3[]) => new Float32Array(points.flat());
const nameOf = (i: number) => "ABCDEFGH"[i]!;
/** The edges between the four corners with the smallest z. */
const BOTTOM = (edges: Answer["edges"]) => edges.flatMap(([a, b], i) => (a < 4 && b < 4 ? [i] : []));

function pictureOf({ state, answer, isStill }: Page): Picture {
  const { corners, creases } = state;
  const ends = (isCreased: boolean) =>
    answer.edges.flatMap(([a, b], i) => (creases.includes(i) === isCreased ? [corners[a]!, corners[b]!] : []));
  return {
    layers: [
      {
        kind: "mesh",
        id: "limit",
        ...answer.limit,
        normals: answer.normals,
        values: { of: answer.weights, range: [0, answer.largest || 1], ramp: "share" },
        paint: PAINT.front,
        shading: isStill ? "flat" : "smooth",
        sides: "both",
      },
      { kind: "lines", id: "cage", positions: floats(...ends(false)), paint: "--ghost", width: 1.3, isOnTop: true },
      { kind: "lines", id: "creases", positions: floats(...ends(true)), paint: "--gap", width: 3, isOnTop: true },
    ],
  };
}

const toggled = (creases: readonly number[], edge: number) =>
  creases.includes(edge) ? creases.filter((other) => other !== edge) : [...creases, edge].sort((a, b) => a - b);

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill } = page;
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
          {answer.edges.map((edge, i) => (
            <Crease key={i} page={page} at={at} edge={edge} i={i} />
          ))}
          {state.corners.map((place, i) => (
            <Knob
              key={i}
              name={texts.corner(nameOf(i))}
              spoken={texts.at(say.fixed(place[0]), say.fixed(place[1]), say.fixed(place[2]))}
              place={place}
              at={at}
              isStill={isStill}
              within={WITHIN}
              isClose
              isFaint={i !== state.chosen}
              ground={-1.2}
              chosen={() => set({ chosen: i })}
              move={(change) => set(({ corners }) => ({ corners: corners.map((old, k) => (k === i ? change(old) : old)) }))}
            />
          ))}
          {state.corners.map((place, i) => {
            const [x, y] = at.to(place);
            return (
              <text key={i} class="label" x={x} y={y - 15}>
                {nameOf(i)}
              </text>
            );
          })}
        </>
      )}
    />
  );
}

/** A switch in the middle of an edge. */
function Crease({ page: { state, texts, set, isStill }, at, edge: [a, b], i }: { page: Page; at: Projector; edge: [number, number]; i: number }) {
  const [p, q] = [state.corners[a]!, state.corners[b]!];
  const [x, y] = at.to([(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2]);
  const isCreased = state.creases.includes(i);
  const toggle = () => set(({ creases }) => ({ creases: toggled(creases, i) }));
  const picture = <rect class="handle" x={-5} y={-5} width={10} height={10} />;
  const transform = `translate(${px(x)} ${px(y)})`;
  if (isStill) {
    return (
      <g class={isCreased ? "crease on" : "crease"} transform={transform}>
        {picture}
      </g>
    );
  }
  return (
    <g
      class={isCreased ? "crease on target" : "crease target"}
      role="switch"
      tabindex={0}
      aria-checked={isCreased}
      aria-label={texts.edge(`${nameOf(a)}–${nameOf(b)}`)}
      transform={transform}
      // The figure behind it would turn.
      onPointerDown={(event) => event.stopPropagation()}
      onClick={toggle}
      onKeyDown={(event) => {
        if (event.key !== " " && event.key !== "Enter") return;
        event.preventDefault();
        event.stopPropagation();
        toggle();
      }}
    >
      <circle class="reach" r={14} />
      {picture}
    </g>
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  const name = nameOf(state.chosen);
  const around = answer.edges.flatMap(([a, b], i) => (a === state.chosen || b === state.chosen ? [i] : []));
  return {
    value: answer.largest,
    shown: say.fixed(answer.largest, 3),
    label: texts.label(name),
    meaning: around.every((edge) => state.creases.includes(edge)) ? texts.exactly(name) : texts.follows(name, say.percent(answer.largest)),
    tone: "plain",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  return (
    <>
      <div>
        <svg class="ramp-scale" viewBox="0 0 80 6" preserveAspectRatio="none" aria-hidden="true">
          {rampStops("share").map((color, i) => (
            <rect key={i} x={10 * i} width={10.2} height={6} fill={color} />
          ))}
        </svg>
        <p class="aside">{texts.scale(nameOf(state.chosen))}</p>
      </div>
      <div class="buttons">
        <button type="button" onClick={() => set({ creases: BOTTOM(answer.edges) })}>
          {texts.bottom}
        </button>
        <button type="button" onClick={() => set({ creases: [] })}>
          {texts.smooth}
        </button>
        <button type="button" onClick={() => set({ creases: [], corners: defaults.corners })}>
          {texts.reset}
        </button>
      </div>
      <dl>
        <div>
          <dt>{texts.creases}</dt>
          <dd>
            {say.whole(state.creases.length)} / {say.whole(answer.edges.length)}
          </dd>
        </div>
        <Row name="touched" label={texts.touched} value={answer.touched}>
          {say.percent(answer.touched)}
        </Row>
        <Row name="points" label={texts.points} value={answer.points}>
          {say.whole(answer.points)}
        </Row>
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    corners: ["p", points<Vec3>(8, 8, [[-WITHIN, WITHIN], [-WITHIN, WITHIN], [-WITHIN, WITHIN]])],
    creases: ["c", numbers(0, 12, number(0, 11))],
    chosen: ["n", number(0, 7)],
    view: ["o", view],
  },
  question: ({ corners, creases, chosen }) => ({ corners, creases, chosen }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
