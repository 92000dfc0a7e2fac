// One polynomial through many points against a spline: if one point is moved, how far does the rest move?
import { Row, Slider } from "../view/parts";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { Flat, longPath, type Point, path, toSvg } from "./Flat";
import { number } from "./fragment";
import { Grip } from "./Grip";
import type { Language } from "./say";

interface State {
  count: number;
  /** The point that is moved, counted from the middle one. */
  row: number;
  lift: number;
}

interface Most {
  by: number;
  at: number;
}

interface Answer {
  points: [number, number][];
  curves: Record<"function" | "polynomial_before" | "polynomial" | "spline_before" | "spline", Float32Array>;
  degree: number;
  moves: { polynomial: Most; spline: Most };
  misses: { polynomial: Most; spline: Most };
}

const COUNTS = [5, 15] as const;
const LIFTS = [-1.5, 1.5] as const;
const defaults: State = { count: 11, row: 0, lift: 0.15 };
const middleOf = ({ count }: State) => (count - 1) / 2;
/** The index of the point that is moved. */
const rowOf = (state: State) => middleOf(state) + Math.min(Math.max(state.row, -middleOf(state)), middleOf(state));

interface Texts extends CommonTexts {
  figure: string;
  handle(n: number): string;
  spoken(lift: string): string;
  count: string;
  degree(n: number): string;
  label: string;
  spline: string;
  missPolynomial: string;
  missSpline: string;
  moved(lift: string, polynomial: string, spline: string): string;
  still: string;
  function: string;
  polynomial: string;
  aSpline: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "Drag any point up or down. Dashes show where both curves were.{keys} Arrow keys move it, with Shift by small steps; Page Up and Page Down by large ones.",
    figure: "Points of a bell-shaped function, a polynomial and a spline through them, and a point to move",
    handle: (n) => `Point ${n}`,
    spoken: (lift) => `moved by ${lift}`,
    count: "Points",
    degree: (n) => `degree ${n}`,
    label: "The rest of the polynomial moves by up to",
    spline: "The rest of the spline moves by up to",
    missPolynomial: "Without the move, the polynomial misses the function by",
    missSpline: "and the spline by",
    moved: (lift, polynomial, spline) => `One point was moved by ${lift}. Beyond its two neighbours the polynomial moves by up to ${polynomial}, the spline by ${spline}.`,
    still: "Nothing has been moved yet. Even so the polynomial swings between its points.",
    function: "the function",
    polynomial: "one polynomial",
    aSpline: "a spline",
    story: [
      "Through n points there is one polynomial of degree at most n − 1. If they are equally spaced, it *swings* even for a function as smooth as 1/(1 + 25x²), and more points make it worse, as Carl Runge showed in 1901. And if one point moves, *everything between* the others moves. A *spline* is made of many short cubics instead.",
      "This *spline* has a cubic between each two points, joined so that direction and bending agree. If a point moves, the next piece moves, too, and each one further off less than a third as much: in practice the change stays local. Splines that are given by control points, and chains of Bézier curves, are local without any remainder. That is why drawing programs offer degree 3 and not 20.",
    ],
    attempts: [
      "Move the middle point a little and watch both ends. Then move one at an end.",
      "Take 15 points, then 5. Which of the two curves gets better with more points?",
    ],
  },
  zh: {
    hint: "上下拖动任意一点。虚线是移动前的两条曲线。{keys}方向键移动它，加 Shift 走小步，Page Up 和 Page Down 走大步。",
    figure: "钟形函数上的点，穿过它们的一个多项式和一条样条，以及一个可移动的点",
    handle: (n) => `第 ${n} 个点`,
    spoken: (lift) => `移动了 ${lift}`,
    count: "点数",
    degree: (n) => `${n} 次`,
    label: "多项式其余部分最多移动",
    spline: "样条其余部分最多移动",
    missPolynomial: "未移动时，多项式偏离函数",
    missSpline: "样条偏离函数",
    moved: (lift, polynomial, spline) => `一个点移动了 ${lift}。在它两侧的邻点之外，多项式最多移动 ${polynomial}，样条最多移动 ${spline}。`,
    still: "还没有移动。即便如此，多项式在点与点之间也在振荡。",
    function: "原函数",
    polynomial: "一个多项式",
    aSpline: "样条",
    story: [
      "过 n 个点、次数不超过 n − 1 的多项式只有一个。点若等距分布，哪怕取自 1/(1 + 25x²) 这样温和的函数，它也会*剧烈振荡*，点越多越糟：这就是 Carl Runge 在 1901 年指出的龙格现象。而且移动一个点，其余各点*之间处处*都动。*样条*则由许多短短的三次曲线接成。",
      "这条*样条*在每两点之间是一段三次曲线，相接处方向和弯曲一致。移动一个点，邻段跟着动，往外每隔一段，变化都不到前一段的三分之一，很快就看不出来。由控制点给出的样条和贝塞尔曲线链，影响则严格限于局部。绘图软件用三次曲线而不用 20 次，原因就在这里。",
    ],
    attempts: [
      "把中间的点稍稍移动，看两端；再动一动靠边的点。",
      "取 15 个点，再取 5 个点：点越多，哪条曲线越好？",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
/** The height of 1 in the figure's units, and the position of 0. */
const [TALL, GROUND] = [1.8, 2.5] as const;
const toFigure = (x: number, y: number): Point => [6 + 5.3 * x, GROUND + TALL * y];
const within = (lift: number) => Math.round(Math.min(Math.max(lift, LIFTS[0]), LIFTS[1]) * 100) / 100;

function drawn(curve: Float32Array): string {
  return longPath(
    Array.from({ length: curve.length / 2 }, (_, i) => toSvg(toFigure(curve[2 * i]!, curve[2 * i + 1]!))),
    false,
  );
}

/** The height of a curve at one of its sample positions. */
function heightAt(curve: Float32Array, x: number): number {
  const last = curve.length / 2 - 1;
  return curve[2 * Math.round(((x + 1) / 2) * last) + 1]!;
}

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill, isSmall } = page;
  const { curves, moves } = answer;
  const swing = ["polynomial_before", "polynomial"] as const;
  const reach = swing.map((name) => toFigure(moves.polynomial.at, heightAt(curves[name], moves.polynomial.at)));
  const [unitX, unitY] = [toSvg([0, 0]), toSvg([0, 1])];
  const unit = TALL * (unitX[1] - unitY[1]);
  return (
    <Flat name={texts.figure}>
      <path class="ground" d={path([toFigure(-1.1, 0), toFigure(1.1, 0)], false)} />
      <path class="true-function" d={drawn(curves.function)} />
      {state.lift !== 0 && (
        <>
          <path class="polynomial before" d={drawn(curves.polynomial_before)} />
          <path class="spline before" d={drawn(curves.spline_before)} />
        </>
      )}
      <path class="spline" d={drawn(curves.spline)} />
      <path class="polynomial" d={drawn(curves.polynomial)} />
      {moves.polynomial.by > 0 && <path class="swing" d={path(reach, false)} />}
      {!isSmall &&
        (
          [
            ["polynomial", texts.polynomial],
            ["spline", texts.aSpline],
            ["true-function", texts.function],
          ] as const
        ).map(([kind, text], i) => (
          <g key={kind} class="key" transform={`translate(282 ${396 + 27 * i})`}>
            <path class={kind} d="M0 0H34" />
            <text x={44} y={5}>
              {text}
            </text>
          </g>
        ))}
      {answer.points.map((place, i) => {
        const isMoved = i === rowOf(state);
        const lift = isMoved ? state.lift : 0;
        const row = i - middleOf(state);
        return (
          <Grip
            key={i}
            name={texts.handle(i + 1)}
            spoken={texts.spoken(say.fixed(lift))}
            now={lift}
            low={LIFTS[0]}
            high={LIFTS[1]}
            at={toSvg(toFigure(...place))}
            {...(isMoved ? { along: 0 } : { isFaint: true })}
            reach={20}
            isStill={isStill}
            grab={() => (_, dy) => set({ row, lift: within(lift - dy / unit) })}
            step={(right, up) => {
              const far = up || right;
              // The others go back to the function.
              set((state) => ({ row, lift: within((rowOf(state) === i ? state.lift : 0) + far * (Math.abs(far) < 1 ? 0.1 : 0.05)) }));
            }}
          />
        );
      })}
    </Flat>
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  const { polynomial, spline } = answer.moves;
  return {
    value: polynomial.by,
    shown: say.number(polynomial.by),
    label: texts.label,
    meaning:
      state.lift === 0 ? texts.still : texts.moved(say.fixed(state.lift), say.number(polynomial.by), say.number(spline.by)),
    tone: polynomial.by > Math.abs(state.lift) ? "bad" : "plain",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const rows = [
    ["spline-moves", texts.spline, answer.moves.spline.by],
    ["polynomial-misses", texts.missPolynomial, answer.misses.polynomial.by],
    ["spline-misses", texts.missSpline, answer.misses.spline.by],
  ] as const;
  return (
    <>
      <Slider
        id="lift"
        label={texts.handle(rowOf(state) + 1)}
        shown={say.fixed(state.lift)}
        spoken={texts.spoken(say.fixed(state.lift))}
        low={LIFTS[0]}
        high={LIFTS[1]}
        step={0.05}
        value={state.lift}
        choose={(lift) => set({ lift: within(lift) })}
      />
      <Slider
        id="count"
        label={texts.count}
        shown={`${state.count} · ${texts.degree(answer.degree)}`}
        spoken={`${state.count}`}
        low={COUNTS[0]}
        high={COUNTS[1]}
        step={2}
        value={state.count}
        choose={(count) => set({ count })}
      />
      <dl>
        {rows.map(([name, label, value]) => (
          <Row key={name} name={name} label={label} value={value}>
            {say.number(value)}
          </Row>
        ))}
      </dl>
    </>
  );
}

/** Odd numbers, so that there is a middle point. */
const odd = number(...COUNTS);
const count = {
  write: odd.write,
  read: (text: string) => {
    const value = odd.read(text);
    return value !== undefined && value % 2 === 1 ? value : undefined;
  },
};

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: { count: ["n", count], row: ["k", number(-7, 7)], lift: ["h", number(...LIFTS, 100)] },
  question: (state) => ({ count: state.count, row: rowOf(state), lift: state.lift }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
