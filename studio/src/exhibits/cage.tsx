// Catmull–Clark subdivision: a cage, its rounds, and its limit surface; each round leaves a quarter of the distance.
import { Choice, Figure as Data, Row, Slider } from "../view/parts";
import { type Layer, type Picture, type View, rampStops } from "../viewer";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { number, view, word } from "./fragment";
import { FRAME } from "./frame_texts";
import { PAINT } from "./paint";
import { Scene } from "./Scene";
import type { Language } from "./say";

interface State {
  level: number;
  sharpness: number;
  show: "round" | "limit";
  view: View;
}

interface Shape {
  positions: Float32Array;
  indices: Uint32Array;
}

interface Answer {
  mesh: Shape;
  edges: Float32Array;
  cage: Float32Array;
  rim: Float32Array;
  limit: Shape;
  limit_normals: Float32Array;
  distances: Float32Array;
  errors: number[];
  points: number;
  faces: number;
  vertices: number;
  cage_faces: number;
}

const HOME: View = { azimuth: -62, elevation: 16, distance: 10.2, target: [0, 0, 0.1] };
const LEVELS = [0, 5] as const;
const SHARPNESS = [0, 6] as const;
const defaults: State = { level: 2, sharpness: 0, show: "round", view: HOME };

interface Texts extends CommonTexts {
  figure: string;
  handle: string;
  spoken(level: number, faces: string): string;
  crease: string;
  creaseHelp: string;
  sharp(value: string): string;
  show: string;
  round: string;
  limit: string;
  scale(most: string): string;
  label: string;
  level(n: number): string;
  faces: string;
  times(ratio: string): string;
  first: string;
  falls(ratio: string, points: string): string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: FRAME.en.turn,
    figure: "A bottle of quads inside its cage",
    handle: "Rounds of subdivision",
    spoken: (level, faces) => `${level} rounds, ${faces} faces`,
    crease: "Sharpness of the rim",
    creaseHelp: "The four edges of the foot follow the crease rule for this many rounds, and the smooth rule after that.",
    sharp: (value) => `sharpness ${value}`,
    show: "Show",
    round: "this round",
    limit: "the limit, by its distance from this round",
    scale: (most) => `from 0 to ${most} away from the triangles`,
    label: "The limit surface is off by up to",
    level: (n) => (n === 0 ? "The cage" : `Round ${n}`),
    faces: "Faces",
    times: (ratio) => `÷ ${ratio}`,
    first: "The cage itself: easy to edit, but far from the surface that it controls.",
    falls: (ratio, points) => `${ratio} times nearer than the round before, measured at ${points} points of the limit surface.`,
    story: [
      "An artist moves the few points of a *cage*; by Catmull and Clark’s rule every quad becomes four, round after round. They converge to a smooth *limit surface*, which can be evaluated *exactly* at any place, so the error of a round is known: four times the faces, *about a quarter of the error*.",
      "A curve that is cut into segments follows the same law. The cost is the same, too: after a few rounds four times the faces improve nothing that is visible.",
      "A *crease* is a number on an edge: for so many rounds it follows the rule of a curve and ignores the faces beside it. With 0 the foot is round, with 1 or 2 it has a soft rim, with 6 a sharp one. The cage stays the same 14 faces.",
    ],
    attempts: [
      "Move the rounds from 0 to 5. By what does the number fall each time?",
      "Raise the sharpness to 2. By what does the number fall now, round by round?",
    ],
  },
  zh: {
    hint: FRAME.zh.turn,
    figure: "控制网格，和它里面由四边形组成的瓶子",
    handle: "细分次数",
    spoken: (level, faces) => `${level} 次，${faces} 个面`,
    crease: "底边的锐度",
    creaseHelp: "瓶底的四条边在这么多次细分中遵循折痕规则，之后才按光滑曲面的规则。",
    sharp: (value) => `锐度 ${value}`,
    show: "显示",
    round: "这一次的网格",
    limit: "极限曲面，按到网格的距离着色",
    scale: (most) => `到三角形的距离，从 0 到 ${most}`,
    label: "极限曲面最远偏离",
    level: (n) => (n === 0 ? "控制网格" : `第 ${n} 次`),
    faces: "面数",
    times: (ratio) => `÷ ${ratio}`,
    first: "控制网格本身：便于用手操作，离它所控制的曲面还很远。",
    falls: (ratio, points) => `距离是上一次的 1/${ratio}，在极限曲面的 ${points} 个点上测得。`,
    story: [
      "美术师只移动*控制网格*的少数几个点；按 Catmull–Clark 规则，每细分一次，每个四边形变成四个。它们趋于光滑的*极限曲面*，这个曲面在任意位置都能*精确*求值，所以每一次的误差都算得出来：面数乘四，*误差约降到四分之一*。",
      "切成线段的曲线也服从同样的规律。代价也一样：几次之后，四倍的面换来的是谁也看不见的差别。",
      "*折痕*是边上的一个数：在这么多次细分中，这条边按曲线的规则处理，不理会两侧的面。取 0，瓶底是圆的；取 1 或 2，边缘柔和；取 6，边缘锐利。控制网格始终是那 14 个面。",
    ],
    attempts: [
      "把细分次数从 0 拖到 5：数字每次降到几分之一？",
      "把锐度提到 2：现在每次细分降到几分之一？",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
const CAGE = "#c62a12";

function pictureOf({ state, answer, isStill }: Page): Picture {
  const { mesh, limit } = answer;
  const control: Layer[] = [
    { kind: "lines", id: "cage", positions: answer.cage, paint: CAGE, width: 1.4 },
    ...(state.sharpness > 0 ? [{ kind: "lines", id: "rim", positions: answer.rim, paint: CAGE, width: 4 } as const] : []),
  ];
  const edges = state.level < 5 ? ([{ kind: "lines", id: "edges", positions: answer.edges, paint: "#24446b", width: 0.8 }] as const) : [];
  // The ten thousand triangles of the limit surface would make a still figure too large.
  if (state.show === "round" || isStill) {
    return {
      layers: [{ kind: "mesh", id: "round", ...mesh, paint: PAINT.front, shading: "flat", sides: "both" }, ...edges, ...control],
    };
  }
  return {
    layers: [
      {
        kind: "mesh",
        id: "limit",
        ...limit,
        normals: answer.limit_normals,
        values: { of: answer.distances, range: [0, answer.errors[state.level] ?? 1], ramp: "deviation" },
        paint: PAINT.front,
        shading: "smooth",
        sides: "both",
      },
      ...control,
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

/** The error after the last round of the answer. */
const errorOf = ({ errors }: Answer) => errors[errors.length - 1]!;
const ratioAt = (errors: readonly number[], n: number) => errors[n - 1]! / errors[n]!;

function liveNumber({ answer, say, texts }: Page): LiveNumber {
  const { errors, points } = answer;
  const last = errors.length - 1;
  return {
    value: errorOf(answer),
    shown: say.number(errorOf(answer)),
    label: texts.label,
    meaning: last === 0 ? texts.first : texts.falls(say.fixed(ratioAt(errors, last)), say.whole(points)),
    tone: "plain",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  return (
    <>
      <Slider
        id="level"
        label={texts.handle}
        shown={say.whole(state.level)}
        spoken={texts.spoken(state.level, say.whole(answer.faces))}
        low={LEVELS[0]}
        high={LEVELS[1]}
        value={state.level}
        choose={(level) => set({ level })}
      />
      <div>
        <Slider
          id="sharpness"
          label={texts.crease}
          shown={say.number(state.sharpness)}
          spoken={texts.sharp(say.number(state.sharpness))}
          low={SHARPNESS[0]}
          high={SHARPNESS[1]}
          step={0.5}
          value={state.sharpness}
          choose={(sharpness) => set({ sharpness })}
        />
        <p class="aside">{texts.creaseHelp}</p>
      </div>
      <Choice
        name="show"
        class="stacked"
        legend={texts.show}
        value={state.show}
        options={[
          { value: "round", label: texts.round },
          { value: "limit", label: texts.limit },
        ]}
        choose={(show) => set({ show })}
      />
      {state.show === "limit" && (
        <div>
          <svg class="ramp-scale" viewBox="0 0 80 6" preserveAspectRatio="none" aria-hidden="true">
            {rampStops("deviation").map((color, i) => (
              <rect key={i} x={10 * i} width={10.2} height={6} fill={color} />
            ))}
          </svg>
          <p class="aside">{texts.scale(say.number(errorOf(answer)))}</p>
        </div>
      )}
      <dl>
        <Row name="faces" label={texts.faces} value={answer.faces}>
          {say.whole(answer.faces)}
        </Row>
        {answer.errors.map((error, n) => (
          <div key={n}>
            <dt>{texts.level(n)}</dt>
            <dd>
              {n > 0 && <small class="aside">{texts.times(say.fixed(ratioAt(answer.errors, n)))} </small>}
              <Data name={`error-${n}`} value={error}>
                {say.number(error)}
              </Data>
            </dd>
          </div>
        ))}
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    level: ["n", number(...LEVELS)],
    sharpness: ["s", number(...SHARPNESS, 2)],
    show: ["c", word("round", "limit")],
    view: ["o", view],
  },
  question: ({ level, sharpness }) => ({ level, sharpness }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
