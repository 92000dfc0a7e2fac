// Sphere tracing, step by step: the value is the distance that a ray may safely advance.
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { Row, Slider } from "../view/parts";
import { type Picture, type View, fieldProgram, rampStops } from "../viewer";
import { Chart, chain } from "./Chart";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { Dot, FLAT, Flat, type Point, path, toSvg } from "./Flat";
import { number, point } from "./fragment";
import { px } from "./Grip";
import { PAINT } from "./paint";
import { type Loops, type Region, Regions, outline } from "./Regions";
import type { Language } from "./say";
import { Scene } from "./Scene";

type Part = "ball" | "wall" | "bar";
const PARTS: readonly Part[] = ["ball", "wall", "bar"];

interface State extends Record<Part, Point> {
  aim: Point;
  shown: number;
}

interface Answer {
  levels: Region[];
  outline: Loops;
  eye: Point;
  close: number;
  steps: { at: Point; t: number; value: number }[];
  end: "arrived" | "passed" | "stopped";
  fan: [deg: number, steps: number][];
  /** A scene in space, as a program for the graphics card. */
  shader: string;
}

/** With more circles than this, the last ones are too small to distinguish. */
const MOST = 40;
const defaults: State = { aim: [8.6, 3.3], ball: [6.1, 6], wall: [10.3, 4], bar: [5.5, 2.05], shown: 4 };

interface Texts extends CommonTexts {
  figure: string;
  aim: string;
  parts: Record<Part, string>;
  at(x: string, y: string): string;
  shown: string;
  steps(n: number): string;
  label: string;
  end: Record<Answer["end"], string>;
  after(n: number, left: string): string;
  left: string;
  gone: string;
  fan: string;
  fanX: string;
  fanY: string;
  space: string;
  spaceSays: string;
  scale: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "Drag the point through which the ray goes, and the three shapes. The slider takes the steps one by one.{keys} Arrow keys move them, too.",
    figure: "A ray from an eye among three shapes, and the free circle at every step",
    aim: "The ray goes through",
    parts: { ball: "Ball", wall: "Wall", bar: "Bar" },
    at: (x, y) => `x ${x}, y ${y}`,
    shown: "Steps shown",
    steps: (n) => `${n} steps`,
    label: "Steps of this ray",
    end: { arrived: "It arrives.", passed: "It passes by and leaves.", stopped: "It is stopped." },
    after: (n, left) => `After step ${n} the nearest surface is ${left} away.`,
    left: "Distance to the nearest surface",
    gone: "Way along the ray",
    fan: "Steps by the direction of the ray",
    fanX: "degrees upward",
    fanY: "steps",
    space: "The same in space: one ray for every pixel",
    spaceSays: "Your graphics card traces this picture anew while you turn it. The lighter a pixel, the more steps its ray took: outlines glow.",
    scale: "steps, from 1 to 120 and more",
    story: [
      "The value of a distance field is *a safe step*: the circle of that radius contains no surface. So the ray leaps to its rim without a check, evaluates the field again there, and leaps again. *A ray that grazes* a surface stays close to it for long, and close means short steps: most of the time is spent along outlines.",
      "No triangle is tested, and nothing is sorted. The value may also be less than the distance, as it is inside a boolean: the leaps are shorter, and still no surface is skipped. Too large a value would miss thin parts.",
      "The core’s own tracer also knows how fast the value changes, and brackets each hit between a point outside and one inside. This page shows the plain method, step by step.",
    ],
    attempts: [
      "Aim just above the bar, so that the ray slides along it: how many steps now?",
      "Aim into the gap between ball and bar, and take its steps one by one.",
    ],
  },
  zh: {
    hint: "拖动射线经过的点和三个形状；用滑块逐步查看。{keys}也可用方向键移动。",
    figure: "从眼睛射出、穿过三个形状之间的射线，以及每一步的空圆",
    aim: "射线经过的点",
    parts: { ball: "圆盘", wall: "墙", bar: "横杆" },
    at: (x, y) => `x ${x}，y ${y}`,
    shown: "显示的步数",
    steps: (n) => `${n} 步`,
    label: "这条射线的步数",
    end: { arrived: "到达表面。", passed: "从旁经过，离开画面。", stopped: "被中止。" },
    after: (n, left) => `第 ${n} 步之后，最近的表面还有 ${left}。`,
    left: "到最近表面的距离",
    gone: "沿射线走过的路程",
    fan: "步数随射线方向的变化",
    fanX: "仰角（度）",
    fanY: "步数",
    space: "空间中也一样：每个像素一条射线",
    spaceSays: "转动时，这幅画面由你的显卡实时追踪。像素越亮，它的射线走的步数越多：发亮的正是轮廓。",
    scale: "步数：从 1 到 120 及以上",
    story: [
      "距离场的值就是*一步安全的步长*：以它为半径的圆内没有表面。所以射线可以直接跳到圆周，在那里再问一次，再跳。*掠过*表面的射线长时间贴近它，贴近就意味着步子短：时间都花在每一条轮廓线上。",
      "不必问任何三角形，也不必排序。值也可以小于距离，例如布尔运算的内部：步子变短，但不会跳过任何东西。值若偏大，就会漏掉薄的部分。",
      "核心自己的追踪器还知道值变化的快慢，并把每个交点夹在外部一点与内部一点之间。这里展示的是朴素的方法，一步一步，便于观察。",
    ],
    attempts: [
      "对准横杆上方一点，让射线贴着它滑过：现在要多少步？",
      "对准圆盘与横杆之间的空隙，一步一步地看。",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
const last = ({ state, answer }: Page) => Math.min(state.shown, answer.steps.length) - 1;

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill } = page;
  const { steps, eye } = answer;
  const n = last(page);
  const far = steps.at(-1)!.at;
  const place = texts.at(say.fixed(state.aim[0]), say.fixed(state.aim[1]));
  return (
    <Flat name={texts.figure}>
      <Regions regions={answer.levels} />
      <path class="solid" d={outline(answer.outline)} />
      <path class="sight" d={path([eye, far], false)} />
      {steps.slice(0, n + 1).map(({ at, value }, i) => {
        const [x, y] = toSvg(at).map(px);
        return (
          <g key={i} class={`step ${i === n ? "now" : ""}`}>
            <circle class="free" cx={x} cy={y} r={px(toSvg([Math.max(value, 0), 0])[0])} />
            <circle class="stop" cx={x} cy={y} r="3.5" />
          </g>
        );
      })}
      <path class="walked" d={path([eye, steps[n]!.at], false)} />
      {PARTS.map((part) => (
        <Dot
          key={part}
          name={texts.parts[part]}
          spoken={texts.at(say.fixed(state[part][0]), say.fixed(state[part][1]))}
          place={state[part]}
          isStill={isStill}
          isFaint
          move={(change) => set((state) => ({ [part]: inFrontOf(change(state[part]), [eye[0] + ROOM, eye[1]]) }))}
        />
      ))}
      <Dot
        name={texts.aim}
        spoken={[place, texts.steps(steps.length), texts.end[answer.end]].join(say.marks.stop)}
        place={state.aim}
        isStill={isStill}
        move={(change) => set(({ aim }) => ({ aim: inFrontOf(change(aim), eye) }))}
      />
    </Flat>
  );
}

/** The eye stays outside of the shapes. */
const ROOM = 2.2;

/** Keeps the point in front of the eye, so that the ray has a direction. */
const inFrontOf = ([x, y]: Point, eye: Point): Point => [Math.max(x, Math.round((eye[0] + 0.6) * 100) / 100), y];

const HOME: View = { azimuth: -62, elevation: 24, distance: 8.5, target: [0, 0, 0] };

/** The scene in space. Without script, on paper and without WebGL 2 it is left out. */
function Space({ shader, texts }: { shader: string; texts: Texts }) {
  const [view, setView] = useState(HOME);
  const [isPossible, setPossible] = useState(true);
  // The viewer is large: it is loaded when the reader comes here.
  const [isNear, setNear] = useState(false);
  const root = useRef<HTMLElement>(null);
  useEffect(() => {
    const observer = new IntersectionObserver((entries) => {
      if (!entries.some((entry) => entry.isIntersecting)) return;
      observer.disconnect();
      const gl = document.createElement("canvas").getContext("webgl2");
      // A browser allows few contexts at once.
      gl?.getExtension("WEBGL_lose_context")?.loseContext();
      if (gl) setNear(true);
      else setPossible(false);
    });
    observer.observe(root.current!);
    return () => observer.disconnect();
  }, []);
  const fail = useRef((isDrawn: boolean) => setPossible(isDrawn));
  const picture = useMemo<Picture>(
    () => ({ layers: [{ kind: "field", id: "space", program: fieldProgram(shader), paint: PAINT.front, light: "steps", drawn: fail.current }] }),
    [shader],
  );
  return (
    <figure class="in-space" hidden={!isPossible} ref={root}>
      <figcaption id="space-hint">
        <b>{texts.space}</b> {texts.spaceSays}
      </figcaption>
      {!isNear && <div class="scene" />}
      {isNear && <Scene name={texts.space} help="space-hint" picture={picture} view={view} home={HOME} look={setView} isStill={false} />}
      <svg class="ramp-scale" viewBox="0 0 80 6" preserveAspectRatio="none" aria-hidden="true">
        {rampStops("heat").map((color, i) => (
          <rect key={i} x={10 * i} width={10.2} height={6} fill={color} />
        ))}
      </svg>
      <p class="aside">{texts.scale}</p>
    </figure>
  );
}

function liveNumber(page: Page): LiveNumber {
  const { answer, texts, say } = page;
  const n = last(page);
  const count = answer.steps.length;
  return {
    value: count,
    shown: String(count),
    label: texts.label,
    meaning: `${texts.end[answer.end]}${say.marks.gap}${texts.after(n + 1, say.number(Math.max(answer.steps[n]!.value, 0)))}`,
    tone: answer.end === "arrived" ? "good" : "plain",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  // After the first rendering, which has to equal the page as it was built.
  const [isLive, setLive] = useState(false);
  useEffect(() => setLive(!page.isStill), []);
  // The same element while a ray is dragged, so that the scene is not traced again.
  const space = useMemo(() => isLive && <Space shader={answer.shader} texts={texts} />, [isLive, answer.shader, texts]);
  const n = last(page);
  const step = answer.steps[n]!;
  const deg = (Math.atan2(state.aim[1] - answer.eye[1], state.aim[0] - answer.eye[0]) * 180) / Math.PI;
  const most = Math.max(...answer.fan.map(([, steps]) => steps));
  const low = answer.fan[0]![0];
  const high = answer.fan.at(-1)![0];
  return (
    <>
      <Slider
        id="steps"
        label={texts.shown}
        shown={String(n + 1)}
        spoken={texts.after(n + 1, say.number(step.value))}
        low={1}
        high={MOST}
        value={state.shown}
        choose={(shown) => set({ shown })}
      />
      <dl>
        <Row name="left" label={texts.left} value={step.value}>
          {say.number(step.value)}
        </Row>
        <Row name="gone" label={texts.gone} value={step.t}>
          {say.fixed(step.t)}
        </Row>
      </dl>
      <Chart
        name={texts.fan}
        x={{ low, high, label: texts.fanX, ticks: [-40, -20, 0, 20, 40].map((x) => [x, say.fixed(x, 0)]) }}
        y={{ low: 0, high: most, label: texts.fanY, ticks: [0, 20, 40, 60].filter((y) => y <= most).map((y) => [y, String(y)]) }}
      >
        {(at) => (
          <>
            <path class="drawn" d={chain(at, answer.fan)} />
            {deg >= low && deg <= high && <path class="goal" d={chain(at, [[deg, 0], [deg, most]])} />}
          </>
        )}
      </Chart>
      {space}
    </>
  );
}

const PLACE = point([3, FLAT.width], [0, FLAT.height]);

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: { aim: ["p", point([1.5, FLAT.width], [0, FLAT.height])], shown: ["n", number(1, MOST)], ball: ["a", PLACE], wall: ["b", PLACE], bar: ["c", PLACE] },
  question: ({ aim, ball, wall, bar }) => ({ aim, parts: [ball, wall, bar] }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
