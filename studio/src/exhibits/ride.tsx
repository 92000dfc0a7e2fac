// A camera rides along a path that is C1 or C2: the picture from it, its acceleration, and the jerk where pieces join.
import { useEffect, useRef, useState } from "preact/hooks";
import { Choice, Row, Slider } from "../view/parts";
import type { Picture, Vec3, View } from "../viewer";
import { Chart, chain } from "./Chart";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { Dot, FLAT, Flat, type Point, path, toSvg } from "./Flat";
import { number, points, word } from "./fragment";
import { px } from "./Grip";
import { PAINT } from "./paint";
import { Scene } from "./Scene";
import type { Language } from "./say";

interface State {
  points: readonly Point[];
  kind: "C1" | "C2";
  /** In pieces: the whole part is the piece, the rest the time on it. */
  time: number;
}

interface Answer {
  places: Float32Array;
  speeds: Float32Array;
  pushes: Float32Array;
  azimuths: Float32Array;
  tilts: Float32Array;
  sizes: Float32Array;
  most: number;
  ahead: number;
  moments: number;
  jumps: number[];
  largest: number;
  at: number;
  is_smooth: boolean;
  blocks: { positions: Float32Array; indices: Uint32Array };
}

const defaults: State = {
  points: [
    [2, 1.6],
    [6.2, 2.2],
    [10, 1.4],
    [10.4, 5.6],
    [7.2, 5.4],
    [4.6, 6.6],
    [1.6, 5.4],
  ],
  kind: "C1",
  time: 0.6,
};
const MOST = 10;
/** Seconds for each piece. Chosen: slow enough to feel each joint. */
const PIECE_S = 1.5;
/** The steps of a ride where motion is reduced: three a piece. */
const CALM = { share: 1 / 3, ms: 900 } as const;
/** The camera looks down a little, from this height. */
const EYE = { height: 0.55, elevation: 5 } as const;
/** Drawn lengths of a unit of velocity and of acceleration. */
const ARROWS = { speed: 0.22, push: 0.07 } as const;

interface Texts extends CommonTexts {
  figure: string;
  ridden: string;
  point(n: number): string;
  at(x: string, y: string): string;
  kind: string;
  kinds: Record<State["kind"], string>;
  play: string;
  pause: string;
  time: string;
  spoken(piece: number, percent: string): string;
  label: string;
  none: string;
  jumps(n: number): string;
  smooth: string;
  chart: string;
  chartX: string;
  chartY: string;
  speed: string;
  push: string;
  now: string;
  weight: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "Drag the points of the path. Press Play to ride, or move the time.{keys} Tab to a point, then the arrow keys.",
    figure: "The path from above, with the camera, its velocity and its acceleration; points can be moved",
    ridden: "The picture from the camera, with a hanging weight",
    point: (n) => `Point ${n} of the path`,
    at: (x, y) => `x ${x}, y ${y}`,
    kind: "The path is",
    kinds: { C1: "C1: Catmull–Rom", C2: "C2: a spline" },
    play: "Play",
    pause: "Pause",
    time: "Time",
    spoken: (piece, percent) => `piece ${piece}, ${percent} of it`,
    label: "Largest jump of the acceleration",
    none: "0",
    jumps: (n) => `At point ${n} the force on the rider changes in an instant: the weight jerks, although the path has no kink.`,
    smooth: "The acceleration is continuous: no jerk at any point, only faster and slower changes.",
    chart: "The size of the acceleration over the ride",
    chartX: "point",
    chartY: "acceleration",
    speed: "velocity",
    push: "acceleration",
    now: "Acceleration now",
    weight: "The weight hangs as it would on the string of a rider.",
    story: [
      "Both paths go through the same points, and neither has a kink. On the *C1* path position and velocity are continuous; at each point the *acceleration* jumps, and a force that sets in at once is what you feel as a jerk. On the *C2* path it is continuous as well.",
      "So camera paths, roller coasters and robot arms need C2, and railways put a curve whose bending grows slowly between a straight and a bend. Reflections show the same thing on a surface: a highlight runs along the derivative.",
    ],
    attempts: [
      "Ride on C1 and watch the weight at the points, then ride on C2.",
      "Move two neighbouring points close together. What happens to the acceleration?",
    ],
  },
  zh: {
    hint: "拖动路径上的点。点“播放”上路，或拖动时间。{keys}按 Tab 选点，再按方向键移动。",
    figure: "俯视的路径、相机、速度和加速度；点可以移动",
    ridden: "相机看到的画面，画面里悬着一个重物",
    point: (n) => `路径的第 ${n} 个点`,
    at: (x, y) => `x ${x}，y ${y}`,
    kind: "路径",
    kinds: { C1: "C1：Catmull–Rom", C2: "C2：样条" },
    play: "播放",
    pause: "暂停",
    time: "时间",
    spoken: (piece, percent) => `第 ${piece} 段，走了 ${percent}`,
    label: "加速度的最大突变",
    none: "0",
    jumps: (n) => `在第 ${n} 个点，乘客受的力瞬间改变：路径没有折角，重物却猛地一甩。`,
    smooth: "加速度处处连续：没有一个点会猛地一甩，只有变化快慢之分。",
    chart: "全程的加速度大小",
    chartX: "点",
    chartY: "加速度",
    speed: "速度",
    push: "加速度",
    now: "此刻的加速度",
    weight: "重物的摆法，和乘客手里用线吊着的一样。",
    story: [
      "两条路径穿过同样的点，都没有折角。*C1* 路径的位置和速度连续，每到一个点*加速度*却会突变；力突然加上来，人就觉得一顿。*C2* 路径连加速度也连续。",
      "所以相机路径、过山车和机械臂都要求 C2；铁路在直道与弯道之间也要加一段缓和曲线，让弯曲慢慢增大。曲面上的反光是同一回事：高光顺着导数走。",
    ],
    attempts: [
      "先走 C1，留意重物经过各点时的样子，再走 C2。",
      "把相邻的两个点拖到一起：加速度怎样变化？",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
const vector = (of: Float32Array, i: number): Point => [of[2 * i]!, of[2 * i + 1]!];
/** The index of the moment. */
const momentOf = ({ state, answer }: Page) => Math.min(Math.floor(state.time * answer.moments), answer.sizes.length - 1);

/** Every third place of the path: enough to look like a curve. */
const sparse = ({ places }: Answer): Point[] => Array.from({ length: places.length / 2 / 3 }, (_, i) => vector(places, 3 * i));

function roadOf({ answer }: Page): Float32Array {
  const places = sparse(answer);
  return new Float32Array(places.flatMap(([x, y], i) => [x, y, 0, ...places[(i + 1) % places.length]!, 0]));
}

function pictureOf(page: Page): Picture {
  const grid: number[] = [];
  for (let x = 0; x <= FLAT.width; x++) grid.push(x, 0, 0, x, FLAT.height, 0);
  for (let y = 0; y <= FLAT.height; y++) grid.push(0, y, 0, FLAT.width, y, 0);
  return {
    layers: [
      { kind: "lines", id: "grid", positions: new Float32Array(grid), paint: "--line", width: 1, isUnder: true },
      { kind: "lines", id: "road", positions: roadOf(page), paint: "--chain", width: 3, isUnder: true },
      { kind: "mesh", id: "blocks", ...page.answer.blocks, paint: PAINT.front, shading: "flat", sides: "both" },
    ],
  };
}

/** The view of the camera at a moment: it looks ahead along the path. */
function viewAt(answer: Answer, i: number): View {
  const [x, y] = vector(answer.places, i);
  const azimuth = answer.azimuths[i]!;
  const [a, e] = [azimuth, EYE.elevation].map((degrees) => (degrees * Math.PI) / 180) as [number, number];
  const { ahead } = answer;
  // The eye of this view is at the camera's place.
  const target: Vec3 = [x - ahead * Math.cos(e) * Math.cos(a), y - ahead * Math.cos(e) * Math.sin(a), EYE.height - ahead * Math.sin(e)];
  return { azimuth, elevation: EYE.elevation, distance: ahead, target };
}

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill, isSmall } = page;
  const i = momentOf(page);
  const place = vector(answer.places, i);
  const along = (of: Float32Array, scale: number): Point => {
    const [x, y] = vector(of, i);
    return [place[0] + scale * x, place[1] + scale * y];
  };
  const [x, y] = toSvg(place);
  const map = (
    <Flat name={texts.figure}>
      <path class="road" d={path(sparse(answer))} />
      <path class="arrow-of speed" d={path([place, along(answer.speeds, ARROWS.speed)], false)} />
      <path class="arrow-of push" d={path([place, along(answer.pushes, ARROWS.push)], false)} />
      <circle class="rider" cx={px(x)} cy={px(y)} r={9} />
      {state.points.map((point, k) => (
        <Dot
          key={k}
          name={texts.point(k + 1)}
          spoken={texts.at(say.fixed(point[0]), say.fixed(point[1]))}
          place={point}
          isStill={isStill}
          isFaint
          move={(change) => set(({ points }) => ({ points: points.map((old, j) => (j === k ? change(old) : old)) }))}
        />
      ))}
    </Flat>
  );
  if (isSmall) return map;
  const view = viewAt(answer, i);
  return (
    <div class="stacked-figures">
      <div class="ridden">
        <Scene
          name={texts.ridden}
          help="hint"
          picture={pictureOf(page)}
          view={view}
          home={view}
          look={() => undefined}
          isFixed
          isStill={isStill}
          over={() => <Weight tilt={answer.tilts[i]!} />}
        />
      </div>
      {map}
    </div>
  );
}

/** A weight on a string, at the upper left of the picture. */
function Weight({ tilt }: { tilt: number }) {
  return (
    <g class="weight" transform={`translate(70 18) rotate(${px(tilt)})`}>
      <path class="string" d="M0 0V74" />
      <circle class="bob" cy={80} r={10} />
    </g>
  );
}

/** Moves the time while it plays; in steps where motion is reduced. */
function usePlay({ state, set }: Page): readonly [boolean, () => void] {
  const [isPlaying, setPlaying] = useState(false);
  const pieces = useRef(state.points.length);
  pieces.current = state.points.length;
  useEffect(() => {
    if (!isPlaying) return;
    const advance = (share: number) => set(({ time }) => ({ time: (time + share) % pieces.current }));
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) {
      const timer = setInterval(() => advance(CALM.share), CALM.ms);
      return () => clearInterval(timer);
    }
    let last: number | undefined;
    let frame = requestAnimationFrame(function draw(now) {
      // After a pause of the tab the ride goes on where it was.
      if (last !== undefined) advance(Math.min(now - last, 100) / 1000 / PIECE_S);
      last = now;
      frame = requestAnimationFrame(draw);
    });
    return () => cancelAnimationFrame(frame);
  }, [isPlaying]);
  return [isPlaying, () => setPlaying((before) => !before)];
}

function liveNumber({ answer, say, texts }: Page): LiveNumber {
  const { is_smooth, largest, at } = answer;
  return {
    value: is_smooth ? 0 : largest,
    shown: is_smooth ? texts.none : say.fixed(largest),
    label: texts.label,
    meaning: is_smooth ? texts.smooth : texts.jumps(at + 1),
    tone: is_smooth ? "good" : "bad",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const [isPlaying, toggle] = usePlay(page);
  const { sizes, moments, most } = answer;
  const pieces = state.points.length;
  const i = momentOf(page);
  // The first and the last moment of each piece, and every tenth: at a joint of a C1 path the curve has a step.
  const curve = [...sizes].flatMap((size, k) => (k % 10 === 0 || k % moments === moments - 1 ? [[k / moments, size] as const] : []));
  const top = Math.max(most, 1) * 1.05;
  return (
    <>
      <div class="buttons">
        <button type="button" class="play" aria-pressed={isPlaying} onClick={toggle}>
          {isPlaying ? texts.pause : texts.play}
        </button>
      </div>
      <Slider
        id="time"
        label={texts.time}
        shown={say.fixed(state.time)}
        spoken={texts.spoken(Math.floor(state.time) + 1, say.percent(state.time % 1))}
        low={0}
        high={pieces - 0.01}
        step={0.01}
        value={state.time}
        choose={(time) => set({ time })}
      />
      <Choice
        name="kind"
        class="stacked"
        legend={texts.kind}
        value={state.kind}
        options={(["C1", "C2"] as const).map((value) => ({ value, label: texts.kinds[value] }))}
        choose={(kind) => set({ kind })}
      />
      <Chart
        name={texts.chart}
        x={{ low: 0, high: pieces, label: texts.chartX, ticks: Array.from({ length: pieces }, (_, k) => [k, `${k + 1}`] as const) }}
        y={{ low: 0, high: top, label: texts.chartY, ticks: [[0, "0"]] }}
      >
        {(at) => (
          <>
            <path class="push-curve" d={chain(at, curve)} />
            <path class="playhead" d={`M${at(state.time, 0).map(px).join(" ")}L${at(state.time, top).map(px).join(" ")}`} />
          </>
        )}
      </Chart>
      <dl>
        <Row name="push" label={texts.now} value={sizes[i]!}>
          {say.fixed(sizes[i]!)}
        </Row>
      </dl>
      <div>
        <p class="legend arrows">
          <span>{texts.speed}</span>
          <span class="push">{texts.push}</span>
        </p>
        <p class="aside">{texts.weight}</p>
      </div>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    points: ["p", points<Point>(4, MOST, [[0, FLAT.width], [0, FLAT.height]])],
    kind: ["c", word("C1", "C2")],
    time: ["h", number(0, MOST, 100)],
  },
  question: ({ points, kind }) => ({ points, kind }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
