// Bernstein's four weights: a point of a cubic is a mixture of its control points, which de Casteljau's construction finds.
import { useRef } from "preact/hooks";
import { Choice, Row, Slider } from "../view/parts";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { Dot, FLAT, Flat, type Point, cubic, kept, path, toSvg } from "./Flat";
import { number, points, word } from "./fragment";
import { Grip, px } from "./Grip";
import type { Language } from "./say";
import { SIDE } from "./spout";

type Four = readonly [Point, Point, Point, Point];
type Form = "arch" | "wave" | "loop" | "spout";

interface State {
  form: Form;
  /** How far the control points of the form have been moved. */
  shifts: readonly Point[];
  t: number;
}

interface Answer {
  weights: [number, number, number, number];
  sum: number;
  smallest: number;
  first: [Point, Point, Point];
  second: [Point, Point];
  point: Point;
  tangent: Point;
  parts: [Four, Four];
  is_in_hull: boolean;
  range: [number, number];
  graphs: Float32Array[];
}

/** Chosen so that the construction stays in the figure for t from −0.1 to 1.1, too. */
const FORMS: Record<Form, Four> = {
  arch: [
    [1.6, 2.0],
    [2.4, 6.6],
    [8.2, 7.0],
    [10.4, 2.6],
  ],
  wave: [
    [1.6, 2.8],
    [5.4, 6.7],
    [6.4, 1.3],
    [10.4, 5.2],
  ],
  loop: [
    [3.3, 1.9],
    [9.4, 6.4],
    [2.4, 6.7],
    [8.7, 1.9],
  ],
  spout: SIDE,
};
const NAMES: readonly Form[] = ["arch", "wave", "loop", "spout"];
const [LOW, HIGH] = [-0.1, 1.1] as const;
const UNMOVED: readonly Point[] = [
  [0, 0],
  [0, 0],
  [0, 0],
  [0, 0],
];
const defaults: State = { form: "arch", shifts: UNMOVED, t: 0.35 };
const controlOf = ({ form, shifts }: State) => FORMS[form].map((point, i) => kept([point[0] + shifts[i]![0], point[1] + shifts[i]![1]])) as unknown as Four;

interface Texts extends CommonTexts {
  figure: string;
  handle: string;
  spoken(t: string): string;
  control(name: string): string;
  at(x: string, y: string): string;
  form: string;
  forms: Record<Form, string>;
  label: string;
  weight(i: number): string;
  sum: string;
  graph: string;
  inside(t: string): string;
  outside: string;
  /** A weight is negative, and the point happens to lie in the hull. */
  beyond: string;
  end: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "Drag the control points, and the point along the curve, or move the slider.{keys} Arrow keys move it, with Shift by small steps; Home and End go beyond the ends.",
    figure: "A cubic curve with its control points, their hull and de Casteljau’s construction",
    handle: "The parameter t",
    spoken: (t) => `t = ${t}`,
    control: (name) => `Control point P${name}`,
    at: (x, y) => `x ${x}, y ${y}`,
    form: "Curve",
    forms: { arch: "arch", wave: "wave", loop: "loop", spout: "spout" },
    label: "Smallest of the four weights",
    weight: (i) => `Weight of P${"₀₁₂₃"[i]}`,
    sum: "Sum",
    graph: "The four weights over t: none is negative between 0 and 1",
    inside: (t) => `At t = ${t} no weight is negative and they sum to one: the point is a mixture of the four, so it lies in their hull.`,
    outside: "Beyond the ends a weight is negative. The sum is still one, but this is not a mixture any more, and the point has left the hull.",
    beyond: "Beyond the ends a weight is negative. Nothing keeps the point in the hull any more; here it still happens to be inside.",
    end: "At an end one weight is 1 and the others are 0: the curve starts and ends at its end points.",
    story: [
      "A cubic Bézier curve is four points and four *weights*, the polynomials (1−t)³, 3t(1−t)², 3t²(1−t) and t³, drawn as discs. Between t = 0 and t = 1 none is negative, and they sum to one. So the curve cannot leave the *hull*, the shape that a rubber band around the four points would take.",
      "*De Casteljau’s construction* finds the same point by linear interpolation alone: mark the share t on the three legs, on the two lines between those marks, and on the last line. Four points, three, two, one. The last line is the tangent, and the marks on the way are the control points of both parts, left and right of t: one construction gives point, tangent and split.",
    ],
    attempts: [
      "Go to both ends: which weight is 1? Along which leg does the curve leave?",
      "Move t below 0 or above 1. When does the point leave the shaded hull?",
    ],
  },
  zh: {
    hint: "拖动控制点，或沿曲线拖动圆点，或移动滑块。{keys}方向键移动它，加 Shift 走小步，Home 和 End 到两端之外。",
    figure: "一条三次曲线，带控制点、凸包和德卡斯特里奥算法",
    handle: "参数 t",
    spoken: (t) => `t = ${t}`,
    control: (name) => `控制点 P${name}`,
    at: (x, y) => `x ${x}，y ${y}`,
    form: "曲线",
    forms: { arch: "拱形", wave: "波形", loop: "环", spout: "壶嘴" },
    label: "四个权重中最小的",
    weight: (i) => `P${"₀₁₂₃"[i]} 的权重`,
    sum: "总和",
    graph: "四个权重随 t 的变化：在 0 与 1 之间都不为负",
    inside: (t) => `t = ${t} 时没有负权重，总和为一：点是四个控制点的混合，因此在凸包内。`,
    outside: "越过端点，就有权重为负。总和仍是一，但已经不是混合：点离开了凸包。",
    beyond: "越过端点，就有权重为负。凸包不再留得住这个点，只是此刻它碰巧还在里面。",
    end: "在端点处一个权重为 1，其余为 0：曲线以两个端点为起点和终点。",
    story: [
      "三次贝塞尔曲线由四个点和四个*权重*组成，权重是伯恩斯坦多项式 (1−t)³、3t(1−t)²、3t²(1−t) 和 t³，即圆盘的大小。t 在 0 与 1 之间时，它们都不为负，总和为一，所以曲线不会离开*凸包*，也就是橡皮筋绷住四个点的形状。",
      "*德卡斯特里奥算法*只用线性插值就能找到同一个点：在三条边上取比例 t，在两条连线上再取，最后在一条线上取。四点变三点，三点变两点，两点变一点。最后那条线就是切线，途中的点正是 t 左右两段的控制点：算一次，点、切线、左右两段全都有了。",
    ],
    attempts: [
      "走到两端：哪个权重是 1？曲线沿哪条边离开？",
      "让 t 小于 0 或大于 1：点什么时候离开涂了底色的凸包？",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
const PAINTS = ["zero", "one", "two", "three"] as const;
const within = (t: number) => Math.round(Math.min(Math.max(t, LOW), HIGH) * 100) / 100;

/** A triangle in counter-clockwise order. */
function counterClockwise([a, b, c]: readonly Point[]): Point[] {
  const turn = (b![0] - a![0]) * (c![1] - a![1]) - (b![1] - a![1]) * (c![0] - a![0]);
  return turn < 0 ? [a!, c!, b!] : [a!, b!, c!];
}

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill } = page;
  const control = controlOf(state);
  const latestPage = useRef(page);
  latestPage.current = page;
  // The triangles of any three points cover the hull. All have the same winding, or overlaps would cancel in the fill.
  const hull = [0, 1, 2, 3].map((omitted) => path(counterClockwise(control.filter((_, i) => i !== omitted)))).join("");
  const isWithin = state.t >= 0 && state.t <= 1;
  return (
    <Flat name={texts.figure}>
      <path class="hull" d={hull} />
      <path class="leg" d={path(control, false)} />
      {!isWithin && <path class="beyond" d={cubic(answer.parts[state.t > 1 ? 0 : 1])} />}
      <path class="whole-curve" d={cubic(control)} />
      {isWithin && (
        <>
          <path class="part-of left" d={cubic(answer.parts[0])} />
          <path class="part-of right" d={cubic(answer.parts[1])} />
        </>
      )}
      <path class="level" d={path(answer.first, false)} />
      <path class="level last" d={path(answer.second, false)} />
      {[...answer.first, ...answer.second].map((mark, i) => {
        const [x, y] = toSvg(mark);
        return <circle key={i} class="mark" cx={px(x)} cy={px(y)} r={4} />;
      })}
      {control.map((point, i) => {
        const [x, y] = toSvg(point);
        const weight = answer.weights[i]!;
        const [dx, dy] = [point[0] - 6, point[1] - 4];
        const far = 40 / Math.hypot(dx, dy);
        return (
          <g key={i} class={`weighted ${PAINTS[i]} ${weight < 0 ? "negative" : ""}`}>
            <circle class="disc" cx={px(x)} cy={px(y)} r={px(34 * Math.sqrt(Math.min(Math.abs(weight), 1.6)))} />
            <text class="label" x={px(x + dx * far)} y={px(y - dy * far + 6)}>
              P{"₀₁₂₃"[i]}
            </text>
          </g>
        );
      })}
      <Grip
        name={texts.handle}
        spoken={texts.spoken(say.fixed(state.t))}
        now={state.t}
        low={LOW}
        high={HIGH}
        at={toSvg(answer.point)}
        isStill={isStill}
        grab={() => {
          let [t, x, y] = [latestPage.current.state.t, 0, 0];
          return (dx, dy) => {
            // Along the current tangent, so that a single drag can follow the whole curve.
            const origin = toSvg([0, 0]);
            const [wx, wy] = toSvg(latestPage.current.answer.tangent).map((end, k) => end - origin[k]!) as [number, number];
            // The lower limit keeps t from flying where the tangent is short.
            t += ((dx - x) * wx + (dy - y) * wy) / Math.max(wx * wx + wy * wy, 1e4);
            t = Math.min(Math.max(t, LOW), HIGH);
            [x, y] = [dx, dy];
            set({ t: within(t) });
          };
        }}
        step={(right, up) => set(({ t }) => ({ t: within(t + (right || up) * (Math.abs(right || up) < 1 ? 0.1 : 0.05)) }))}
      />
      {control.map((place, i) => (
        <Dot
          key={i}
          name={texts.control("₀₁₂₃"[i]!)}
          spoken={texts.at(say.fixed(place[0]), say.fixed(place[1]))}
          place={place}
          isStill={isStill}
          isFaint
          reach={18}
          move={(change) =>
            set((state) => {
              const [x, y] = change(controlOf(state)[i]!);
              const home = FORMS[state.form][i]!;
              const shift: Point = [Math.round((x - home[0]) * 100) / 100, Math.round((y - home[1]) * 100) / 100];
              return { shifts: state.shifts.map((old, k) => (k === i ? shift : old)) };
            })
          }
        />
      ))}
    </Flat>
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  const meaning = !answer.is_in_hull
    ? texts.outside
    : answer.smallest < 0
      ? texts.beyond
      : state.t === 0 || state.t === 1
        ? texts.end
        : texts.inside(say.fixed(state.t));
  return {
    value: answer.smallest,
    shown: say.fixed(answer.smallest, 3),
    label: texts.label,
    meaning,
    tone: answer.is_in_hull ? "good" : "bad",
  };
}

/** The graphs' size in pixels, and the range of weights; t runs from −0.1 to 1.1. */
const GRAPH = { width: 300, height: 150, low: -0.45, high: 1.4 } as const;

function Graph({ page }: { page: Page }) {
  const { state, answer, texts } = page;
  const x = (t: number) => px(((t - LOW) / (HIGH - LOW)) * GRAPH.width);
  const y = (w: number) => px(((GRAPH.high - w) / (GRAPH.high - GRAPH.low)) * GRAPH.height);
  return (
    <svg class="graph" viewBox={`0 0 ${GRAPH.width} ${GRAPH.height}`} role="img" aria-label={texts.graph}>
      <path class="span" d={`M${x(0)} 0H${x(1)}V${GRAPH.height}H${x(0)}z`} />
      <path class="axis" d={`M0 ${y(0)}H${GRAPH.width}M0 ${y(1)}H${GRAPH.width}`} />
      {answer.graphs.map((graph, i) => (
        <path
          key={i}
          class={PAINTS[i]}
          d={`M${[...graph].map((w, k) => `${x(LOW + ((HIGH - LOW) * k) / (graph.length - 1))} ${y(w)}`).join("L")}`}
        />
      ))}
      <path class="now" d={`M${x(state.t)} 0V${GRAPH.height}`} />
      {answer.weights.map((weight, i) => (
        <circle key={i} class={PAINTS[i]} cx={x(state.t)} cy={y(weight)} r={4} />
      ))}
    </svg>
  );
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  return (
    <>
      <Slider
        id="t"
        label={texts.handle}
        shown={say.fixed(state.t)}
        spoken={texts.spoken(say.fixed(state.t))}
        low={LOW}
        high={HIGH}
        step={0.01}
        value={state.t}
        choose={(t) => set({ t: within(t) })}
      />
      <Graph page={page} />
      <dl>
        {answer.weights.map((weight, i) => (
          <Row key={i} class={`of-weight ${PAINTS[i]}`} name={`weight-${i}`} label={texts.weight(i)} value={weight}>
            {say.fixed(weight, 3)}
          </Row>
        ))}
        <Row name="sum" label={texts.sum} value={answer.sum}>
          {say.fixed(answer.sum, 3)}
        </Row>
      </dl>
      <Choice
        name="form"
        legend={texts.form}
        value={state.form}
        options={NAMES.map((value) => ({ value, label: texts.forms[value] }))}
        choose={(form) => set({ form, shifts: UNMOVED })}
      />
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    form: ["c", word(...NAMES)],
    shifts: ["k", points<Point>(4, 4, [[-FLAT.width, FLAT.width], [-FLAT.height, FLAT.height]])],
    t: ["h", number(LOW, HIGH, 100)],
  },
  question: (state) => ({ control: controlOf(state), t: state.t }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
