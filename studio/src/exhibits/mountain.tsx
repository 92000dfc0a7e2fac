// A teapot on a desk and a mountain behind it: each within the same pixels, seen through a loupe.
import { Figure as Data, Slider } from "../view/parts";
import type { Picture, View } from "../viewer";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { number, point } from "./fragment";
import { Grip, px } from "./Grip";
import { Scene } from "./Scene";
import type { Language, Say } from "./say";
import { unionPath } from "./union";

interface State {
  distance: number;
  budget: number;
  /** The middle of the loupe, in pixels of the screen. */
  spot: readonly [number, number];
}

type Name = "teapot" | "mountain";
const NAMES: readonly Name[] = ["teapot", "mountain"];

interface Model {
  /** Shrunk towards the eye, which is the origin. */
  mesh: { positions: Float32Array; indices: Uint32Array };
  edges: Float32Array;
  triangles: number;
  pixels: number;
  error: number;
  /** The triangles in the loupe, three corners each, in pixels of the screen. */
  loupe: Float32Array;
  /** Small pieces of the true surface there, four corners each. */
  truth: Float32Array;
}

interface Answer extends Record<Name, Model> {
  screen: [number, number];
  loupe: number;
  distances: [number, number];
  allowed: [number, number];
}

/** Distances in metres, eight per decade. */
const DISTANCES = Array.from({ length: 28 }, (_, i) => Number((10 ** ((i - 1) / 8)).toPrecision(2)));
const BUDGETS = [0.25, 0.5, 1, 2, 4, 8, 16];
const SCREEN = [1620, 1080] as const;
// Two pixels, because at one the still picture of the page would weigh more than all else.
const defaults: State = { distance: 0, budget: 3, spot: [419, 669] };
/** From the eye, at the origin, to the horizon. */
const VIEW: View = { azimuth: -90, elevation: 0, distance: 4, target: [0, 4, 0] };
/** The loupe in the figure, which is 720 wide: its middle and half its side. */
const LOUPE = { x: 586, y: 134, half: 108 } as const;

interface Texts extends CommonTexts {
  figure: string;
  eye: string;
  budget: string;
  pixels(n: string): string;
  spot: string;
  at(x: string, y: string): string;
  label: string;
  both(teapot: string, mountain: string): string;
  meaning(budget: string, teapot: string, mountain: string): string;
  name: Record<Name, string>;
  away(distance: string): string;
  allowed: string;
  proved: string;
  legend: { truth: string; mesh: string };
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "Drag the small square: the loupe shows its pixels. Sliders move the eye and set the budget.",
    figure: "A teapot on a desk and a mountain three kilometres behind it, with their triangles, and a loupe of 12 by 12 pixels",
    eye: "From the eye to the teapot",
    budget: "Both may be off by",
    pixels: (n) => `${n} px`,
    spot: "Loupe",
    at: (x, y) => `column ${x}, row ${y}`,
    label: "Triangles, teapot and mountain",
    both: (teapot, mountain) => `${teapot} and ${mountain}`,
    meaning: (budget, teapot, mountain) => `${budget} is ${teapot} on the teapot and ${mountain} on the mountain.`,
    name: { teapot: "Teapot", mountain: "Mountain" },
    away: (distance) => `${distance} away`,
    allowed: "may be off by",
    proved: "proved, at most",
    legend: { truth: "true surface", mesh: "triangles" },
    story: [
      "The error that counts is the one *on the screen*. One pixel is a third of a millimetre on a teapot at arm’s length, and over a metre on a mountain three kilometres behind it. So both get chords of *one pixel*, and five kilometres of mountain make do with thousands of triangles, as the teapot does.",
      "The loupe shows a square of 12 by 12 pixels. In it the true surface is grey, the triangles are blue, and the two never differ by more than the pixels that you allow.",
      "The picture looks from the eye to the horizon, on a screen of 1620 by 1080 pixels. Both models are bicubic patches; the mountain is a made-up one. The figure draws both shrunk towards the eye, which changes no direction and so not the picture.",
    ],
    attempts: [
      "Allow 8 pixels and drag the loupe along the teapot’s rim: where does a chord show?",
      "Go back to a kilometre. What do the teapot and the mountain need now?",
    ],
  },
  zh: {
    hint: "拖动小方框，放大镜就显示那里的像素。滑块移动眼睛、设定允许的误差。",
    figure: "桌上的茶壶和它身后三公里的山，画出了各自的三角形，以及 12 × 12 像素的放大镜",
    eye: "眼睛到茶壶",
    budget: "两者允许的误差",
    pixels: (n) => `${n} 像素`,
    spot: "放大镜",
    at: (x, y) => `第 ${x} 列，第 ${y} 行`,
    label: "三角形数：茶壶与山",
    both: (teapot, mountain) => `${teapot} 与 ${mountain}`,
    meaning: (budget, teapot, mountain) => `${budget}在茶壶上是 ${teapot}，在山上是 ${mountain}。`,
    name: { teapot: "茶壶", mountain: "山" },
    away: (distance) => `距离 ${distance}`,
    allowed: "允许误差",
    proved: "已证明的上界",
    legend: { truth: "真实曲面", mesh: "三角形" },
    story: [
      "要紧的是*屏幕上*的误差。一个像素，在手边的茶壶上是三分之一毫米，在三公里外的山上则超过一米。两者的弦都以*一个像素*的误差为限，于是五公里宽的山，也和茶壶一样，几千个三角形就够了。",
      "放大镜里是 12 × 12 个像素。灰色是真实曲面，蓝色是三角形，两者相差不会超过你允许的像素数。",
      "画面从眼睛望向地平线，屏幕为 1620 × 1080 像素。两个模型都是双三次曲面片，山是虚构的。画图时两者都向眼睛缩近，方向不变，画面也就不变。",
    ],
    attempts: ["允许 8 像素，沿茶壶的边缘拖动放大镜：哪里看得出弦？", "退到一公里外：茶壶和山现在各要多少三角形？"],
  },
};

type Page = PageOf<State, Answer, Texts>;

/** A length with a suitable metric unit. */
function metres(say: Say, length: number): string {
  const [factor, unit] =
    length < 0.01 ? [1000, "mm"] : length < 1 ? [100, "cm"] : length < 1000 ? [1, "m"] : [0.001, "km"];
  // In a Chinese text the unit could stand alone in the next line.
  return `${say.number(factor * length)}${say.language === "zh" ? "\u00a0" : " "}${unit}`;
}

function pictureOf({ answer, isStill }: Page): Picture {
  return {
    layers: NAMES.flatMap((name) => {
      const { mesh, edges } = answer[name];
      const isTeapot = name === "teapot";
      return [
        {
          kind: "mesh",
          id: name,
          ...mesh,
          paint: isTeapot ? "#a9c4e6" : "#b3c7a2",
          shading: "flat",
          sides: isStill ? "front" : "both",
        },
        ...(isStill ? [] : [{ kind: "lines", id: `${name}-wire`, positions: edges, paint: isTeapot ? "#24446b" : "#3c5230", width: 1 } as const]),
      ] as const;
    }),
  };
}

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill, isSmall } = page;
  return (
    <Scene
      name={texts.figure}
      help="hint"
      picture={pictureOf(page)}
      view={VIEW}
      home={VIEW}
      look={() => undefined}
      isStill={isStill}
      over={(at) => {
        // The scale of the figure: of two points beside the line of sight.
        const [left] = at.to([-0.1, 1, 0]);
        const [right, middle] = at.to([0.1, 1, 0]);
        const focal = (right - left) / 0.2;
        const scale = focal / (SCREEN[1] / 2 / Math.tan((14 * Math.PI) / 180));
        const centre = [(left + right) / 2, middle] as const;
        const [x, y] = [0, 1].map((k) => centre[k]! + scale * (state.spot[k]! - SCREEN[k]! / 2)) as [number, number];
        const size = (scale * answer.loupe) / 2;
        const moved = (dx: number, dy: number, [u, v]: State["spot"] = state.spot): State["spot"] => [
          kept(u + dx, SCREEN[0]),
          kept(v + dy, SCREEN[1]),
        ];
        return (
          <>
            <rect class="spot" x={px(x - size)} y={px(y - size)} width={px(2 * size)} height={px(2 * size)} />
            {!isSmall && <Loupe answer={answer} spot={state.spot} wide={2 * centre[0]} from={[x, y]} />}
            <Grip
              name={texts.spot}
              spoken={texts.at(String(state.spot[0]), String(state.spot[1]))}
              now={state.spot[0]}
              low={0}
              high={SCREEN[0]}
              at={[x, y]}
              isStill={isStill}
              isFaint
              grab={() => (dx, dy) => set({ spot: moved(dx / scale, dy / scale) })}
              step={(right, up) => {
                if (Number.isFinite(right) && Number.isFinite(up)) set(({ spot }) => ({ spot: moved(4 * right, -4 * up, spot) }));
              }}
            />
            <text class="label how-far" x={px(centre[0])} y={px(2 * middle - 12)}>
              {texts.away(metres(say, answer.distances[0]))}
            </text>
          </>
        );
      }}
    />
  );
}

const kept = (value: number, most: number) => Math.round(Math.min(Math.max(value, 8), most - 8));

/** The pixels around a spot, with the true surface and the triangles. */
function Loupe({ answer, spot, wide, from }: { answer: Answer; spot: State["spot"]; wide: number; from: readonly [number, number] }) {
  const size = Math.min(LOUPE.half, wide / 6);
  const [cx, cy] = [wide - size - 12, size + 12];
  const unit = (2 * size) / answer.loupe;
  const at = (x: number, y: number) => `${px(unit * (x - spot[0]))} ${px(unit * (y - spot[1]))}`;
  const tenth = (value: number) => Math.round(10 * value) / 10;
  const triangles = (of: Float32Array) => {
    let d = "";
    for (let i = 0; i < of.length; i += 6) d += `M${at(of[i]!, of[i + 1]!)}L${at(of[i + 2]!, of[i + 3]!)}L${at(of[i + 4]!, of[i + 5]!)}z`;
    return d;
  };
  const half = answer.loupe / 2;
  // The lines between pixels.
  const rules = Array.from({ length: answer.loupe + 1 }, (_, k) => {
    const [x, y] = [Math.ceil(spot[0] - half) + k, Math.ceil(spot[1] - half) + k];
    return `M${at(x, spot[1] - half)}L${at(x, spot[1] + half)}M${at(spot[0] - half, y)}L${at(spot[0] + half, y)}`;
  }).join("");
  return (
    <>
      <path class="leader" d={`M${px(from[0])} ${px(from[1])}L${px(cx)} ${px(cy)}`} />
      {/* An SVG of its own cuts off what is outside of the loupe. */}
      <svg x={px(cx - size)} y={px(cy - size)} width={px(2 * size)} height={px(2 * size)} viewBox={`${px(-size)} ${px(-size)} ${px(2 * size)} ${px(2 * size)}`} class="loupe-of-pixels" aria-hidden="true">
        <rect class="glass" x={px(-size)} y={px(-size)} width={px(2 * size)} height={px(2 * size)} />
        {[...NAMES].reverse().map((name) => (
          <g key={name} class={name}>
            <path class="true-surface" d={unionPath(answer[name].truth, 4, (x, y) => [tenth(unit * (x - spot[0])), tenth(unit * (y - spot[1]))])} />
            <path class="chords" d={triangles(answer[name].loupe)} />
          </g>
        ))}
        <path class="rules" d={rules} />
        <rect class="rim" x={px(-size)} y={px(-size)} width={px(2 * size)} height={px(2 * size)} />
      </svg>
    </>
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  const { teapot, mountain, allowed } = answer;
  const budget = BUDGETS[state.budget]!;
  return {
    value: teapot.triangles + mountain.triangles,
    shown: texts.both(say.whole(teapot.triangles), say.whole(mountain.triangles)),
    label: texts.label,
    meaning: texts.meaning(texts.pixels(say.number(budget)), metres(say, allowed[0]), metres(say, allowed[1])),
    tone: teapot.pixels <= budget && mountain.pixels <= budget ? "good" : "bad",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const far = metres(say, DISTANCES[state.distance]!);
  const budget = texts.pixels(say.number(BUDGETS[state.budget]!));
  return (
    <>
      <Slider
        id="distance"
        label={texts.eye}
        shown={far}
        low={0}
        high={DISTANCES.length - 1}
        value={state.distance}
        choose={(distance) => set({ distance })}
      />
      <Slider
        id="budget"
        label={texts.budget}
        shown={budget}
        low={0}
        high={BUDGETS.length - 1}
        value={state.budget}
        choose={(budget) => set({ budget })}
      />
      <p class="legend of-loupe">
        <span class="true-surface">{texts.legend.truth}</span>
        <span class="chords">{texts.legend.mesh}</span>
      </p>
      <dl>
        {NAMES.map((name, i) => (
          <div key={name} class={`of-${name}`}>
            <dt>
              {[texts.name[name], texts.away(metres(say, answer.distances[i]!)), texts.allowed].join(say.marks.comma)}
            </dt>
            <dd>
              <Data name={`${name}-allowed`} value={answer.allowed[i]!}>
                {metres(say, answer.allowed[i]!)}
              </Data>
            </dd>
          </div>
        ))}
        {NAMES.map((name) => (
          <div key={`${name}-proved`} class={`of-${name}`}>
            <dt>
              {[texts.name[name], texts.proved].join(say.marks.comma)}
            </dt>
            <dd>
              <Data name={`${name}-pixels`} value={answer[name].pixels}>
                {texts.pixels(say.fixed(answer[name].pixels))}
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
  parts: {
    distance: ["n", number(0, DISTANCES.length - 1)],
    budget: ["b", number(0, BUDGETS.length - 1)],
    spot: ["p", point([0, SCREEN[0]], [0, SCREEN[1]])],
  },
  question: ({ distance, budget, spot }) => ({ distance: DISTANCES[distance], px: BUDGETS[budget], spot }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
