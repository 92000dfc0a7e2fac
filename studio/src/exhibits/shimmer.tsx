// Triangles smaller than a pixel shimmer while they turn: one frame, the next one, and the pixels that change between them.
import { useEffect, useRef, useState } from "preact/hooks";
import { Choice, Row, Slider } from "../view/parts";
import { type Grey, bitmap } from "./bitmap";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { Flat, toSvg } from "./Flat";
import { flag, number } from "./fragment";
import { Grip, px } from "./Grip";
import type { Language } from "./say";

interface State {
  /** An index into the sizes of triangles, from the finest. */
  size: number;
  frame: number;
  /** Whether the pixels that change are marked. */
  marked: boolean;
}

interface Answer {
  width: number;
  height: number;
  frames: [Uint32Array, Uint32Array];
  changed: Uint32Array;
  flickering: number;
  covered: number;
  rms: number;
  triangles: number;
  missed: number;
  side: number;
  /** The mean number of flickering pixels of each size. */
  all: number[];
}

/** The names of the sizes; their sides are the core's. */
const SIZES = [0.25, 1, 2, 4] as const;
const LAST = 120;
const defaults: State = { size: 0, frame: 60, marked: true };

interface Texts extends CommonTexts {
  figure: string;
  now: string;
  next: string;
  size: string;
  pixels(n: string): string;
  turn: string;
  frame(n: number): string;
  marked: string;
  play: string;
  stop: string;
  label: string;
  meaning(share: string, mean: string): string;
  rms: string;
  triangles: string;
  missed: string;
  all: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "Drag the handle below the pictures to turn the relief, or let it turn. Each square is one pixel.",
    figure: "A relief drawn with one sample for each pixel: this frame, and the next one half a degree later",
    now: "this frame",
    next: "the next one",
    size: "Side of a triangle",
    pixels: (n) => `${n} px`,
    turn: "Turn",
    frame: (n) => `frame ${n}`,
    marked: "mark the pixels that flicker",
    play: "Let it turn",
    stop: "Stop",
    label: "Pixels that flicker in this frame",
    meaning: (share, mean) => `${share} of those that are covered; ${mean} in the mean of all frames. The relief has turned by half a degree.`,
    rms: "Noise below the pixel",
    triangles: "Triangles",
    missed: "Triangles that no pixel sees",
    all: "Flickering pixels by the size of triangles",
    story: [
      "A pixel takes *one sample*, at its centre. If a triangle is smaller than a pixel, the sample picks one of many, and after the smallest turn another one. The picture *aliases*: it shows a pattern that is not in the shape, and that pattern *shimmers* while the shape turns. More triangles make it worse.",
      "All sizes show the same relief. It has ripples a pixel wide; the finest mesh has triangles of a quarter of a pixel, the others are that mesh, simplified by the core. Triangles of four pixels have no ripples left, so neighbouring frames look alike. The mesh that fits the pixels is the better picture, and three hundred times cheaper.",
      "A pixel counts as flickering if its shade changes by more than a tenth from black to white. The noise is measured separately: sixteen pictures, each moved by less than a pixel, and the mean difference between them.",
    ],
    attempts: [
      "Take triangles of ¼ pixel and let it turn; then those of 4 pixels.",
      "From which size on does hardly a pixel flicker?",
    ],
  },
  zh: {
    hint: "拖动图下的手柄转动浮雕，或者让它自己转。每个小方格是一个像素。",
    figure: "每个像素只采样一次画出的浮雕：这一帧，以及转过半度的下一帧",
    now: "这一帧",
    next: "下一帧",
    size: "三角形边长",
    pixels: (n) => `${n} 像素`,
    turn: "转动",
    frame: (n) => `第 ${n} 帧`,
    marked: "标出闪烁的像素",
    play: "自动转动",
    stop: "停止",
    label: "这一帧里闪烁的像素",
    meaning: (share, mean) => `占被覆盖像素的 ${share}；各帧平均 ${mean} 个。浮雕只转了半度。`,
    rms: "像素以下的噪声",
    triangles: "三角形数",
    missed: "没有像素看到的三角形",
    all: "闪烁像素数与三角形大小",
    story: [
      "每个像素只在中心采*一个样本*。三角形比像素还小时，样本就从许多个里碰上一个，稍微一转，又碰上另一个。画面出现*走样*：显示出形状里没有的花纹，而且一转动就*闪烁*。三角形越多，闪得越厉害。",
      "四种大小画的是同一块浮雕，上面有一个像素宽的细纹。最细的网格，三角形边长四分之一像素；其余的由核心从它简化而来。四像素的三角形里没有细纹，相邻两帧几乎一样。与像素相称的网格，画面更好，代价只有三百分之一。",
      "明暗变化超过黑白之差的十分之一，就算这个像素在闪烁。噪声另外测量：画十六幅图，每幅平移不到一个像素，再求它们之间的平均差别。",
    ],
    attempts: ["选 ¼ 像素的三角形，让它转；再换成 4 像素。", "从多大的三角形起，几乎没有像素闪烁？"],
  },
};

type Page = PageOf<State, Answer, Texts>;

/** Both pictures, and the track below them, in units of the figure. */
const SIDE = 5.5;
const PLACES = [0.3, 6.2] as const;
const TOP = 7.3;
const TRACK = { from: 1, to: 11, y: 0.72 } as const;

/** The pictures of an answer, which is rendered again on every change of the page. */
const pictures = new WeakMap<Answer, [Grey, Grey]>();
function picturesOf(answer: Answer): [Grey, Grey] {
  let made = pictures.get(answer);
  if (!made) {
    const { width, height } = answer;
    made = answer.frames.map((grey) => ({ width, height, grey })) as [Grey, Grey];
    pictures.set(answer, made);
  }
  return made;
}

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, set, isStill } = page;
  const { width, height, changed } = answer;
  const wide = toSvg([SIDE, 0])[0];
  const unit = wide / width;
  let marks = "";
  const corners = PLACES.map((x) => toSvg([x, TOP]));
  changed.forEach((is, row) => {
    if (!is) return;
    for (const [x, y] of corners) {
      marks += `M${px(x + unit * (row % width))} ${px(y + unit * Math.floor(row / width))}h${px(unit)}v${px(unit)}h${px(-unit)}z`;
    }
  });
  const place = TRACK.from + ((TRACK.to - TRACK.from) * state.frame) / LAST;
  const [from, to] = [TRACK.from, TRACK.to].map((x) => toSvg([x, TRACK.y]).map(px).join(" "));
  const move = (change: (frame: number) => number) =>
    set(({ frame }) => ({ frame: Math.round(Math.min(Math.max(change(frame), 0), LAST)) }));
  const perFrame = (toSvg([TRACK.to, 0])[0] - toSvg([TRACK.from, 0])[0]) / LAST;
  return (
    <Flat name={texts.figure}>
      {picturesOf(answer).map((picture, i) => (
        <image
          key={i}
          class="pixelated"
          href={bitmap(picture)}
          x={px(corners[i]![0])}
          y={px(corners[i]![1])}
          width={px(wide)}
          height={px((wide * height) / width)}
        />
      ))}
      {corners.map(([x, y], i) => (
        <g key={i}>
          <path class="frame" d={`M${px(x)} ${px(y)}h${px(wide)}v${px((wide * height) / width)}h${px(-wide)}z`} />
          <text class="label" x={px(x + wide / 2)} y={px(y - 12)}>
            {i ? texts.next : texts.now}
          </text>
        </g>
      ))}
      {state.marked && <path class="flickers" d={marks} />}
      <path class="track" d={`M${from}L${to}`} />
      <path class="track ends" d={`M${from}m0-6v12M${to}m0-6v12`} />
      <Grip
        name={texts.turn}
        spoken={texts.frame(state.frame)}
        now={state.frame}
        low={0}
        high={LAST}
        at={toSvg([place, TRACK.y])}
        isStill={isStill}
        along={90}
        grab={() => {
          const start = state.frame;
          return (dx) => move(() => start + dx / perFrame);
        }}
        step={(right, up) => move((frame) => frame + (right || up))}
      />
    </Flat>
  );
}

function liveNumber({ answer, say, texts, state }: Page): LiveNumber {
  const share = answer.flickering / answer.covered;
  return {
    value: answer.flickering,
    shown: say.whole(answer.flickering),
    label: texts.label,
    meaning: texts.meaning(say.percent(share), say.whole(answer.all[state.size]!)),
    tone: share > 0.05 ? "bad" : share < 0.01 ? "good" : "plain",
  };
}

/** Frames of the film a second. */
const PER_SECOND = 8;

/** Turns it to and fro until it is stopped; readers who want less motion have no button for it. */
function Film({ page }: { page: Page }) {
  const { texts, set } = page;
  const [isPlaying, play] = useState(false);
  const way = useRef(1);
  useEffect(() => {
    if (!isPlaying) return;
    const timer = setInterval(
      () =>
        set(({ frame }) => {
          if (frame >= LAST) way.current = -1;
          if (frame <= 0) way.current = 1;
          return { frame: frame + way.current };
        }),
      1000 / PER_SECOND,
    );
    return () => clearInterval(timer);
  }, [isPlaying]);
  return (
    <p class="buttons moving">
      <button type="button" aria-pressed={isPlaying} onClick={() => play(!isPlaying)}>
        {isPlaying ? texts.stop : texts.play}
      </button>
    </p>
  );
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  return (
    <>
      <Choice
        name="size"
        legend={texts.size}
        value={state.size}
        options={SIZES.map((side, value) => ({ value, label: texts.pixels(say.number(side)) }))}
        choose={(size) => set({ size })}
      />
      <Slider
        id="frame"
        label={texts.turn}
        shown={String(state.frame)}
        spoken={texts.frame(state.frame)}
        low={0}
        high={LAST}
        value={state.frame}
        choose={(frame) => set({ frame })}
      />
      <Film page={page} />
      <p class="check">
        <label>
          <input type="checkbox" name="marked" checked={state.marked} onChange={() => set(({ marked }) => ({ marked: !marked }))} />{" "}
          {texts.marked}
        </label>
      </p>
      <table class="sizes">
        <caption>{texts.all}</caption>
        <tbody>
          {answer.all.map((mean, i) => (
            <tr key={SIZES[i]} class={i === state.size ? "chosen" : ""}>
              <th scope="row">{texts.pixels(say.number(SIZES[i]!))}</th>
              <td>{say.whole(mean)}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <dl>
        <Row name="rms" label={texts.rms} value={answer.rms}>
          {say.percent(answer.rms)}
        </Row>
        <Row name="triangles" label={texts.triangles} value={answer.triangles}>
          {say.whole(answer.triangles)}
        </Row>
        <Row name="missed" label={texts.missed} value={answer.missed}>
          {say.whole(answer.missed)}
        </Row>
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: { size: ["s", number(0, SIZES.length - 1)], frame: ["n", number(0, LAST)], marked: ["b", flag] },
  question: ({ size, frame }) => ({ size, frame }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
