// Three corners define a plane. The fourth corner of a quad can leave it, and then the surface depends on the diagonal.
import { Choice, Figure as Data, Row, Slider } from "../view/parts";
import type { Picture, Vec3, View } from "../viewer";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { number, view, word } from "./fragment";
import { FRAME } from "./frame_texts";
import { PAINT } from "./paint";
import { Scene } from "./Scene";
import type { Language } from "./say";

interface State {
  corners: "3" | "4";
  height: number;
  cut: "first" | "second";
  view: View;
}

interface Answer {
  bulge: number | null;
  is_flat: boolean;
  bends_deg: [number | null, number | null];
  triangles: [number[][], number[][]];
  middles: [Vec3, Vec3];
  middle_rise: number;
  corner_height: number | null;
}

const HOME: View = { azimuth: -62, elevation: 24, distance: 6.4, target: [0, 0, 0.25] };
const defaults: State = { corners: "4", height: 0.9, cut: "first", view: HOME };
const HIGHEST = 1.5;

/** The square's corners, one of them lifted. */
function cornersOf({ corners, height }: State): [Vec3, Vec3, Vec3, Vec3] {
  const lifted = (is: boolean) => (is ? height : 0);
  return [
    [-1, -1, 0],
    [1, -1, 0],
    [1, 1, lifted(corners === "3")],
    [-1, 1, lifted(corners === "4")],
  ];
}

interface Texts extends CommonTexts {
  figure: string;
  corners: string;
  three: string;
  four: string;
  handle(corner: string): string;
  spoken(n: string): string;
  cut: string;
  first: string;
  second: string;
  bends: string;
  bend(cut: string): string;
  rise: string;
  label3: string;
  label4: string;
  exactly: string;
  flat: string;
  three0: string;
  bulges(rise: string, is: "up" | "down"): string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: FRAME.en.turn,
    figure: "A square in space with one corner lifted out of the plane of the others",
    corners: "Corners",
    three: "three: A, B, C",
    four: "four: A, B, C, D",
    handle: (corner) => `Height of corner ${corner}`,
    spoken: (n) => `${n} units`,
    cut: "Cut it along",
    first: "A–C",
    second: "B–D",
    bends: "Fold along the cut",
    bend: (cut) => `along ${cut}`,
    rise: "Middle on B–D above middle on A–C",
    label3: "Corner C from the plane of A, B, C",
    label4: "Corner D from the plane of A, B, C",
    exactly: "0, exactly",
    flat: "All four lie in one plane: both cuts give the same surface.",
    three0: "Lift C as far as you like: the plane goes with it.",
    bulges: (rise, is) =>
      `Now four corners are not one surface. Cut along B–D, the middle lies ${rise} ${is === "up" ? "higher" : "lower"} than along A–C.`,
    story: [
      "Through three points that are not on one line there is *one* plane, so a triangle cannot bend: one normal, one inside. A fourth point may leave that plane. Folded along one diagonal the middle is a ridge, along the other a valley, and both have the same corners and edges: no file that stores only corners says which was meant.",
      "This is why graphics hardware draws triangles. Authors keep their quads, which are good to work with, and somewhere on the way to the screen every quad is cut in two. A tool that cuts along the other diagonal shows a different shape.",
      "The distance is signed and its zero is exact: the core decides by exact arithmetic whether four points lie in one plane, not by a tolerance that somebody chose.",
    ],
    attempts: [
      "Lift D, then change the cut: the red line in the middle is the difference.",
      "Choose three corners and lift C. Can you make the number differ from zero?",
    ],
  },
  zh: {
    hint: FRAME.zh.turn,
    figure: "空间中的正方形，一个顶点离开其余三点所在的平面",
    corners: "顶点数",
    three: "三个：A、B、C",
    four: "四个：A、B、C、D",
    handle: (corner) => `顶点 ${corner} 的高度`,
    spoken: (n) => `${n} 个单位`,
    cut: "沿哪条对角线剖分",
    first: "A–C",
    second: "B–D",
    bends: "剖分处的折角",
    bend: (cut) => `沿 ${cut}`,
    rise: "B–D 中点高出 A–C 中点",
    label3: "顶点 C 到平面 ABC 的距离",
    label4: "顶点 D 到平面 ABC 的距离",
    exactly: "恰为 0",
    flat: "四点共面：两种剖分得到同一张曲面。",
    three0: "C 随便抬多高，平面都跟着它走。",
    bulges: (rise, is) => `四个顶点不再确定唯一的曲面：沿 B–D 剖分时，中点比沿 A–C 时${is === "up" ? "高" : "低"} ${rise}。`,
    story: [
      "过不共线的三点*只有一个*平面，三角形弯不了：法线只有一条，内外分明。第四点可以离开这个平面：沿一条对角线折，中间隆起；沿另一条折，中间凹下。两者顶点相同、边也相同，只存顶点的文件说不清原意是哪一种。",
      "图形硬件因此只画三角形。建模的人保留好用的四边形，在送往屏幕的途中，每个四边形都被一分为二。换一个工具，换一条对角线，形状就变了。",
      "这里的距离带符号，零是精确的零：四点是否共面由核心用精确算术判定，而不是靠谁随手定下的容差。",
    ],
    attempts: [
      "抬起 D，再换一种剖分：中间的红线就是两者之差。",
      "选三个顶点并抬起 C：你能让数字离开零吗？",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
const floats = (...points: readonly Vec3[]) => new Float32Array(points.flat());

function pictureOf({ state, answer }: Page): Picture {
  const [a, b, c, d] = cornersOf(state);
  const isThree = state.corners === "3";
  // The plane of A, B and C, a little larger than the square.
  const on = (x: number, y: number): Vec3 => [x, y, isThree ? (state.height * (y + 1)) / 2 : 0];
  const grid: Vec3[] = [];
  for (let i = -6; i <= 6; i++) grid.push(on(-1.5, i / 4), on(1.5, i / 4), on(i / 4, -1.5), on(i / 4, 1.5));
  const faces = isThree ? [[0, 1, 2]] : answer.triangles[state.cut === "first" ? 0 : 1];
  const cut: [Vec3, Vec3] = state.cut === "first" ? [a, c] : [b, d];
  const other: [Vec3, Vec3] = state.cut === "first" ? [b, d] : [a, c];
  const outline = isThree ? [a, b, b, c, c, a] : [a, b, b, c, c, d, d, a];
  return {
    layers: [
      { kind: "lines", id: "grid", positions: floats(...grid), paint: "--line", width: 1, isUnder: true },
      {
        kind: "mesh",
        id: "surface",
        positions: floats(a, b, c, d),
        indices: new Uint32Array(faces.flat()),
        groups: { of: new Uint32Array([0, 1]), paints: [PAINT.front, PAINT.other] },
        paint: PAINT.front,
        shading: "flat",
        sides: "both",
      },
      { kind: "lines", id: "outline", positions: floats(...outline), paint: "--ink", width: 2.2 },
      ...(isThree
        ? []
        : ([
            { kind: "lines", id: "cut", positions: floats(...cut), paint: "--ink", width: 1.6 },
            { kind: "lines", id: "other", positions: floats(...other), paint: "--soft", width: 1.2, isOnTop: true },
            { kind: "lines", id: "lift", positions: floats([-1, 1, 0], d), paint: "--gap", width: 2, isOnTop: true },
            { kind: "lines", id: "between", positions: floats(...answer.middles), paint: "--gap", width: 3.5, isOnTop: true },
            { kind: "points", id: "middles", positions: floats(...answer.middles), paint: "--gap", size: 9, isOnTop: true },
          ] as const)),
      { kind: "points", id: "corners", positions: floats(...(isThree ? [a, b, c] : [a, b, c, d])), paint: "--ink", size: 9 },
    ],
  };
}

function Figure({ page }: { page: Page }) {
  const { state, texts, say, set, isStill } = page;
  const points = cornersOf(state);
  const isThree = state.corners === "3";
  const lifted = isThree ? 2 : 3;
  const [x, y] = points[lifted]!;
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
        points.slice(0, isThree ? 3 : 4).map((point, i) => {
          const [px, py] = at.to(point);
          const [mx, my] = at.to([0, 0, 0.2]);
          const far = Math.hypot(px - mx, py - my) || 1;
          return (
            // Beside the handle, whose arrows point up and down.
            <text
              key={i}
              class="label"
              x={px + (i === lifted ? 26 * Math.sign(px - mx || 1) : (24 * (px - mx)) / far)}
              y={py + (i === lifted ? 0 : (24 * (py - my)) / far) + 6}
            >
              {"ABCD"[i]}
            </text>
          );
        })
      }
      pulls={[
        {
          name: texts.handle("ABCD"[lifted]!),
          spoken: texts.spoken(say.fixed(state.height)),
          value: state.height,
          low: -HIGHEST,
          high: HIGHEST,
          step: 0.1,
          at: [x, y, state.height],
          along: [x, y, state.height + 1],
          move: (change) => set(({ height }) => ({ height: Math.round(change(height) * 100) / 100 })),
        },
      ]}
    />
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  if (state.corners === "3") {
    return { value: answer.corner_height, shown: texts.exactly, label: texts.label3, meaning: texts.three0, tone: "good" };
  }
  const rise = answer.middle_rise;
  return {
    value: answer.bulge,
    shown: answer.is_flat ? texts.exactly : say.fixed(answer.bulge ?? 0),
    label: texts.label4,
    meaning: answer.is_flat ? texts.flat : texts.bulges(say.fixed(Math.abs(rise), 3), rise > 0 ? "up" : "down"),
    tone: answer.is_flat ? "good" : "bad",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const isThree = state.corners === "3";
  return (
    <>
      <Slider
        id="height"
        label={texts.handle(isThree ? "C" : "D")}
        shown={say.fixed(state.height)}
        spoken={texts.spoken(say.fixed(state.height))}
        low={-HIGHEST}
        high={HIGHEST}
        step={0.05}
        value={state.height}
        choose={(height) => set({ height })}
      />
      <Choice
        name="corners"
        legend={texts.corners}
        value={state.corners}
        options={[
          { value: "3", label: texts.three },
          { value: "4", label: texts.four },
        ]}
        choose={(corners) => set({ corners })}
      />
      {!isThree && (
        <>
          <Choice
            name="cut"
            legend={texts.cut}
            value={state.cut}
            options={[
              { value: "first", label: texts.first },
              { value: "second", label: texts.second },
            ]}
            choose={(cut) => set({ cut })}
          />
          <dl>
            {([0, 1] as const).map((i) => (
              <div key={i}>
                <dt>
                  {texts.bends} {i ? texts.second : texts.first}
                </dt>
                <dd>
                  <Data name={`bend-${i}`} value={answer.bends_deg[i]}>
                    {say.degrees(answer.bends_deg[i] ?? 0)}
                  </Data>
                </dd>
              </div>
            ))}
            <Row name="rise" label={texts.rise} value={answer.middle_rise}>
              {say.fixed(answer.middle_rise, 3)}
            </Row>
          </dl>
        </>
      )}
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    corners: ["c", word("3", "4")],
    height: ["h", number(-HIGHEST, HIGHEST, 100)],
    cut: ["d", word("first", "second")],
    view: ["o", view],
  },
  question: (state) => ({ corners: cornersOf(state) }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
