// The winding says which side is the front; culling omits back faces, even if the winding is wrong.
import { Choice, Row, Slider } from "../view/parts";
import { type Picture, type Vec3, type View, eyeOf, pick, row } from "../viewer";
import { cross, minus, plus, unit } from "../viewer/view";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { number, numbers, view, word } from "./fragment";
import { PAINT } from "./paint";
import { Scene } from "./Scene";
import type { Language } from "./say";

interface State {
  flipped: readonly number[];
  chosen: number;
  backs: "culled" | "painted";
  view: View;
}

interface Answer {
  mesh: { positions: Float32Array; indices: Uint32Array };
  triangles: number;
  front: number;
  back: number;
  back_share: number;
  holes: number;
  inconsistent_edges: number;
  oriented: boolean;
  signed_volume: number;
}

const TRIANGLES = 80;
const HOME: View = { azimuth: -56, elevation: 20, distance: 5.2, target: [0, 0, 0] };
const defaults: State = { flipped: [38, 44, 50], chosen: 47, backs: "culled", view: HOME };

interface Texts extends CommonTexts {
  figure: string;
  handle: string;
  triangle(n: number, is: boolean): string;
  turn: string;
  turnAll: string;
  none: string;
  backs: string;
  culled: string;
  painted: string;
  label: Record<State["backs"], string>;
  whole: Record<State["backs"], string>;
  away: Record<State["backs"], string>;
  open: Record<State["backs"], (n: number) => string>;
  insideOut: Record<State["backs"], string>;
  culledShare: Record<State["backs"], string>;
  of(n: string, all: string): string;
  edges: string;
  oriented: string;
  yes: string;
  no: string;
  volume: string;
  noVolume: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "Press a triangle to turn it over. Drag to turn the ball; the number follows the eye.{keys} Arrow keys turn, + and − zoom, Home goes back.",
    figure: "A ball of 80 triangles, some of them wound the other way",
    handle: "Triangle",
    triangle: (n, is) => `number ${n}, ${is ? "turned over" : "as at first"}`,
    turn: "Turn it over",
    turnAll: "Turn all of them over",
    none: "As at first made",
    backs: "Backs are",
    culled: "culled",
    painted: "painted orange",
    label: { culled: "Holes that face you", painted: "Backs that face you" },
    whole: {
      culled: "Every triangle agrees: culling leaves out the far half, and nobody can tell.",
      painted: "Every triangle agrees: all backs are on the inner side, and from here none shows.",
    },
    away: {
      culled: "The turned triangles are on the far side: their fronts now face inward, so you would see them only through a hole.",
      painted: "The turned triangles are on the far side, behind the near half: from here no back shows.",
    },
    open: {
      culled: (n) =>
        `${n === 1 ? "One triangle" : `${n} triangles`} in front of you ${n === 1 ? "shows its" : "show their"} back, so culling left ${n === 1 ? "a hole" : "holes"}.`,
      painted: (n) =>
        `${n === 1 ? "One triangle" : `${n} triangles`} in front of you ${n === 1 ? "shows its" : "show their"} back, in orange. Culling would make ${n === 1 ? "it a hole" : "them holes"}.`,
    },
    insideOut: {
      culled: "All agree again, and the ball is inside out: culling leaves out the near half, and you look into the far one.",
      painted: "All agree again, and the ball is inside out: every triangle that you see shows its back.",
    },
    culledShare: { culled: "Culled from here", painted: "Culling would leave out" },
    of: (n, all) => `${n} of ${all}`,
    edges: "Edges whose triangles disagree",
    oriented: "Consistently wound",
    yes: "yes",
    no: "no",
    volume: "Volume, by the order of corners",
    noVolume: "none",
    story: [
      "A file does not say which side of a triangle is out. The *order of its corners* does: seen from the front they run counter-clockwise. On a closed surface the backs are inside, so a graphics processor leaves out triangles that run clockwise on the screen, *about half of them*, more if the eye is near. It checks only the order.",
      "Two neighbours agree if they run along their common edge in opposite ways. Turn one over and its three edges disagree. At rest, with both sides drawn, nobody sees it; lit or culled, it is a hole. That is why two meshes that look alike can behave differently.",
      "Turn over all triangles of a ball that agrees, and every edge agrees again. But now the ball is inside out: by its corners its volume would be negative.",
    ],
    attempts: [
      "Paint the backs instead of culling them: the holes were there all the time.",
      "Restore their winding, then turn all of them over. How many edges disagree, and what do you see?",
    ],
  },
  zh: {
    hint: "点按一个三角形即可翻转它。拖动可旋转球，数字随视点变化。{keys}方向键旋转，+ 和 − 缩放，Home 复位。",
    figure: "由 80 个三角形组成的球，其中有些环绕方向相反",
    handle: "三角形",
    triangle: (n, is) => `第 ${n} 个，${is ? "已翻转" : "原样"}`,
    turn: "翻转它",
    turnAll: "全部翻转",
    none: "恢复原样",
    backs: "背面",
    culled: "剔除",
    painted: "涂成橙色",
    label: { culled: "朝向你的孔", painted: "朝向你的背面" },
    whole: {
      culled: "所有三角形方向一致：剔除去掉了背对视点的三角形，谁也看不出来。",
      painted: "所有三角形方向一致：背面都朝里，从这里一个也看不见。",
    },
    away: {
      culled: "翻转的三角形在背对视点的一侧：它们的正面现在朝内，只有透过孔才看得见。",
      painted: "翻转的三角形在远侧，被近侧的一半挡住：从这里看不见背面。",
    },
    open: {
      culled: (n) => `你面前有 ${n} 个三角形是背面朝外，剔除后就成了孔。`,
      painted: (n) => `你面前有 ${n} 个三角形是背面朝外，涂成橙色。若剔除，就成了孔。`,
    },
    insideOut: {
      culled: "方向又都一致，但球里外颠倒：剔除去掉了近侧的一半，你看到的是远侧的内壁。",
      painted: "方向又都一致，但球里外颠倒：看得见的全是背面。",
    },
    culledShare: { culled: "从这里看被剔除的", painted: "若剔除，将去掉" },
    of: (n, all) => `${all} 个中的 ${n} 个`,
    edges: "两侧方向不一致的边",
    oriented: "环绕方向一致",
    yes: "是",
    no: "否",
    volume: "按顶点次序算出的体积",
    noVolume: "无",
    story: [
      "文件里并没有写三角形哪面朝外，写明的是*顶点的次序*：从正面看，顶点按逆时针排列。封闭曲面的背面都在里面，所以图形处理器把屏幕上按顺时针排列的三角形全部去掉，*大约一半*，视点近时更多。这就是背面剔除，它只看次序。",
      "两个相邻三角形沿公共边的走向相反，就算一致。翻转其中一个，它的三条边就都不一致。静止地双面绘制时看不出来；一打光、一剔除，就是一个孔。两个看上去一样的网格表现不同，原因就在这里。",
      "把方向一致的球的所有三角形都翻转，每条边仍然一致，但球里外颠倒：按顶点次序算，体积成了负数。",
    ],
    attempts: [
      "不剔除，改为给背面涂色：孔其实一直都在。",
      "先恢复原样，再翻转全部三角形：有几条边不一致？你看到了什么？",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;

/** The winding of a triangle: arrows inside it, with a barb on each side. */
function windingArrows(positions: Float32Array, indices: Uint32Array, face: number): { outline: Float32Array; arrows: Float32Array } {
  const corners = [0, 1, 2].map((k) => row(positions, indices[3 * face + k]!)) as [Vec3, Vec3, Vec3];
  const middle = corners.reduce((sum, p) => plus(sum, p, 1 / 3), [0, 0, 0] as Vec3);
  const inner = corners.map((p) => plus(p, minus(middle, p), 0.36)) as [Vec3, Vec3, Vec3];
  const normal = unit(cross(minus(corners[1], corners[0]), minus(corners[2], corners[0])));
  const arrows: Vec3[] = [];
  const outline: Vec3[] = [];
  inner.forEach((from, k) => {
    const to = inner[(k + 1) % 3]!;
    const along = minus(to, from);
    const side = cross(normal, along);
    const tip = plus(from, along, 0.72);
    arrows.push(
      from,
      plus(from, along, 0.86),
      tip,
      plus(plus(tip, along, -0.16), side, 0.13),
      tip,
      plus(plus(tip, along, -0.16), side, -0.13),
    );
    outline.push(corners[k]!, corners[(k + 1) % 3]!);
  });
  return { outline: new Float32Array(outline.flat()), arrows: new Float32Array(arrows.flat()) };
}

function pictureOf({ state, answer }: Page): Picture {
  const { positions, indices } = answer.mesh;
  const { outline, arrows } = windingArrows(positions, indices, state.chosen);
  const isCulled = state.backs === "culled";
  return {
    layers: [
      {
        kind: "mesh",
        id: "ball",
        positions,
        indices,
        paint: PAINT.front,
        ...(isCulled ? {} : { back: PAINT.back }),
        shading: "flat",
        sides: isCulled ? "front" : "both",
      },
      { kind: "lines", id: "outline", positions: outline, paint: "--ink", width: 2.4, isMark: true },
      { kind: "lines", id: "arrows", positions: arrows, paint: "--ink", width: 1.6, isMark: true },
    ],
  };
}

const turnedOver = (flipped: readonly number[], face: number) =>
  // Sorted, so that the same triangles are the same address in whatever order they were turned.
  (flipped.includes(face) ? flipped.filter((other) => other !== face) : [...flipped, face]).toSorted((a, b) => a - b);

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, set, isStill } = page;
  return (
    <Scene
      name={texts.figure}
      help="hint"
      picture={pictureOf(page)}
      view={state.view}
      home={HOME}
      look={(view) => set({ view })}
      isStill={isStill}
      tap={(at, x, y) => {
        const face = pick(at, x, y, answer.mesh.positions, answer.mesh.indices);
        if (face !== undefined) set(({ flipped }) => ({ flipped: turnedOver(flipped, face), chosen: face }));
      }}
    />
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  const n = answer.holes;
  const { backs } = state;
  const isInsideOut = answer.oriented && answer.signed_volume < 0;
  return {
    value: n,
    shown: say.whole(n),
    label: texts.label[backs],
    meaning: isInsideOut
      ? texts.insideOut[backs]
      : n
        ? texts.open[backs](n)
        : state.flipped.length
          ? texts.away[backs]
          : texts.whole[backs],
    tone: n ? "bad" : "good",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const is = state.flipped.includes(state.chosen);
  return (
    <>
      <div>
        <Slider
          id="triangle"
          label={texts.handle}
          shown={state.chosen}
          spoken={texts.triangle(state.chosen, is)}
          low={0}
          high={TRIANGLES - 1}
          value={state.chosen}
          choose={(chosen) => set({ chosen })}
        />
        <div class="buttons">
          <button
            type="button"
            aria-pressed={is}
            onClick={() => set(({ flipped, chosen }) => ({ flipped: turnedOver(flipped, chosen) }))}
          >
            {texts.turn}
          </button>
          <button
            type="button"
            onClick={() =>
              set(({ flipped }) => ({
                flipped: Array.from({ length: TRIANGLES }, (_, i) => i).filter((i) => !flipped.includes(i)),
              }))
            }
          >
            {texts.turnAll}
          </button>
          <button type="button" onClick={() => set({ flipped: [] })} disabled={state.flipped.length === 0}>
            {texts.none}
          </button>
        </div>
      </div>
      <Choice
        name="backs"
        legend={texts.backs}
        value={state.backs}
        options={[
          { value: "culled", label: texts.culled },
          { value: "painted", label: texts.painted },
        ]}
        choose={(backs) => set({ backs })}
      />
      <dl>
        <Row name="back-share" label={texts.culledShare[state.backs]} value={answer.back_share}>
          {texts.of(say.whole(answer.back), say.whole(answer.triangles))}
          {say.marks.aside(say.percent(answer.back_share))}
        </Row>
        <Row name="inconsistent" label={texts.edges} value={answer.inconsistent_edges}>
          {say.whole(answer.inconsistent_edges)}
        </Row>
        <div>
          <dt>{texts.oriented}</dt>
          <dd>{answer.oriented ? texts.yes : texts.no}</dd>
        </div>
        <Row name="volume" label={texts.volume} value={answer.oriented ? answer.signed_volume : null}>
          {answer.oriented ? say.fixed(answer.signed_volume) : texts.noVolume}
        </Row>
      </dl>
    </>
  );
}

const rounded = (x: number) => Math.round(x * 1000) / 1000;

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    flipped: ["f", numbers(0, TRIANGLES, number(0, TRIANGLES - 1))],
    chosen: ["t", number(0, TRIANGLES - 1)],
    backs: ["b", word("culled", "painted")],
    view: ["o", view],
  },
  question: ({ flipped, view }) => ({ shape: "ball", flipped: [...new Set(flipped)], eye: eyeOf(view).map(rounded) }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
