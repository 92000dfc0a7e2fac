// Triangles against budget on one chart, for every representation of a shape.
import { Choice, Row, Slider } from "../view/parts";
import { Chart, type Place, chain } from "./Chart";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { number, word } from "./fragment";
import { px } from "./Grip";
import type { Language } from "./say";

const NAMES = ["curve", "patch", "cage", "nurbs", "field", "volume", "mesh"] as const;
type Name = (typeof NAMES)[number];
/** What the law is explained by. Samples and triangles are copies, whose curves end at the error of their source. */
type Kind = "curve" | "surface" | "volume" | "mesh";

interface State {
  shape: Name;
  step: number;
}

/** The count is `null` if the source itself has a larger error than that length. */
type Step = [length: number, count: number | null, bound: number | null];

interface Answer {
  series: { name: Name; steps: Step[]; source_off: number }[];
  count: number | null;
  length: number;
  bound: number | null;
  source_off: number;
  times: number | null;
  slope: number;
}

const LAST = 4;
const defaults: State = { shape: "patch", step: 2 };

interface Told {
  count: string;
  off: string;
  times: string;
}

interface Texts extends CommonTexts {
  figure: string;
  shape: string;
  shapes: Record<Name, string>;
  lines: Record<Name, string>;
  step: string;
  within(length: string): string;
  label: string;
  meaning: Record<Kind, (told: Told) => string>;
  missing: Record<"volume" | "mesh", (off: string) => string>;
  count: Record<"curve" | "surface", string>;
  bound: string;
  times: string;
  none: string;
  source: string;
  x: string;
  y: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "The slider halves the budget, a length.{keys} Arrow keys move it.",
    figure: "Triangles against the budget, both logarithmic, for seven representations of a shape",
    shape: "Written as",
    shapes: {
      curve: "a curve",
      patch: "patches",
      cage: "a cage",
      nurbs: "NURBS",
      field: "a field",
      volume: "samples",
      mesh: "a mesh",
    },
    lines: { curve: "curve", patch: "patches", cage: "cage", nurbs: "NURBS", field: "field", volume: "samples", mesh: "mesh" },
    step: "May be lost, in units",
    within: (length) => `at most ${length} units`,
    label: "Slope: how the count grows as the length shrinks",
    meaning: {
      curve: ({ times }) =>
        `Its law is −½: from here, half the error takes ${times} times the segments. The error falls with their square.`,
      surface: ({ times }) =>
        `Its law is −1, reached once the triangles are small: from here, half the error takes ${times} times the triangles. Triangles get smaller in two directions.`,
      volume: ({ count, off }) =>
        `No law: samples give the triangles of their cells, ${count}, for any budget. They are up to ${off} off the torus, and no closer mesh can be made of them.`,
      mesh: ({ off }) =>
        `A mesh can only be simplified. Its line is steeper than −1 towards its own triangles, which are up to ${off} off the torus: there it ends.`,
    },
    missing: {
      volume: (off) => `Not possible: the samples are up to ${off} off the torus. It takes more samples.`,
      mesh: (off) => `Not possible: the mesh is up to ${off} off the torus already. It would have to be built again from its source.`,
    },
    count: { curve: "Segments", surface: "Triangles" },
    bound: "Lost, proved",
    times: "Half the error takes",
    none: "none",
    source: "Error of the source",
    x: "budget, a length, smaller to the right",
    y: "segments or triangles",
    story: [
      "A surface is cut in two directions. Half the error takes √2 times the cuts in each, so *twice the triangles*: by decades a line of slope −1, for patches, cage, NURBS and field alike. A curve is cut in one direction: −½. Samples and meshes are copies, and their lines end at their own error.",
      "A chord that is half as long misses the curve by a quarter as much. That is where √2 comes from: the error falls with the square of the segments.",
      "The lines differ in height. The height says how much the shape bends, and how well the triangles are placed: they have to be smallest where it bends most. NURBS, field, samples and mesh are one and the same torus here, 3 units wide; patches are the teapot, and the cage is a cube of 4 units.",
      "*Samples* cannot be meshed more coarsely than their cells, nor more closely than they were taken. *A mesh* is simplified, with the distance proved: a coarse one takes the fewest triangles of all, a fine one approaches its source and ends there. The error of the copies is included here.",
      "You choose the budget; the bound is the error that was made, proved. Every representation takes the same budget and gives one count.",
    ],
    attempts: [
      "Compare the slopes of patches, NURBS and field. And their heights?",
      "Choose samples, then the mesh, and go right: where does each end?",
    ],
  },
  zh: {
    hint: "滑块把允许的误差减半。{keys}方向键也能移动它。",
    figure: "写下形状的七种方法：三角形数随允许误差的变化，双对数坐标",
    shape: "写成",
    shapes: {
      curve: "曲线",
      patch: "曲面片",
      cage: "控制网格",
      nurbs: "NURBS",
      field: "场",
      volume: "样本",
      mesh: "网格",
    },
    lines: { curve: "曲线", patch: "曲面片", cage: "控制网格", nurbs: "NURBS", field: "场", volume: "样本", mesh: "网格" },
    step: "允许的误差（单位）",
    within: (length) => `至多 ${length} 个单位`,
    label: "斜率：长度缩小时数目怎样增长",
    meaning: {
      curve: ({ times }) => `规律是 −½：从这里起，误差减半要 ${times} 倍的线段。误差随线段数的平方下降。`,
      surface: ({ times }) => `规律是 −1（三角形足够小时）：从这里起，误差减半要 ${times} 倍的三角形，因为要在两个方向上加密。`,
      volume: ({ count, off }) =>
        `没有规律：无论允许多大误差，样本都给出各单元的三角形，共 ${count} 个。它们偏离环面至多 ${off}，不能再近。`,
      mesh: ({ off }) => `网格只能简化。越接近自己原有的三角形，就越比 −1 陡；原有的三角形偏离环面至多 ${off}，到此为止。`,
    },
    missing: {
      volume: (off) => `得不到：样本偏离环面至多 ${off}，要更近就得多取样本。`,
      mesh: (off) => `得不到：网格本身已偏离环面至多 ${off}，要更近就得从它的来源重新生成。`,
    },
    count: { curve: "线段数", surface: "三角形数" },
    bound: "已证明的误差上界",
    times: "误差减半需要",
    none: "无",
    source: "来源已有的误差",
    x: "允许的误差，越往右越小",
    y: "线段数或三角形数",
    story: [
      "曲面要在两个方向上切分。误差减半，每个方向要 √2 倍，合起来*三角形加倍*：双对数坐标上斜率为 −1，曲面片、控制网格、NURBS 和场都一样。曲线只有一个方向，斜率 −½。样本和网格是副本，到自身的误差为止。",
      "弦长减半，弦高误差降到四分之一，√2 由此而来：误差随线段数的平方下降。",
      "不同的是线的高低。它说明形状弯曲得有多厉害，三角形安排得有多好：弯得最厉害的地方，三角形必须最小。这里的 NURBS、场、样本和网格是同一个环面，宽 3 个单位；曲面片是茶壶，控制网格是边长 4 的立方体。",
      "*样本*的网格不能比单元更粗，也不能比采样时更准。*网格*经简化，距离有证明：粗的网格用的三角形最少，细的则逼近来源，到此为止。副本已有的误差这里也算在内。",
      "误差预算由人来定，上界说明实际损失，而且经过证明。各种写法放进去，各得出一个数。",
    ],
    attempts: ["比较曲面片、NURBS 和场的斜率，再比较高低。", "选样本，再选网格，往右移：各到哪里为止？"],
  },
};

type Page = PageOf<State, Answer, Texts>;
const kindOf = (name: Name): Kind => (name === "curve" || name === "volume" || name === "mesh" ? name : "surface");
const countOf = (name: Name) => (name === "curve" ? "curve" : "surface");

/** The smallest distance between the names at the lines, in pixels. */
const GAP = 28;

/** Spreads labels so that they are a gap apart: in their order, and a group that would touch is centred on its mean. */
function spread(wanted: readonly number[]): number[] {
  const order = wanted.map((_, i) => i).sort((a, b) => wanted[a]! - wanted[b]!);
  // Less its share of the gaps, each place has to be at least the one before it. Neighbours that
  // are not become one group at their mean (pool adjacent violators), which moves the labels least.
  const groups: { sum: number; rows: number[] }[] = [];
  const mean = ({ sum, rows }: { sum: number; rows: number[] }) => sum / rows.length;
  order.forEach((row, i) => {
    groups.push({ sum: wanted[row]! - i * GAP, rows: [row] });
    while (groups.length > 1 && mean(groups.at(-2)!) > mean(groups.at(-1)!)) {
      const last = groups.pop()!;
      groups.at(-1)!.sum += last.sum;
      groups.at(-1)!.rows.push(...last.rows);
    }
  });
  const places: number[] = [];
  groups.forEach((group) => group.rows.forEach((row) => (places[row] = mean(group) + order.indexOf(row) * GAP)));
  return places;
}

/** The steps that have a count. */
const reachable = (steps: readonly Step[]) =>
  steps.flatMap(([length, count]) => (count === null ? [] : [[length, count] as const]));

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say } = page;
  const chosen = answer.series.find(({ name }) => name === state.shape)!;
  const [here, next] = [chosen.steps[state.step]!, chosen.steps[state.step + 1]!];
  const lengths = chosen.steps.map(([length]) => length);
  const [low, high] = [4, 20000];
  return (
    <Chart
      name={texts.figure}
      isFigure
      width={720}
      height={480}
      x={{ low: 0.55, high: 0.0018, isLog: true, label: texts.x, ticks: lengths.filter((_, i) => i % 2 === 0).map((x) => [x, say.number(x)] as const) }}
      y={{
        low,
        high,
        isLog: true,
        label: texts.y,
        ticks: [10, 100, 1000, 10000].map((y) => [y, say.whole(y)] as const),
      }}
    >
      {(at) => {
        const lines = answer.series.map(({ name, steps }) => ({ name, points: reachable(steps) }));
        const names = spread(lines.map(({ points }) => at(...points[0]!)[1]));
        const left = at(lengths[0]!, low)[0];
        // The chosen line is drawn over the others.
        const order = lines.map((_, i) => i).sort((i, k) => Number(lines[i]!.name === state.shape) - Number(lines[k]!.name === state.shape));
        return (
          <>
            {chosen.source_off > 0 && (
              <>
                <path class="ends" d={chain(at, [[chosen.source_off, low], [chosen.source_off, high]])} />
                <text class="y step" x={px(at(chosen.source_off, high)[0] - 8)} y={px(at(chosen.source_off, high)[1] + 16)}>
                  {texts.source}
                </text>
              </>
            )}
            {order.map((i) => {
              const { name, points } = lines[i]!;
              const isChosen = name === state.shape;
              const first = at(...points[0]!)[1];
              return (
                <g key={name} class={isChosen ? "chosen" : ""}>
                  <path class="leader" d={`M${px(left - 34)} ${px(names[i]!)}L${px(left - 9)} ${px(first)}`} />
                  <path class={isChosen ? "drawn" : "drawn quiet"} d={chain(at, points)} />
                  {points.map(([a, b]) => {
                    const [cx, cy] = at(a, b).map(px);
                    return <circle key={a} class={isChosen ? "here" : "here quiet"} r={isChosen ? 5 : 3.5} cx={cx} cy={cy} />;
                  })}
                  <text class="y name" x={px(left - 40)} y={px(names[i]! + 6)}>
                    {texts.lines[name]}
                  </text>
                </g>
              );
            })}
            {here[1] !== null && <StepMark at={at} here={[here[0], here[1]]} next={next[1] === null ? null : [next[0], next[1]]} page={page} />}
          </>
        );
      }}
    </Chart>
  );
}

interface HereProps {
  at: Place;
  here: readonly [number, number];
  next: readonly [number, number] | null;
  page: Page;
}

/** Marks the chosen step, and the ratio to the next one. */
function StepMark({ at, here, next, page: { answer, say } }: HereProps) {
  const [x0, y0] = at(...here);
  if (!next) return <circle class="here" r="8" cx={px(x0)} cy={px(y0)} />;
  const [x1, y1] = at(...next);
  return (
    <>
      <path class="goal" d={`M${px(x0)} ${px(y0)}H${px(x1)}V${px(y1)}`} />
      <text class="x step" x={px((x0 + x1) / 2)} y={px(y0 + 22)}>
        ½
      </text>
      <text class="step" x={px(x1 + 8)} y={px((y0 + y1) / 2 + 6)}>
        × {say.fixed(answer.times ?? 1)}
      </text>
      <circle class="here" r="8" cx={px(x0)} cy={px(y0)} />
    </>
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  const { shape } = state;
  const kind = kindOf(shape);
  const off = say.number(answer.source_off);
  const isMissing = answer.count === null && (kind === "volume" || kind === "mesh");
  const told = { count: say.whole(answer.count ?? 0), off, times: say.fixed(answer.times ?? 1) };
  return {
    value: answer.slope,
    shown: say.fixed(answer.slope),
    label: texts.label,
    meaning: isMissing ? texts.missing[kind](off) : texts.meaning[kind](told),
    tone: isMissing ? "bad" : "plain",
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
        <Row name="count" label={texts.count[countOf(state.shape)]} value={answer.count}>
          {answer.count === null ? texts.none : say.whole(answer.count)}
        </Row>
        <Row name="bound" label={texts.bound} value={answer.bound}>
          {answer.bound === null ? texts.none : say.number(answer.bound)}
        </Row>
        {answer.source_off > 0 && (
          <Row name="source" label={texts.source} value={answer.source_off}>
            {say.number(answer.source_off)}
          </Row>
        )}
        <Row name="times" label={texts.times} value={answer.times}>
          {answer.times === null ? texts.none : `${say.fixed(answer.times)}×`}
        </Row>
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
