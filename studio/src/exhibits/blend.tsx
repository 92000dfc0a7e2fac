// Two discs united: with a sharp seam by the minimum, and with a filled one by the smooth minimum, whose value is a bound.
import { Row, Slider } from "../view/parts";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { Dot, FLAT, Flat, type Point, toSvg } from "./Flat";
import { number, point } from "./fragment";
import { px } from "./Grip";
import { type Loops, type Region, Regions, outline } from "./Regions";
import type { Language } from "./say";

interface State {
  first: Point;
  second: Point;
  /** In tenths of a unit. */
  width: number;
  probe: Point;
}

interface Answer {
  levels: Region[];
  outline: Loops;
  sharp: Loops;
  radii: [number, number];
  of: [number, number];
  min: number;
  value: number;
  truth: number;
  share: number | null;
  most_added: number;
  pieces: number;
  quality: { outside: string; inside: string };
}

const MOST = 40;
const defaults: State = { first: [4.4, 3.7], second: [7.6, 4.2], width: 20, probe: [6.2, 6.6] };

interface Texts extends CommonTexts {
  figure: string;
  balls: readonly [string, string];
  probe: string;
  at(x: string, y: string): string;
  width: string;
  units(n: string): string;
  label: string;
  surface: string;
  exact(truth: string): string;
  less(value: string, truth: string): string;
  min: string;
  value: string;
  truth: string;
  added: string;
  pieces: string;
  quality(outside: string, inside: string): string;
  known: Record<string, string>;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "Drag both balls and the point.{keys} Arrow keys move them, with Shift by small steps; Page Up and Page Down by large ones.",
    figure: "Two balls and their blend, with lines of equal value; the dashed line is the sharp union",
    balls: ["Ball A", "Ball B"],
    probe: "The point that is asked about",
    at: (x, y) => `x ${x}, y ${y}`,
    width: "Width k of the blend",
    units: (n) => `${n} units`,
    label: "Value as a share of the true distance",
    surface: "The point is on the surface: both are zero.",
    exact: (truth) => `The value is the distance here, ${truth}: both circles coincide.`,
    less: (value, truth) => `The value is ${value}, the surface ${truth} away: a lower bound, so a ray may still leap by it.`,
    min: "min(a, b)",
    value: "smooth minimum",
    truth: "True distance",
    added: "The seam gains at most k ÷ 4",
    pieces: "Pieces",
    quality: (outside, inside) => `Outside, the value is ${outside}; inside, ${inside}.`,
    known: { "exact distance": "a distance", "lower bound": "a lower bound" },
    story: [
      "The union of two fields is *min(a, b)*, and its seam is sharp. The *smooth minimum* takes a little more away where a and b are nearly equal: *min(a, b) − h² ÷ 4k* with *h = max(k − |a − b|, 0)*. So the shape swells along the seam, by at most a quarter of k, and two balls flow together before they touch. In a mesh, that would be a new surface; here it is one more line.",
      "It costs something. min(a, b) is the exact distance outside; the blend is less than that around the seam. Its gradient is a mean of both gradients, so it is never longer than one, and the value stays a *lower bound*: rays and offsets may use it, but not as if it were the distance.",
      "Where a and b differ by k or more, the blend equals the union exactly. The core keeps account of what a value means on each side, so an operation that needs a distance can refuse a bound.",
    ],
    attempts: [
      "Pull the balls apart until they come loose. How far apart are they, for k = 2 and for k = 4?",
      "Set k to 0 and back: where around the seam does the value stop being the distance?",
    ],
  },
  zh: {
    hint: "拖动两个球和测试点。{keys}方向键也能移动，加 Shift 走小步，Page Up 和 Page Down 走大步。",
    figure: "两个球及其融合，画出了等值线；虚线是不融合的并集",
    balls: ["球 A", "球 B"],
    probe: "测试点",
    at: (x, y) => `x ${x}，y ${y}`,
    width: "融合宽度 k",
    units: (n) => `${n} 个单位`,
    label: "值与真实距离之比",
    surface: "测试点在表面上：两者都是零。",
    exact: (truth) => `这里的值就是距离 ${truth}：两个圆重合。`,
    less: (value, truth) => `值为 ${value}，而表面离它 ${truth}：值是下界，射线仍可放心跳这么远。`,
    min: "min(a, b)",
    value: "光滑最小值",
    truth: "真实距离",
    added: "接缝处至多加厚 k ÷ 4",
    pieces: "块数",
    quality: (outside, inside) => `外部的值是${outside}，内部是${inside}。`,
    known: { "exact distance": "距离", "lower bound": "下界" },
    story: [
      "两个场的并集是 *min(a, b)*，接缝处有尖角。*光滑最小值*在 a 与 b 相近的地方再减去一点：*min(a, b) − h² ÷ 4k*，其中 *h = max(k − |a − b|, 0)*。于是接缝处鼓起来，至多鼓出 k 的四分之一；两个球还没碰上就流到了一起。换成网格，要另造一张曲面；这里只多一行。",
      "这是有代价的。在外部 min(a, b) 是精确的距离，融合后的值在接缝周围则小于距离。它的梯度是两个梯度的平均，长度从不超过一，所以值仍是*下界*：射线和偏移可以用它，只是不能把它当成距离。",
      "a 与 b 相差 k 或更多时，融合与并集完全相同。核心对内外两侧的值各是什么都记了账，需要距离的运算就能拒绝下界。",
    ],
    attempts: ["把两个球拉开，直到断开：k = 2 和 k = 4 时各能拉多远？", "把 k 调到 0 再调回来：接缝周围哪里的值不再是距离？"],
  },
};

type Page = PageOf<State, Answer, Texts>;
/** Values that differ by less than this share are treated as equal: the drawing shows no difference. */
const ALIKE = 0.01;

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill } = page;
  const [x, y] = toSvg(state.probe).map(px);
  // In pixels: x is 0 at the left edge, so a length is the x of a point that far from it.
  const radius = (value: number) => px(toSvg([Math.abs(value), 0])[0]);
  const spoken = (place: Point) => texts.at(say.fixed(place[0]), say.fixed(place[1]));
  return (
    <Flat name={texts.figure}>
      <Regions regions={answer.levels} />
      <path class="part" d={outline(answer.sharp)} />
      <circle class="truth" cx={x} cy={y} r={radius(answer.truth)} />
      <circle class="free" cx={x} cy={y} r={radius(answer.value)} />
      {(["first", "second"] as const).map((ball, i) => {
        const [cx, cy] = toSvg(state[ball]);
        return (
          <g key={ball}>
            <text class="label" x={px(cx)} y={px(cy - 22)}>
              {"AB"[i]}
            </text>
            <Dot
              name={texts.balls[i]!}
              spoken={spoken(state[ball])}
              place={state[ball]}
              isStill={isStill}
              move={(change) => set((state) => ({ [ball]: change(state[ball]) }))}
            />
          </g>
        );
      })}
      <Dot
        name={texts.probe}
        spoken={`${spoken(state.probe)}${say.marks.stop}${liveNumber(page).meaning}`}
        place={state.probe}
        isStill={isStill}
        move={(change) => set(({ probe }) => ({ probe: change(probe) }))}
      />
    </Flat>
  );
}

function liveNumber({ answer, say, texts }: Page): LiveNumber {
  const { share } = answer;
  const isExact = share === null || Math.abs(share - 1) < ALIKE;
  const [value, truth] = [say.fixed(Math.abs(answer.value)), say.fixed(Math.abs(answer.truth))];
  return {
    value: share,
    shown: share === null ? "—" : say.percent(share),
    label: texts.label,
    meaning: share === null ? texts.surface : isExact ? texts.exact(truth) : texts.less(value, truth),
    tone: isExact ? "good" : "bad",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const width = texts.units(say.number(state.width / 10));
  const rows = [
    ["min", texts.min, answer.min],
    ["value", texts.value, answer.value],
    ["truth", texts.truth, answer.truth],
    ["added", texts.added, answer.most_added],
  ] as const;
  const known = (what: string) => texts.known[what] ?? what;
  return (
    <>
      <Slider id="width" label={texts.width} shown={width} low={0} high={MOST} value={state.width} choose={(width) => set({ width })} />
      <dl>
        {rows.map(([name, label, value]) => (
          <Row key={name} name={name} label={label} value={value}>
            {say.fixed(value)}
          </Row>
        ))}
        <Row name="pieces" label={texts.pieces} value={answer.pieces}>
          {String(answer.pieces)}
        </Row>
      </dl>
      <p class="aside">
        {texts.quality(known(answer.quality.outside), known(answer.quality.inside))}
      </p>
    </>
  );
}

const place = point([0, FLAT.width], [0, FLAT.height]);

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: { probe: ["p", place], first: ["a", place], second: ["b", place], width: ["n", number(0, MOST)] },
  question: ({ first, second, width, probe }) => ({ balls: [first, second], width: width / 10, point: probe }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
