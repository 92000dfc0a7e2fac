// A curve as straight segments: how far off they are, and what twice as many leave of it. The lesson's short form of the widget.
import { Choice, Figure as Data, Slider } from "../view/parts";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "../exhibits/exhibit";
import { cubic, Dot, Flat, FLAT, path, type Point, toSvg } from "../exhibits/Flat";
import { number, word } from "../exhibits/fragment";
import { px } from "../exhibits/Grip";
import type { Language } from "../exhibits/say";
import { SIDE } from "../exhibits/spout";

type Four = readonly [Point, Point, Point, Point];

const HOWS = ["evenly", "fewest"] as const;

interface State {
  count: number;
  /** Which chain is drawn: that many equal steps, or the fewest segments that are proved to be within half a pixel. */
  how: (typeof HOWS)[number];
  control: Four;
}

interface Answer {
  points: Point[];
  gap: number;
  on_curve: Point;
  on_chain: Point;
  next_gap: number;
  times: number | null;
  bound: number;
  evenly: number;
  fewest: number;
  fewest_points: Point[];
}

/** Pixels of a unit in a figure of full width. */
const UNIT = 720 / FLAT.width;
/** Half a pixel: a change that an eye close to the screen no longer sees. */
const ALLOWED = 0.5 / UNIT;
const COUNTS = [1, 64] as const;
const defaults: State = { count: 6, how: "evenly", control: SIDE };

interface Texts extends CommonTexts {
  figure: string;
  handle: string;
  segments(n: string): string;
  point(i: number): string;
  at(x: string, y: string): string;
  label: string;
  meaning(twice: string, times: string): string;
  allowed: string;
  evenly: string;
  fewest: string;
  show: string;
  hows: Record<State["how"], string>;
  labelFewest: string;
  meaningFewest(evenly: string): string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "Drag the four points.{keys} Tab to one of them, then the arrow keys.",
    figure: "A curve with its four control points, and straight segments along it",
    handle: "Segments",
    segments: (n) => `${n} segments`,
    point: (i) => `Control point ${i}`,
    at: (x, y) => `${x}, ${y}`,
    label: "Largest gap, in pixels",
    meaning: (twice, times) => `Twice as many leave ${twice} px: ${times} times less.`,
    allowed: "Proved within half a pixel",
    evenly: "in equal steps",
    fewest: "where it bends",
    show: "Segments",
    hows: { evenly: "in equal steps", fewest: "where it bends" },
    labelFewest: "Segments, shorter where it bends",
    meaningFewest: (evenly) => `Proved to be within half a pixel everywhere. Equal steps take ${evenly} for that.`,
    story: [],
    attempts: [],
  },
  zh: {
    hint: "拖动四个控制点。{keys}按 Tab 选中，再按方向键移动。",
    figure: "一条曲线、它的四个控制点，以及沿曲线的折线",
    handle: "段数",
    segments: (n) => `${n} 段`,
    point: (i) => `控制点 ${i}`,
    at: (x, y) => `${x}，${y}`,
    label: "最大弦高误差（像素）",
    meaning: (twice, times) => `段数翻一番，只剩 ${twice} 像素：是现在的 1/${times}。`,
    allowed: "证明不超过半个像素",
    evenly: "参数等分",
    fewest: "弯处加密",
    show: "线段",
    hows: { evenly: "参数等分", fewest: "弯处加密" },
    labelFewest: "线段数，弯处加密",
    meaningFewest: (evenly) => `已证明处处不超过半个像素。参数等分要 ${evenly} 段才行。`,
    story: [],
    attempts: [],
  },
};

type Page = PageOf<State, Answer, Texts>;

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill } = page;
  const [x, y] = toSvg(answer.on_curve);
  const points = state.how === "evenly" ? answer.points : answer.fewest_points;
  return (
    <Flat name={texts.figure}>
      <path class="leg" d={path(state.control, false)} />
      <path class="true-curve" d={cubic(state.control)} />
      <path class="segments-of" d={path(points, false)} />
      {points.length <= 40 &&
        points.map((point, i) => {
          const [cx, cy] = toSvg(point);
          return <circle key={i} class="joint-of" cx={px(cx)} cy={px(cy)} r={3} />;
        })}
      {state.how === "evenly" && (
        <>
          <path class="gap-of" d={path([answer.on_curve, answer.on_chain], false)} />
          <circle class="gap-at" cx={px(x)} cy={px(y)} r={11} />
        </>
      )}
      {state.control.map((place, i) => (
        <Dot
          key={i}
          name={texts.point(i)}
          spoken={texts.at(say.number(place[0]), say.number(place[1]))}
          place={place}
          isStill={isStill}
          move={(change) =>
            set(({ control }) => ({ control: control.map((point, k) => (k === i ? change(point) : point)) as unknown as Four }))
          }
        />
      ))}
    </Flat>
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  if (state.how === "fewest")
    return {
      value: answer.fewest,
      shown: say.whole(answer.fewest),
      label: texts.labelFewest,
      meaning: texts.meaningFewest(say.whole(answer.evenly)),
      tone: "good",
    };
  const pixels = answer.gap * UNIT;
  return {
    value: pixels,
    shown: `${say.number(pixels)} px`,
    label: texts.label,
    meaning: texts.meaning(say.number(answer.next_gap * UNIT), answer.times === null ? "–" : say.fixed(answer.times, 1)),
    tone: answer.gap <= ALLOWED ? "good" : "bad",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  return (
    <>
      <Slider
        id="count"
        label={texts.handle}
        shown={String(state.count)}
        spoken={texts.segments(String(state.count))}
        low={COUNTS[0]}
        high={COUNTS[1]}
        value={state.count}
        choose={(count) => set({ count, how: "evenly" })}
      />
      <Choice
        name="how"
        legend={texts.show}
        value={state.how}
        options={HOWS.map((how) => ({ value: how, label: texts.hows[how] }))}
        choose={(how) => set({ how })}
      />
      <dl>
        {(["evenly", "fewest"] as const).map((how) => (
          <div key={how}>
            <dt>
              {[texts.allowed, texts[how]].join(say.marks.comma)}
            </dt>
            <dd>
              <Data name={how} value={answer[how]}>
                {say.whole(answer[how])}
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
  parts: { count: ["n", number(...COUNTS)], how: ["h", word(...HOWS)] },
  question: ({ count, control }) => ({ control, count, length: ALLOWED }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
