// Budget against triangles, for a curve, patches, a cage and a field on one chart.
import { Choice, Figure as Data, Slider } from "../view/parts";
import { Chart, chain } from "./Chart";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { number, word } from "./fragment";
import { px } from "./Grip";
import type { Language } from "./say";

type Name = "curve" | "patch" | "cage" | "field";
const NAMES = ["curve", "patch", "cage", "field"] as const satisfies readonly Name[];

interface State {
  shape: Name;
  step: number;
}

interface Answer {
  series: { name: Name; steps: [length: number, count: number, bound: number][] }[];
  count: number;
  length: number;
  bound: number;
  times: number;
  slope: number;
}

const LAST = 4;
const defaults: State = { shape: "patch", step: 2 };

interface Texts extends CommonTexts {
  figure: string;
  shape: string;
  shapes: Record<Name, string>;
  lines: Record<Name, string>;
  step: string;
  within(length: string): string;
  label: string;
  meaning: Record<"curve" | "surface", (times: string) => string>;
  count: Record<"curve" | "surface", string>;
  bound: string;
  times: string;
  x: string;
  y: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "The slider halves the length that may be lost. It takes the arrow keys, too.",
    figure: "Triangles over the length that may be lost, by decades, for four kinds of shape",
    shape: "Shape",
    shapes: { curve: "a curve", patch: "patches", cage: "a cage", field: "a field" },
    lines: { curve: "curve", patch: "teapot, patches", cage: "cube, cage", field: "torus, field" },
    step: "May be lost, in units",
    within: (length) => `at most ${length} units`,
    label: "Slope: how the count grows as the length shrinks",
    meaning: {
      curve: (times) =>
        `Its law is −½: from here, half the error takes ${times} times the segments. The error falls with their square.`,
      surface: (times) =>
        `Its law is −1, reached once the triangles are small: from here, half the error takes ${times} times the triangles. They have two directions to get finer in.`,
    },
    count: { curve: "Segments", surface: "Triangles" },
    bound: "Lost, proved",
    times: "Half the error takes",
    x: "length that may be lost, smaller to the right",
    y: "segments or triangles",
    story: [
      "A chord that is half as long misses the curve by a quarter. So the error of *a curve* falls with the square of its segments: to halve it takes √2 times as many. Drawn by decades this is a straight line of slope −½.",
      "*A surface* is cut in two directions. Half the error takes √2 times as many cuts in each, and that is twice the triangles: slope −1. Whether the surface is written as patches, as a cage that is subdivided, or as a field: once the triangles are small, it is the same law.",
      "What differs is the height of the line. It says how much the shape bends, and how well triangles are placed: where it bends most, they have to be smallest.",
      "The budget is what one chooses, the bound is what was lost and is proved. The same four ways of writing a shape down go in, and one number comes out of each.",
    ],
    attempts: [
      "Take the curve, then the patches. Which of them can afford a tenth of the error?",
      "Compare the slopes of patches, cage and field. And their heights?",
      "A pixel at your distance is some length. Find it on the axis: further to the right nothing shows.",
    ],
  },
  zh: {
    hint: "滑块把允许的误差减半，也可以用方向键。",
    figure: "四种形状的三角形数随允许误差的变化，双对数坐标",
    shape: "形状",
    shapes: { curve: "曲线", patch: "曲面片", cage: "控制网格", field: "场" },
    lines: { curve: "曲线", patch: "茶壶（曲面片）", cage: "立方体（控制网格）", field: "圆环（场）" },
    step: "允许的误差（单位）",
    within: (length) => `至多 ${length} 个单位`,
    label: "斜率：长度缩小时数目怎样增长",
    meaning: {
      curve: (times) => `规律是 −½：从这里起，误差减半要 ${times} 倍的线段。误差随线段数的平方下降。`,
      surface: (times) => `规律是 −1（三角形足够小时）：从这里起，误差减半要 ${times} 倍的三角形，因为要在两个方向上加密。`,
    },
    count: { curve: "线段数", surface: "三角形数" },
    bound: "已证明的误差上界",
    times: "误差减半需要",
    x: "允许的误差，越往右越小",
    y: "线段数或三角形数",
    story: [
      "弦长减半，弦高误差降到四分之一。所以*曲线*的误差随线段数的平方下降：误差减半，线段数为 √2 倍。在双对数坐标上是一条斜率为 −½ 的直线。",
      "*曲面*要在两个方向上切分。误差减半，每个方向要 √2 倍，合起来三角形加倍：斜率 −1。无论写成曲面片、细分的控制网格还是场，只要三角形足够小，都是同一条规律。",
      "不同的是线的高低。它说明形状弯曲得有多厉害，三角形安排得有多好：弯得最厉害的地方，三角形必须最小。",
      "误差预算由人来定，上界说明实际损失，而且经过证明。四种写下形状的方法放进去，各得出一个数。",
    ],
    attempts: [
      "先看曲线，再看曲面片：哪一个负担得起十分之一的误差？",
      "比较曲面片、控制网格和场的斜率，再比较高低。",
      "在你的观看距离上，一个像素对应某个长度。在轴上找到它：再往右就看不出来了。",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
/** Names stand before their lines; those of cage and field begin close together. */
const ASIDE: Record<Name, number> = { curve: 5, patch: 5, cage: 20, field: -5 };
const kindOf = (name: Name) => (name === "curve" ? "curve" : "surface");

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say } = page;
  const chosen = answer.series.find(({ name }) => name === state.shape)!.steps;
  const [here, next] = [chosen[state.step]!, chosen[state.step + 1]!];
  const lengths = chosen.map(([length]) => length);
  return (
    <Chart
      name={texts.figure}
      isFigure
      width={720}
      height={480}
      x={{ low: 0.8, high: 0.0031, isLog: true, label: texts.x, ticks: lengths.map((x) => [x, say.number(x)] as const) }}
      y={{
        low: 4,
        high: 20000,
        isLog: true,
        label: texts.y,
        ticks: [10, 100, 1000, 10000].map((y) => [y, say.whole(y)] as const),
      }}
    >
      {(at) => {
        const [[x0, y0], [x1, y1]] = [at(here[0], here[1]), at(next[0], next[1])];
        return (
          <>
            {answer.series.map(({ name, steps }) => {
              const [x, y] = at(steps[0]![0], steps[0]![1]);
              const isChosen = name === state.shape;
              return (
                <g key={name} class={isChosen ? "chosen" : ""}>
                  <path class={isChosen ? "drawn" : "drawn quiet"} d={chain(at, steps.map(([a, b]) => [a, b] as const))} />
                  {steps.map(([a, b]) => {
                    const [cx, cy] = at(a, b).map(px);
                    return <circle key={a} class={isChosen ? "here" : "here quiet"} r={isChosen ? 5 : 3.5} cx={cx} cy={cy} />;
                  })}
                  <text class="y name" x={px(x - 12)} y={px(y + ASIDE[name])}>
                    {texts.lines[name]}
                  </text>
                </g>
              );
            })}
            <path class="goal" d={`M${px(x0)} ${px(y0)}H${px(x1)}V${px(y1)}`} />
            <text class="x" x={px((x0 + x1) / 2)} y={px(y0 + 20)}>
              ½
            </text>
            <text x={px(x1 + 7)} y={px((y0 + y1) / 2 + 6)}>
              × {say.fixed(answer.times)}
            </text>
            <circle class="here" r="8" cx={px(x0)} cy={px(y0)} />
          </>
        );
      }}
    </Chart>
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  return {
    value: answer.slope,
    shown: say.fixed(answer.slope),
    label: texts.label,
    meaning: texts.meaning[kindOf(state.shape)](say.fixed(answer.times)),
    tone: "plain",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  return (
    <>
      <Slider
        id="step"
        label={texts.step}
        shown={say.number(answer.length)}
        spoken={texts.within(say.number(answer.length))}
        low={0}
        high={LAST}
        step={1}
        value={state.step}
        choose={(step) => set({ step })}
      />
      <Choice
        name="shape"
        legend={texts.shape}
        value={state.shape}
        options={NAMES.map((value) => ({ value, label: texts.shapes[value] }))}
        choose={(shape) => set({ shape })}
      />
      <dl>
        <div>
          <dt>{texts.count[kindOf(state.shape)]}</dt>
          <dd>
            <Data name="count" value={answer.count}>
              {say.whole(answer.count)}
            </Data>
          </dd>
        </div>
        <div>
          <dt>{texts.bound}</dt>
          <dd>
            <Data name="bound" value={answer.bound}>
              {say.number(answer.bound)}
            </Data>
          </dd>
        </div>
        <div>
          <dt>{texts.times}</dt>
          <dd>
            <Data name="times" value={answer.times}>
              {say.fixed(answer.times)}×
            </Data>
          </dd>
        </div>
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: { shape: ["s", word(...NAMES)], step: ["n", number(0, LAST)] },
  question: ({ shape, step }) => ({ shape, step }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
