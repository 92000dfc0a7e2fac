// Levels of detail: as the camera moves away, teapot and mountain are each shown by the fewest triangles within a pixel.
import { Choice, Figure as Data, Row, Slider } from "../view/parts";
import type { Picture, Vec3, View } from "../viewer";
import { Chart } from "./Chart";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { number, view, word } from "./fragment";
import { FRAME } from "./frame_texts";
import { px } from "./Grip";
import { PAINT } from "./paint";
import { type Pair, SIDES, SamePicture, type Side } from "./SamePicture";
import { Scene } from "./Scene";
import type { Language, Say } from "./say";

interface State {
  stop: number;
  /** The triangles, or a model as large as it is on the screen. */
  look: "none" | "teapot" | "mountain";
  side: Side;
  view: View;
}

interface Model {
  mesh: { positions: Float32Array; indices: Uint32Array };
  distance: number;
  level: number;
  levels: [from: number, triangles: number, error: number][];
  triangles: number;
  most: number;
  error: number;
  pixels: number;
}

interface Answer {
  teapot: Model;
  mountain: Model;
  off_axis: number;
  pair: Pair | null;
}

/** Distances in metres, four per decade: from 0.6 m to 19 km. */
export const STOPS = Array.from({ length: 19 }, (_, i) => Number((0.6 * 10 ** (i / 4)).toPrecision(2)));
const HOME: View = { azimuth: -86, elevation: 22, distance: 6.3, target: [0, 0, -0.25] };
const defaults: State = { stop: 2, look: "none", side: "coarse", view: HOME };

interface Texts extends CommonTexts {
  figure: string;
  look: string;
  looks: Record<State["look"], string>;
  level(triangles: string): string;
  trueSize: string;
  handle: string;
  label: string;
  meaning(teapot: string, mountain: string): string;
  both(teapot: string, mountain: string): string;
  teapot: string;
  mountain: string;
  at(distance: string): string;
  allowed: string;
  factor: string;
  chart: string;
  chartX: string;
  chartY: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: FRAME.en.turn,
    figure: "A teapot and a mountain, drawn at the same size, with the triangles that are shown from this distance",
    look: "Look at",
    looks: { none: "the triangles", teapot: "the teapot, true size", mountain: "the mountain, true size" },
    level: (triangles) => `${triangles} triangles`,
    trueSize:
      "As large as on that screen: a pixel of it is a pixel here. No point is off by more than one. The bound says nothing of tones: if they count, the angle of the normals needs a budget of its own.",
    handle: "Camera to teapot",
    label: "Triangles, teapot and mountain",
    meaning: (teapot, mountain) =>
      `Neither is off by more than a pixel: that is ${teapot} on the teapot, and ${mountain} on the mountain.`,
    both: (teapot, mountain) => `${teapot} and ${mountain}`,
    teapot: "Teapot",
    mountain: "Mountain",
    at: (distance) => `at ${distance}`,
    allowed: "off by at most",
    factor: "Pixels of a length in the corner, relative to the middle",
    chart: "Triangles needed, by the distance of the camera from the teapot",
    chartX: "camera to teapot",
    chartY: "triangles",
    story: [
      "An error counts *in pixels*. So each shape is kept in several *levels of detail*, each proved to be within some length of the true shape; each next one may be off by twice as much, for about half the triangles. Length divided by distance gives pixels, and the coarsest level within one pixel is shown.",
      "Ten times the distance allows ten times the length: about a tenth of the triangles where there are many; where levels are few, more or less than that. This continues until only the coarsest level is left. The mountain, whose distance hardly changes, keeps its triangles until the camera is kilometres away.",
      "Care is needed *off the axis*: in the corner of a picture a length covers more pixels than in the middle at the same distance. The switching distances here hold for every direction, corners included. The screen has 1920 by 1080 pixels and a field of view of 45 degrees.",
    ],
    attempts: [
      "Look at the teapot in its true size and flip between the two: where do the outlines differ, and where the tones?",
      "From which distance on does the mountain need more than the teapot?",
    ],
  },
  zh: {
    hint: FRAME.zh.turn,
    figure: "茶壶和山画成一样大，显示的是从这个距离看时所用的三角形",
    look: "观察",
    looks: { none: "三角形", teapot: "茶壶，实际大小", mountain: "山，实际大小" },
    level: (triangles) => `${triangles} 个三角形`,
    trueSize: "与在那块屏幕上一样大：它的一个像素就是这里的一个像素。任何一点的误差都不超过一个像素。上界不管明暗：若明暗也要紧，就要给法线的角度另定预算。",
    handle: "相机到茶壶",
    label: "三角形数：茶壶与山",
    meaning: (teapot, mountain) => `两者的误差都不超过一个像素：在茶壶上是 ${teapot}，在山上是 ${mountain}。`,
    both: (teapot, mountain) => `${teapot} 与 ${mountain}`,
    teapot: "茶壶",
    mountain: "山",
    at: (distance) => `距离 ${distance}`,
    allowed: "误差至多",
    factor: "同一长度在画面角上与中心的像素之比",
    chart: "所需三角形数随相机到茶壶距离的变化",
    chartX: "相机到茶壶",
    chartY: "三角形数",
    story: [
      "误差要按*像素*算。所以每个形状都存成几个*细节层次*（LOD），每一层都证明了与真实形状相差不超过某个长度；下一层允许的误差加倍，三角形约减半。长度除以距离得到像素，显示误差在一个像素以内最粗的一层。",
      "距离变为十倍，允许的长度也是十倍：三角形多时约剩十分之一，层次少时或多或少，直到只剩最粗的一层。而山的距离几乎不变，直到相机退到几公里外才减少。",
      "*偏离光轴*时须注意：同样的距离，同一长度在画面角上占的像素比中心多。这里的切换距离对任何方向都成立，包括四角。屏幕为 1920 × 1080 像素，视角 45 度。",
    ],
    attempts: [
      "看茶壶的实际大小，在两幅之间切换：轮廓差在哪里，明暗又差在哪里？",
      "从多远起，山需要的三角形比茶壶多？",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;

/** A length with a suitable metric unit. */
export function metres(say: Say, length: number): string {
  const [factor, unit] =
    length < 0.01 ? [1000, "mm"] : length < 1 ? [100, "cm"] : length < 1000 ? [1, "m"] : [0.001, "km"];
  // In a Chinese text the unit could stand alone in the next line.
  return `${say.number(factor * length)}${say.language === "zh" ? "\u00a0" : " "}${unit}`;
}

/** The position of each model in the figure, and the size of a metre of it. */
const STANDS = {
  teapot: { scale: 8.4, at: [-1.38, 0, -0.45] },
  mountain: { scale: 0.00052, at: [1.24, 0, -0.4] },
} as const satisfies Record<string, { scale: number; at: Vec3 }>;
type Name = keyof typeof STANDS;
const placedCache = new Map<Name, { positions: Float32Array; placed: Float32Array }>();

function placedPositions(name: Name, positions: Float32Array): Float32Array {
  const cached = placedCache.get(name);
  if (cached?.positions === positions) return cached.placed;
  const { scale, at } = STANDS[name];
  const placed = positions.map((x, i) => x * scale + at[i % 3]!);
  placedCache.set(name, { positions, placed });
  return placed;
}

function pictureOf({ answer, isStill }: Page): Picture {
  const layers = (["teapot", "mountain"] as const).flatMap((name) => {
    const { mesh, triangles } = answer[name];
    const positions = placedPositions(name, mesh.positions);
    return [
      {
        kind: "mesh",
        id: name,
        positions,
        indices: mesh.indices,
        paint: name === "teapot" ? PAINT.front : "#9db38a",
        shading: "flat",
        // In a still figure every triangle is a shape, so only front faces and no edges keep it small.
        sides: isStill ? "front" : "both",
      },
      ...(isStill
        ? []
        : ([
            {
              kind: "wire",
              id: `${name}-wire`,
              positions,
              indices: mesh.indices,
              paint: name === "teapot" ? "#24446b" : "#3c5230",
              width: triangles > 3000 ? 0.5 : 1,
            },
          ] as const)),
    ] as const;
  });
  return { layers };
}

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill } = page;
  const { pair } = answer;
  if (pair && state.look !== "none") {
    const { triangles, most } = answer[state.look];
    return (
      <div class="true-size" data-figure>
        <SamePicture
          pair={pair}
          side={state.side}
          names={[texts.level(say.whole(triangles)), texts.level(say.whole(most))]}
          scale={1}
          say={say}
          isStill={isStill}
          choose={(side) => set({ side })}
        />
        <p class="aside">{texts.trueSize}</p>
      </div>
    );
  }
  return (
    <Scene
      name={texts.figure}
      help="hint"
      picture={pictureOf(page)}
      view={state.view}
      home={HOME}
      look={(view) => set({ view })}
      isStill={isStill}
      over={(at) =>
        (["teapot", "mountain"] as const).map((name) => {
          const [x, y] = at.to([STANDS[name].at[0], -1.25, -0.75]);
          return (
            <text key={name} class="label" x={px(x)} y={px(y)}>
              {texts[name]}
              <tspan class="how-far">{say.marks.comma}{texts.at(metres(say, answer[name].distance))}</tspan>
            </text>
          );
        })
      }
    />
  );
}

function liveNumber({ answer, say, texts }: Page): LiveNumber {
  const { teapot, mountain } = answer;
  return {
    value: teapot.triangles + mountain.triangles,
    shown: texts.both(say.whole(teapot.triangles), say.whole(mountain.triangles)),
    label: texts.label,
    meaning: texts.meaning(
      metres(say, teapot.error / teapot.pixels),
      metres(say, mountain.error / mountain.pixels),
    ),
    tone: teapot.pixels <= 1 && mountain.pixels <= 1 ? "good" : "bad",
  };
}

/** Triangles against the distance of the camera from the teapot, which is `behind` metres nearer than the other model. */
function stairs(levels: Model["levels"], behind: number, low: number, high: number): [number, number][] {
  const points: [number, number][] = [];
  levels.forEach(([from, triangles], i) => {
    const to = levels[i + 1]?.[0] ?? Infinity;
    const [a, b] = [Math.max(from - behind, low), Math.min(to - behind, high)];
    if (a < b) points.push([a, triangles], [b, triangles]);
  });
  return points;
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const distance = STOPS[state.stop]!;
  const [low, high] = [STOPS[0]!, STOPS.at(-1)!];
  const behind = answer.mountain.distance - answer.teapot.distance;
  const line = (at: (x: number, y: number) => readonly [number, number], points: [number, number][]) =>
    `M${points.map(([x, y]) => at(x, y).map(px).join(" ")).join("L")}`;
  return (
    <>
      <Slider
        id="distance"
        label={texts.handle}
        shown={metres(say, distance)}
        low={0}
        high={STOPS.length - 1}
        value={state.stop}
        choose={(stop) => set({ stop })}
      />
      <Choice
        name="look"
        legend={texts.look}
        value={state.look}
        options={(["none", "teapot", "mountain"] as const).map((value) => ({ value, label: texts.looks[value] }))}
        choose={(look) => set({ look })}
      />
      <Chart
        name={texts.chart}
        x={{
          low,
          high,
          isLog: true,
          label: texts.chartX,
          ticks: [
            [1, "1 m"],
            [10, "10 m"],
            [100, "100 m"],
            [1000, "1 km"],
            [10000, "10 km"],
          ],
        }}
        y={{
          low: 10,
          high: 10000,
          isLog: true,
          label: texts.chartY,
          ticks: [10, 100, 1000, 10000].map((y) => [y, say.whole(y)] as const),
        }}
      >
        {(at) => (
          <>
            <path class="drawn" d={line(at, stairs(answer.teapot.levels, 0, low, high))} />
            <path class="drawn hill" d={line(at, stairs(answer.mountain.levels, behind, low, high))} />
            {(["teapot", "mountain"] as const).map((name) => {
              const [cx, cy] = at(distance, answer[name].triangles).map(px);
              return <circle key={name} class={`here ${name === "mountain" ? "hill" : ""}`} r="6" cx={cx} cy={cy} />;
            })}
          </>
        )}
      </Chart>
      <dl>
        {(["teapot", "mountain"] as const).map((name) => (
          <div key={name} class={`of-${name}`}>
            <dt>
              {texts[name]}
              {say.marks.comma}
              {texts.allowed}
            </dt>
            <dd>
              <Data name={`${name}-error`} value={answer[name].error}>
                {metres(say, answer[name].error)}
              </Data>
              {" = "}
              <Data name={`${name}-pixels`} value={answer[name].pixels}>
                {say.fixed(answer[name].pixels)} px
              </Data>
            </dd>
          </div>
        ))}
        <Row name="off-axis" label={texts.factor} value={answer.off_axis}>
          {say.fixed(answer.off_axis)}×
        </Row>
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    stop: ["n", number(0, STOPS.length - 1)],
    look: ["k", word("none", "teapot", "mountain")],
    side: ["s", word(...SIDES)],
    view: ["o", view],
  },
  question: ({ stop, look }) => ({ distance: STOPS[stop], ...(look === "none" ? {} : { compare: look }) }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
