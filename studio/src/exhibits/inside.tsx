// A point is inside a triangle if all three edge functions have the same sign there.
import { Choice, Figure as Data, Row } from "../view/parts";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { Dot, FLAT, Flat, type Point, at, path } from "./Flat";
import { point, points, word } from "./fragment";
import type { Language } from "./say";

interface State {
  probe: Point;
  /** A, B and C. */
  corners: readonly Point[];
  winding: "ccw" | "cw";
}

type Side = "left" | "on" | "right";

interface Answer {
  edge_functions: [number, number, number];
  sides: [Side, Side, Side];
  position: "inside" | "boundary" | "outside";
  signed_area: number;
}

const A: Point = [2, 1.4];
const B: Point = [10.2, 2.4];
const C: Point = [5.4, 7];
const defaults: State = { probe: [6.2, 3.4], corners: [A, B, C], winding: "ccw" };
/** The corners in the order of the winding. */
const rowsOf = ({ winding }: State) => (winding === "ccw" ? [0, 1, 2] : [0, 2, 1]);
const cornersOf = (state: State): Point[] => rowsOf(state).map((row) => state.corners[row]!);

interface Texts extends CommonTexts {
  figure: string;
  probe: string;
  corner(name: string): string;
  at(x: string, y: string): string;
  winding: string;
  ccw: string;
  cw: string;
  label: string;
  of(n: number): string;
  edge(name: string): string;
  side: Record<Side, string>;
  position: Record<Answer["position"], string>;
  area: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "Drag the point or a corner.{keys} Arrow keys move them, with Shift by small steps; Page Up and Page Down by large ones.",
    figure: "A triangle, the lines of its three edges, and a point to move",
    probe: "The point",
    corner: (name) => `Corner ${name}`,
    at: (x, y) => `x ${x}, y ${y}`,
    winding: "The corners run",
    ccw: "counter-clockwise",
    cw: "clockwise",
    label: "Edges that have the point on their left",
    of: (n) => `${n} of 3`,
    edge: (name) => `Edge function ${name}`,
    side: { left: "left", on: "on the line", right: "right" },
    position: {
      inside: "The same side of all three: the point is inside.",
      boundary: "On an edge, exactly. A rule assigns the point to one of the two triangles, so that no pixel is drawn twice.",
      outside: "The sides differ: the point is outside.",
    },
    area: "Signed area of the triangle",
    story: [
      "Walk from one corner to the next: a point lies on your left or on your right, which is the sign of the *edge function* (b − a) × (p − a). A triangle is convex, so inside means *the same side of all three edges*. Graphics hardware decides every pixel like this.",
      "Each edge function is linear in the pixel’s place, so the next pixel costs three additions.",
      "Run the corners the other way round, and all three signs flip. Inside is still where they agree; negative signs now mean that you see the back.",
      "The signs here are exact. A rounded sign near an edge would give a pixel to both neighbours, or to none: a crack. The core uses an exact sign test (Shewchuk), which computes as many digits as the sign needs.",
    ],
    attempts: [
      "Move the point across one edge: one number passes through zero, the others keep their sign.",
      "Let the corners run clockwise. Which condition means inside now?",
    ],
  },
  zh: {
    hint: "拖动测试点或顶点。{keys}方向键移动，加 Shift 走小步，Page Up 和 Page Down 走大步。",
    figure: "一个三角形、三条边所在的直线，以及一个可移动的点",
    probe: "测试点",
    corner: (name) => `顶点 ${name}`,
    at: (x, y) => `x ${x}，y ${y}`,
    winding: "顶点次序",
    ccw: "逆时针",
    cw: "顺时针",
    label: "点在几条边的左侧",
    of: (n) => `3 条中的 ${n} 条`,
    edge: (name) => `边函数 ${name}`,
    side: { left: "左侧", on: "在直线上", right: "右侧" },
    position: {
      inside: "对三条边都在同一侧：点在三角形内。",
      boundary: "恰好在边上。由约定决定归哪个三角形，以免同一像素画两次。",
      outside: "左右不一：点在三角形外。",
    },
    area: "三角形的有向面积",
    story: [
      "从一个顶点走向下一个顶点，一个点不是在左边就是在右边，一个乘积就能分辨：*边函数* (b − a) × (p − a)。三角形是凸的，所以“在内部”就是*位于三条边的同一侧*。光栅化硬件正是这样判断每个像素的。",
      "边函数对像素位置是线性的，移到下一个像素只需三次加法。",
      "把顶点次序反过来，三个符号全部翻转。符号一致处仍是内部；只是现在都为负，说明看到的是背面。",
      "这里的符号是精确的。若靠近边时因舍入而判错，一个像素会同时属于两个相邻三角形，或者谁也不要，出现裂缝。核心使用 Shewchuk 的谓词：符号需要多少位，就算多少位。",
    ],
    attempts: [
      "让点越过一条边：一个数经过零，另外两个不受影响。",
      "改成顺时针，现在靠什么判断内部？",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
/** The edges by their opposite corners, in the core's numbering: from, to. */
const EDGES = [
  [1, 2],
  [2, 0],
  [0, 1],
] as const;
const nameOf = (winding: State["winding"], i: number) => (winding === "ccw" ? "ABC" : "ACB")[i]!;

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill } = page;
  const corners = cornersOf(state);
  return (
    <Flat name={texts.figure}>
      <path class={`triangle ${answer.position}`} d={path(corners)} />
      {EDGES.map(([from, to], i) => (
        <Edge key={i} from={corners[from]!} to={corners[to]!} probe={state.probe} side={answer.sides[i]!} />
      ))}
      {corners.map((corner, i) => {
        // Away from the middle of the triangle, so that no name is on a side.
        const [dx, dy] = [0, 1].map((k) => corner[k]! - corners.reduce((sum, other) => sum + other[k]! / 3, 0)) as [number, number];
        const far = 0.5 / (Math.hypot(dx, dy) || 1);
        const [x, y] = at([corner[0] + dx * far, corner[1] + dy * far - 0.1]).split(" ");
        return (
          <text key={i} class="label" x={x} y={y}>
            {nameOf(state.winding, i)}
          </text>
        );
      })}
      <Dot
        name={texts.probe}
        spoken={`${texts.at(say.fixed(state.probe[0]), say.fixed(state.probe[1]))}${say.marks.stop}${texts.position[answer.position]}`}
        place={state.probe}
        isStill={isStill}
        move={(change) => set(({ probe }) => ({ probe: change(probe) }))}
      />
      {state.corners.map((corner, i) => (
        <Dot
          key={i}
          name={texts.corner("ABC"[i]!)}
          spoken={texts.at(say.fixed(corner[0]), say.fixed(corner[1]))}
          place={corner}
          isStill={isStill}
          isFaint
          reach={20}
          move={(change) => set(({ corners }) => ({ corners: corners.map((old, k) => (k === i ? change(old) : old)) }))}
        />
      ))}
    </Flat>
  );
}

/** An edge with its arrow, the line through it, and a narrow band on the side on which the point lies. */
function Edge({ from, to, probe, side }: { from: Point; to: Point; probe: Point; side: Side }) {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(dx, dy);
  const [ux, uy] = [dx / length, dy / length];
  // `off` counts to the left of the edge.
  const on = (t: number, off = 0): Point => [from[0] + t * dx - off * uy, from[1] + t * dy + off * ux];
  const band = side === "on" ? 0 : side === "left" ? 0.32 : -0.32;
  const foot = ((probe[0] - from[0]) * ux + (probe[1] - from[1]) * uy) / length;
  return (
    <g class={`edge ${side}`}>
      <path class="half" d={path([on(-3), on(4), on(4, band), on(-3, band)])} />
      <path class="whole" d={path([on(-3), on(4)], false)} />
      <path class="side" d={path([from, to], false)} />
      <path class="arrow" d={path([on(0.56 - 0.22 / length, 0.15), on(0.56), on(0.56 - 0.22 / length, -0.15)], false)} />
      <path class="reach-of" d={path([on(foot), probe], false)} />
    </g>
  );
}

function liveNumber({ answer, texts }: Page): LiveNumber {
  const n = answer.sides.filter((side) => side === "left").length;
  return {
    value: n,
    shown: texts.of(n),
    label: texts.label,
    meaning: texts.position[answer.position],
    tone: answer.position === "inside" ? "good" : answer.position === "outside" ? "bad" : "plain",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  return (
    <>
      <dl>
        {EDGES.map(([from, to], i) => (
          <div key={i} class={`sided ${answer.sides[i]}`}>
            <dt>{texts.edge(nameOf(state.winding, from) + nameOf(state.winding, to))}</dt>
            <dd>
              <Data name={`edge-${i}`} value={answer.edge_functions[i]!}>
                {say.fixed(answer.edge_functions[i]!)}
              </Data>{" "}
              <small>{texts.side[answer.sides[i]!]}</small>
            </dd>
          </div>
        ))}
        <Row name="area" label={texts.area} value={answer.signed_area}>
          {say.fixed(answer.signed_area)}
        </Row>
      </dl>
      <Choice
        name="winding"
        legend={texts.winding}
        value={state.winding}
        options={[
          { value: "ccw", label: texts.ccw },
          { value: "cw", label: texts.cw },
        ]}
        choose={(winding) => set({ winding })}
      />
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    probe: ["p", point([0, FLAT.width], [0, FLAT.height])],
    corners: ["c", points<Point>(3, 3, [[0, FLAT.width], [0, FLAT.height]])],
    winding: ["w", word("ccw", "cw")],
  },
  question: (state) => ({ corners: cornersOf(state), point: state.probe }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
