// Two cubics that meet: the effect of C0, C1 and C2 when the first one is bent, on the curvature comb and on a reflection.
import { Choice, Row } from "../view/parts";
import { type Grey, bitmap } from "./bitmap";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { Dot, Flat, type Point, at, cubic, path, toSvg } from "./Flat";
import { point, points, word } from "./fragment";
import { Grip, px } from "./Grip";
import type { Language } from "./say";

type Four = readonly [Point, Point, Point, Point];
type Class = "C0" | "C1" | "C2";

interface State {
  keep: Class;
  leg: Point;
  /** The other control points inside: of the first curve, and two of the second, which its class may overrule. */
  others: readonly Point[];
}

interface Tooth {
  on_curve: Point;
  tip: Point;
  curvature: number;
}

interface Answer {
  second: Four;
  class: 0 | 1 | 2 | null;
  geometric: number | null;
  angle_deg: number | null;
  curvatures: [number | null, number | null];
  curvature_gap: number | null;
  combs: [Tooth[], Tooth[]];
  stripes: Grey;
}

const CLASSES: readonly Class[] = ["C0", "C1", "C2"];
/** The position of the leg for which the join is C2. */
const HOME: Point = [4.4, 2.6];
const XS = [3.6, 5.2] as const;
const YS = [2, 3.2] as const;
const JOINT: Point = [6, 2.6];
/** Chosen so that the curves join with C2 if the first one's leg is at `HOME`. */
const OTHERS: readonly Point[] = [
  [2.2, 1.4],
  [7.6, 2.6],
  [8.6, 1.4],
];
/** The ends stay, since the picture above reaches from one to the other. */
const firstOf = ({ leg, others }: State): Four => [[0.8, 0.7], others[0]!, leg, JOINT];
const secondOf = ({ others }: State): Four => [JOINT, others[1]!, others[2]!, [11.2, 0.7]];
/** Where the others can be: right of the start, left of the end, below the picture. */
const OTHER_XS = [1, 11] as const;
const OTHER_YS = [0.4, 3.4] as const;
const COMB = 2.4;
const defaults: State = { keep: "C1", leg: [4.2, 2.95], others: OTHERS };

interface Texts extends CommonTexts {
  figure: string;
  handle: string;
  other(name: string): string;
  at(x: string, y: string): string;
  keep: string;
  keeps: Record<Class, string>;
  label: string;
  angle: string;
  gap: string;
  before: string;
  after: string;
  kink(angle: string): string;
  jump(before: string, after: string): string;
  smooth: string;
  back: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "Drag the end of the control arm, or another control point.{keys} Arrow keys move them, with Shift by small steps.",
    figure: "Two curves that meet, with combs of their curvature; above them the stripes that a surface swept from them reflects",
    handle: "End of the first curve’s control arm",
    other: (name) => `Control point ${name}`,
    at: (x, y) => `x ${x}, y ${y}`,
    keep: "The second curve keeps",
    keeps: { C0: "C0: its start", C1: "C1: direction and speed, too", C2: "C2: bending, too" },
    label: "The join",
    angle: "Kink",
    gap: "Jump of the curvature vector",
    before: "Curvature before",
    after: "Curvature after",
    kink: (angle) => `Only the position agrees. The direction turns by ${angle}: a kink, and the stripes break off.`,
    jump: (before, after) => `Direction and speed agree, so no kink shows. But the curvature jumps from ${before} to ${after}: the comb has a step, and the stripes a kink.`,
    smooth: "Position, direction, speed and bending agree: comb and stripes continue smoothly.",
    back: "Move the control arm back to where everything agrees",
    story: [
      "*C0*: one curve begins where the other ends. *C1*: direction and speed agree as well. *C2*: so do the second derivatives, and with them the bending. The eye misses a jump of curvature; the *comb*, whose teeth are as long as the curvature is large, shows it. So does a mirror: a surface that is only C1 *reflects stripes with kinks*. For a mirror the shape alone counts: equal direction and equal curvature (*G2*) are enough, at whatever speeds.",
      "A reflection depends on the normal, and that on the first derivatives: so it is one degree less smooth than the surface, and shows the second ones. Car bodies are judged by reflections. On a path that is only C1 a camera’s acceleration jumps: here the speeds do count, and it takes C2.",
      "Bend the first curve, and the second one has to follow: for C0 not at all, for C1 with its first control arm, for C2 with two points. Each degree of smoothness costs freedom.",
    ],
    attempts: [
      "Choose C0 and move the handle: the class falls to C0, with an angle. Look at the stripes above the join.",
      "Choose C2: you cannot break it. Watch how the second curve follows.",
    ],
  },
  zh: {
    hint: "拖动控制柄的端点或其他控制点。{keys}方向键移动，加 Shift 走小步。",
    figure: "两条相接的曲线和它们的曲率梳，上方是由曲线扫掠成的曲面所映出的斑马纹",
    handle: "第一条曲线控制柄的端点",
    other: (name) => `控制点 ${name}`,
    at: (x, y) => `x ${x}，y ${y}`,
    keep: "第二条曲线保持",
    keeps: { C0: "C0：起点", C1: "C1：还有方向与速度", C2: "C2：还有弯曲" },
    label: "拼接点的连续性",
    angle: "切线夹角",
    gap: "曲率向量的突变",
    before: "拼接点前的曲率",
    after: "拼接点后的曲率",
    kink: (angle) => `只有位置相同，方向转了 ${angle}：有折角，条纹在此错断。`,
    jump: (before, after) => `方向和速度相同，看不出折角；但曲率从 ${before} 突变到 ${after}：曲率梳有台阶，条纹有折点。`,
    smooth: "位置、方向、速度和弯曲都一致：曲率梳和条纹连续通过。",
    back: "控制柄复位",
    story: [
      "*C0*：后一段从前一段的终点开始。*C1*：方向与速度也相同。*C2*：二阶导数也相同，弯曲随之一致。曲率突变，眼睛看不出来；*曲率梳*的梳齿长度正比于曲率，一看便知。镜面也瞒不过：只有 C1 的曲面*映出的条纹有折点*。镜面只看形状：方向和曲率相同（*G2*）就够了，速度不必相同。",
      "反射取决于法线，法线由一阶导数决定，所以反射比曲面低一阶光滑，二阶导数的突变逃不过它：车身就是这样检验的。镜头沿只有 C1 的路径移动，加速度会突变；这时速度也算数，要 C2 才行。",
      "第一条曲线弯了，第二条就要让步：C0 不用让，C1 让出第一个控制柄，C2 让出两个点。保持得越多，自由越少。",
    ],
    attempts: [
      "选 C0，移动控制柄：连续性降到 C0，出现折角。看拼接点上方的条纹。",
      "选 C2：怎么拖都破坏不了。看第二条曲线怎样跟着移动。",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
const within = (value: number, [low, high]: readonly [number, number]) =>
  Math.round(Math.min(Math.max(value, low), high) * 100) / 100;
const kept = ([x, y]: Point): Point => [within(x, XS), within(y, YS)];
/** The others that can be moved: those that the class of the join does not place. */
const freeOf = ({ keep }: State) => ({ C0: [0, 1, 2], C1: [0, 2], C2: [0] })[keep];

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill, isSmall } = page;
  const first = firstOf(state);
  const { second } = answer;
  const [left, top] = toSvg([first[0][0], 7.7]);
  const [right] = toSvg([second[3][0], 0]);
  const [jointX, jointY] = toSvg(JOINT);
  const width = right - left;
  const height = (width * answer.stripes.height) / answer.stripes.width;
  return (
    <Flat name={texts.figure}>
      <image
        href={bitmap(answer.stripes)}
        x={px(left)}
        y={px(top)}
        width={px(width)}
        height={px(height)}
        preserveAspectRatio="none"
      />
      <path class="frame" d={`M${px(left)} ${px(top)}h${px(width)}v${px(height)}h${px(-width)}z`} />
      <path class="below" d={`M${px(jointX)} ${px(top)}V${px(jointY)}`} />
      {answer.combs.map((teeth, i) => (
        <g key={i} class="comb">
          <path class="area" d={path([...teeth.map((tooth) => tooth.on_curve), ...teeth.map((tooth) => tooth.tip).reverse()])} />
          <path class="teeth" d={teeth.map((tooth) => path([tooth.on_curve, tooth.tip], false)).join("")} />
          <path class="tips" d={path(teeth.map((tooth) => tooth.tip), false)} />
        </g>
      ))}
      <path class="leg" d={path(first, false)} />
      <path class="leg" d={path(second, false)} />
      <path class="joined" d={cubic(first)} />
      <path class="joined second" d={cubic(second)} />
      {[first[1], second[1], second[2]].map((control, i) => {
        const [x, y] = toSvg(control);
        return <circle key={i} class="mark" cx={px(x)} cy={px(y)} r={3.6} />;
      })}
      <circle class="joint" cx={px(jointX)} cy={px(jointY)} r={6} />
      {!isSmall && <path class="target" d={`M${at(HOME)}m-7 0h14m-7 -7v14`} />}
      <Grip
        name={texts.handle}
        spoken={texts.at(say.fixed(state.leg[0]), say.fixed(state.leg[1]))}
        now={state.leg[1]}
        low={YS[0]}
        high={YS[1]}
        at={toSvg(state.leg)}
        isStill={isStill}
        grab={() => {
          const [x, y] = state.leg;
          const [ux, uy] = toSvg([1, 0]).map((end, k) => end - toSvg([0, 0])[k]!) as [number, number];
          const scale = Math.hypot(ux, uy);
          return (dx, dy) => set({ leg: kept([x + dx / scale, y - dy / scale]) });
        }}
        step={(dx, dy) =>
          set(({ leg: [x, y] }) => ({ leg: kept([x + dx * 0.05, Math.abs(dy) === Infinity ? y : y + dy * 0.05]) }))
        }
      />
      {freeOf(state).map((i) => (
        <Dot
          key={i}
          name={texts.other(["P₁", "Q₁", "Q₂"][i]!)}
          spoken={texts.at(say.fixed(state.others[i]![0]), say.fixed(state.others[i]![1]))}
          place={state.others[i]!}
          isStill={isStill}
          isFaint
          reach={20}
          move={(change) =>
            set(({ others }) => {
              const [x, y] = change(others[i]!);
              return { others: others.map((old, k) => (k === i ? [within(x, OTHER_XS), within(y, OTHER_YS)] : old)) };
            })
          }
        />
      ))}
    </Flat>
  );
}

function liveNumber({ answer, say, texts }: Page): LiveNumber {
  const angle = say.degrees(answer.angle_deg ?? 0);
  const gap = say.fixed(answer.curvature_gap ?? 0);
  const [before, after] = answer.curvatures.map((curvature) => say.fixed(curvature ?? 0)) as [string, string];
  const told = {
    0: { shown: `C0 · ${angle}`, meaning: texts.kink(angle), tone: "bad" },
    1: { shown: `C1 · Δκ ${gap}`, meaning: texts.jump(before, after), tone: "plain" },
    2: { shown: "C2", meaning: texts.smooth, tone: "good" },
  } as const;
  return { value: answer.class, label: texts.label, ...told[answer.class ?? 0] };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const rows = [
    ["angle", texts.angle, answer.angle_deg, say.degrees(answer.angle_deg ?? 0)],
    ["curvature-before", texts.before, answer.curvatures[0], say.fixed(answer.curvatures[0] ?? 0, 3)],
    ["curvature-after", texts.after, answer.curvatures[1], say.fixed(answer.curvatures[1] ?? 0, 3)],
    ["curvature-gap", texts.gap, answer.curvature_gap, say.fixed(answer.curvature_gap ?? 0, 3)],
  ] as const;
  return (
    <>
      <Choice
        name="keep"
        class="stacked"
        legend={texts.keep}
        value={state.keep}
        options={CLASSES.map((value) => ({ value, label: texts.keeps[value] }))}
        choose={(keep) => set({ keep })}
      />
      <div class="buttons">
        <button type="button" onClick={() => set({ leg: HOME, others: OTHERS })}>
          {texts.back}
        </button>
      </div>
      <dl>
        {rows.map(([name, label, value, shown]) => (
          <Row key={name} name={name} label={label} value={value}>
            {shown}
          </Row>
        ))}
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: { keep: ["c", word(...CLASSES)], leg: ["p", point(XS, YS)], others: ["k", points<Point>(3, 3, [OTHER_XS, OTHER_YS])] },
  question: (state) => ({ first: firstOf(state), second: secondOf(state), keep: state.keep, scale: COMB }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
