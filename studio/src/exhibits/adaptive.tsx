// A surface meshed for the eye that looks at it: triangles crowd where it bends, near the eye and along the outline.
import { useRef, useState } from "preact/hooks";
import { Choice, Row, Slider } from "../view/parts";
import { type Picture, type Vec3, type View, eyeOf } from "../viewer";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { number, view, word, words } from "./fragment";
import { FRAME } from "./frame_texts";
import { Knob } from "./Knob";
import { Scene } from "./Scene";
import type { Language } from "./say";

type Cut = "bends" | "near" | "outline";
type Landscape = "teapot" | "landscape";

interface State {
  scene: Landscape;
  stop: number;
  cuts: readonly Cut[];
  view: View;
}

interface Answer {
  asked: { scene: Landscape; px: number; eye: Vec3; cuts: readonly Cut[] };
  mesh: { positions: Float32Array; indices: Uint32Array };
  edges: Float32Array;
  /** The class of each triangle by its area in the picture, from the largest. */
  groups: Uint32Array;
  counts: number[];
  triangles: number;
  /** The proved error along the outline; `null` without one. */
  pixels: number | null;
  elsewhere: number;
}

const CUTS: readonly Cut[] = ["bends", "near", "outline"];
/** Budgets in pixels. */
export const STOPS = [0.25, 0.5, 1, 2, 4, 8, 16];
const HOMES: Record<Landscape, View> = {
  teapot: { azimuth: -62, elevation: 20, distance: 4.6, target: [0.05, 0, 0.42] },
  landscape: { azimuth: -84, elevation: 11, distance: 5.2, target: [0.2, 1, 0.7] },
};
/** The eye is kept above the ground and in front of the surface. */
const REACH = { teapot: [2, 14], landscape: [3, 7] } as const;
const defaults: State = { scene: "teapot", stop: 4, cuts: CUTS, view: HOMES.teapot };

/** From the largest triangles to the smallest: the same in light and dark themes. */
const SIZES = ["#d9e4f2", "#a9c4e6", "#7ea6d8", "#f2d06b", "#ef9a45", "#d1523a"] as const;

interface Texts extends CommonTexts {
  figure: string;
  side: string;
  eye: string;
  at(distance: string): string;
  scene: string;
  scenes: Record<Landscape, string>;
  budget: string;
  pixels(n: string): string;
  cuts: string;
  cut: Record<Cut, string>;
  label: string;
  meaning(state: State, px: string, elsewhere: string): string;
  steps: string;
  ladder: readonly [string, string, string, string];
  sizes: string;
  size: readonly string[];
  proved: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: FRAME.en.turn,
    figure: "The surface with its triangles, as your eye sees it; the smaller a triangle in the picture, the warmer its colour",
    side: "The same triangles from the side, where you can drag the eye",
    eye: "Eye",
    at: (distance) => `${distance} units from its target`,
    scene: "Surface",
    scenes: { teapot: "teapot", landscape: "teapot before hills" },
    budget: "A chord may be off by",
    pixels: (n) => `${n} px`,
    cuts: "Triangles follow",
    cut: { bends: "bends", near: "distance", outline: "outline" },
    label: "Triangles",
    meaning: ({ cuts }, px, elsewhere) =>
      !cuts.includes("bends")
        ? "Every patch has the same number of cells: as many as the one that needs most."
        : `${cuts.includes("outline") ? "Along the outline every" : "Every"} place is within ${px} of where it should be in the picture${
            cuts.includes("outline") ? `, elsewhere within ${elsewhere} times as many` : ""
          }${cuts.includes("near") ? "." : "; for that, one length is used everywhere, the nearest place’s."}`,
    steps: "Triangles from this eye, as far as you have tried",
    ladder: ["cut equally", "+ bends", "+ distance", "+ outline"],
    sizes: "Area of a triangle in the picture, in pixels",
    size: ["over 1024", "256–1024", "64–256", "16–64", "4–16", "under 4"],
    proved: "Proved along the outline, at most",
    story: [
      "A flat place needs two triangles, however large it is. So three things decide how fine a mesh has to be: how much the surface *bends* there, how *near* it is, and whether it is on the *outline*. A chord across the line of sight moves the outline by its whole error; a chord that faces the eye is off along the line of sight, which only its shading can show.",
      "Switch the three off and on again. Without *bends* every patch is cut like the worst one. Without *distance* one length, that of the nearest place, holds everywhere, and the hills get triangles that nobody can see. Without *outline* the faces towards the eye are as fine as the rim.",
      "While you turn it, the mesh is made anew for each view. Its error is proved each time: the pixels along the outline, and four times as many elsewhere. A piece is known to have no outline if all of its normals point towards the eye, or all away from it; cross products of differences of its control points enclose them. Pixels are those of a picture of 720 by 480.",
    ],
    attempts: [
      "Turn the teapot and watch the side view: the crowd of triangles walks around it with the outline.",
      "Hills: switch “distance” off. How many triangles did distance save?",
    ],
  },
  zh: {
    hint: FRAME.zh.turn,
    figure: "从眼睛处看到的曲面及其三角形；在画面里越小的三角形，颜色越暖",
    side: "从侧面看同一批三角形；可以在这里拖动眼睛",
    eye: "眼睛",
    at: (distance) => `离目标 ${distance} 个单位`,
    scene: "曲面",
    scenes: { teapot: "茶壶", landscape: "山前的茶壶" },
    budget: "弦允许的误差",
    pixels: (n) => `${n} 像素`,
    cuts: "三角形按什么加密",
    cut: { bends: "弯曲", near: "远近", outline: "轮廓线" },
    label: "三角形数",
    meaning: ({ cuts }, px, elsewhere) =>
      !cuts.includes("bends")
        ? "每个曲面片都切成同样多的单元：由最难的一片决定。"
        : `画面上${cuts.includes("outline") ? "，轮廓线" : "每一处"}的误差都在 ${px}以内${
            cuts.includes("outline") ? `，其余地方放宽到 ${elsewhere} 倍` : ""
          }${cuts.includes("near") ? "。" : "；为此处处都用最近处的那个长度。"}`,
    steps: "从这里看所需的三角形（试过的才列出）",
    ladder: ["等分", "加上弯曲", "加上远近", "加上轮廓线"],
    sizes: "三角形在画面里的面积（像素）",
    size: ["1024 以上", "256–1024", "64–256", "16–64", "4–16", "不到 4"],
    proved: "轮廓线上已证明的上界",
    story: [
      "平坦的地方再大也只需两个三角形。网格要多细，取决于三件事：曲面在那里*弯*得多厉害，离眼睛有多*近*，是不是在*轮廓线*上。横在视线上的弦，误差有多大，轮廓就偏多少；正对眼睛的弦，误差顺着视线，只有明暗才看得出来。",
      "把三个开关逐个关掉再打开。不看*弯曲*，所有曲面片都照最难的一片来切。不看*远近*，处处都用最近处的那个长度，远山就多出一大批谁也看不见的三角形。不看*轮廓线*，正对眼睛的部分就和边缘一样细。",
      "每转动一次，网格都为新的视角重做一遍，误差也重新证明：轮廓线上是给定的像素数，其余地方放宽到四倍。如果一块曲面的法线全都朝向眼睛，或者全都背向眼睛，上面就没有轮廓线；控制点之差的叉积能把这些法线包住。像素按 720 × 480 的画面计算。",
    ],
    attempts: ["转动茶壶，看侧视图：密集的三角形跟着轮廓线绕着壶走。", "选山，关掉“远近”：远近这一项省了多少三角形？"],
  },
};

type Page = PageOf<State, Answer, Texts>;

function pictureOf({ answer: { mesh, edges, groups }, isStill }: Page, isAside = false): Picture {
  return {
    layers: [
      {
        kind: "mesh",
        id: "surface",
        ...mesh,
        groups: { of: groups, paints: SIZES },
        paint: SIZES[0],
        shading: "flat",
        sides: isStill ? "front" : "both",
      },
      // In a still figure every edge is a shape.
      ...(isStill ? [] : [{ kind: "lines", id: "wire", positions: edges, paint: "#24446b", width: isAside ? 0.6 : 1 } as const]),
    ],
  };
}

function Figure({ page }: { page: Page }) {
  const { state, texts, set, isStill } = page;
  return (
    <>
      <Scene
        name={texts.figure}
        help="hint"
        picture={pictureOf(page)}
        view={state.view}
        home={HOMES[state.scene]}
        look={(view) => set({ view: kept(view, state.scene) })}
        isStill={isStill}
      />
      {!isStill && <Side page={page} />}
    </>
  );
}

/** Where the side view looks from. */
const SIDES: Record<Landscape, View> = {
  teapot: { azimuth: 24, elevation: 24, distance: 15, target: [0.4, -0.9, 0.4] },
  landscape: { azimuth: 14, elevation: 26, distance: 44, target: [0, 8, 0] },
};

/** The same triangles from elsewhere, with the eye as a handle. */
function Side({ page }: { page: Page }) {
  const { state, texts, say, set } = page;
  const [views, turn] = useState(SIDES);
  const picture = pictureOf(page, true);
  const eye = eyeOf(state.view);
  const { target } = state.view;
  return (
    <div class="aside-scene">
      <Scene
        name={texts.side}
        help="hint"
        picture={{ layers: [...picture.layers, { kind: "lines", id: "sight", positions: new Float32Array([...eye, ...target]), paint: "--gap", width: 1.6 }] }}
        view={views[state.scene]}
        home={SIDES[state.scene]}
        look={(view) => turn((old) => ({ ...old, [state.scene]: view }))}
        isStill={false}
        over={(at) => (
          <Knob
            name={texts.eye}
            spoken={texts.at(say.number(state.view.distance))}
            place={eye}
            at={at}
            isStill={false}
            within={60}
            ground={0}
            move={(change) => set(({ view, scene }) => ({ view: kept(lookingFrom(change(eyeOf(view)), view.target), scene) }))}
          />
        )}
      />
      <p class="aside">{texts.side}</p>
    </div>
  );
}

/** The view of an eye towards a target. */
function lookingFrom(eye: Vec3, target: Vec3): View {
  const [x, y, z] = [0, 1, 2].map((k) => eye[k]! - target[k]!) as unknown as Vec3;
  const distance = Math.hypot(x, y, z) || 1;
  const degrees = 180 / Math.PI;
  return { azimuth: Math.atan2(y, x) * degrees, elevation: Math.asin(z / distance) * degrees, distance, target };
}

function kept(view: View, scene: Landscape): View {
  const [least, most] = REACH[scene];
  const within = (value: number, low: number, high: number) => Math.min(Math.max(value, low), high);
  const isOutside = scene === "landscape";
  // As the address stores it, so that a link shows the same triangles.
  const rounded = (value: number) => Math.round(value * 100) / 100;
  return {
    distance: rounded(within(view.distance, least, most)),
    elevation: rounded(isOutside ? within(view.elevation, 4, 60) : view.elevation),
    // Behind the hills there is no surface to look at.
    azimuth: rounded(isOutside ? within(view.azimuth, -150, -30) : view.azimuth),
    // The target stays, so that the eye cannot enter the surface.
    target: HOMES[scene].target,
  };
}

const px = ({ stop }: State) => STOPS[stop]!;

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  return {
    value: answer.triangles,
    shown: say.whole(answer.triangles),
    label: texts.label,
    meaning: texts.meaning(state, texts.pixels(say.number(px(state))), say.number(answer.elsewhere)),
    tone: state.cuts.length === CUTS.length ? "good" : "plain",
  };
}

/** The steps of the table: each has one cause more. */
const stepOf = (cuts: readonly Cut[]) => {
  const missing = CUTS.findIndex((cut) => !cuts.includes(cut));
  return missing < 0 ? CUTS.length : missing;
};

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  // Counts belong to a surface, a budget and an eye.
  const { cuts, ...eye } = answer.asked;
  const key = JSON.stringify(eye);
  const tried = useRef({ key, counts: new Map<number, number>() });
  if (tried.current.key !== key) tried.current = { key, counts: new Map() };
  const step = stepOf(cuts);
  // Only a set of the first causes is a step.
  const isStep = cuts.length === step;
  if (isStep) tried.current.counts.set(step, answer.triangles);
  return (
    <>
      <Choice
        name="scene"
        legend={texts.scene}
        value={state.scene}
        options={(["teapot", "landscape"] as const).map((value) => ({ value, label: texts.scenes[value] }))}
        choose={(scene) => set({ scene, view: HOMES[scene] })}
      />
      <Slider
        id="px"
        label={texts.budget}
        shown={texts.pixels(say.number(px(state)))}
        low={0}
        high={STOPS.length - 1}
        value={state.stop}
        choose={(stop) => set({ stop })}
      />
      <fieldset class="choice cuts">
        <legend>{texts.cuts}</legend>
        <div class="options">
          {CUTS.map((cut) => (
            <label key={cut}>
              <input
                type="checkbox"
                name={cut}
                checked={state.cuts.includes(cut)}
                disabled={cut !== "bends" && !state.cuts.includes("bends")}
                onChange={() => set(({ cuts }) => ({ cuts: CUTS.filter((other) => cuts.includes(other) !== (other === cut)) }))}
              />
              <span>{texts.cut[cut]}</span>
            </label>
          ))}
        </div>
      </fieldset>
      <dl>
        {texts.ladder.map((label, i) => (
          <div key={label} class={isStep && i === step ? "chosen" : ""}>
            <dt>{label}</dt>
            <dd>{tried.current.counts.has(i) ? say.whole(tried.current.counts.get(i)!) : "—"}</dd>
          </div>
        ))}
        <Row name="outline" label={texts.proved} value={answer.pixels}>
          {answer.pixels === null ? "—" : texts.pixels(say.fixed(answer.pixels))}
        </Row>
      </dl>
      <table class="sizes">
        <caption>{texts.sizes}</caption>
        <tbody>
          {texts.size.map((label, i) => (
            <tr key={label}>
              <th scope="row">
                <svg viewBox="0 0 12 12" aria-hidden="true">
                  <rect width="12" height="12" fill={SIZES[i]} />
                </svg>
                {label}
              </th>
              <td>{say.whole(answer.counts[i]!)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    scene: ["s", word("teapot", "landscape")],
    stop: ["n", number(0, STOPS.length - 1)],
    cuts: ["c", words(CUTS, CUTS.length)],
    view: ["o", view],
  },
  question: ({ scene, stop, cuts, view }) => ({ scene, px: STOPS[stop], cuts, eye: eyeOf(view), target: view.target }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
