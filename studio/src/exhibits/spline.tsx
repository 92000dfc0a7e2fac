// A spline that one draws: how smooth it is, and how far a point reaches; beside it the one polynomial through all points.
import { Choice, Row } from "../view/parts";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { Dot, FLAT, Flat, type Point, at, kept, path } from "./Flat";
import { flag, number, points, word } from "./fragment";
import type { Language } from "./say";

interface State {
  points: readonly Point[];
  kind: "lines" | "catmull-rom" | "natural";
  chosen: number;
  single: boolean;
}

interface Sampled {
  line: Float32Array;
  shares: Float32Array;
  beyond: number;
}

interface Answer {
  spline: Sampled;
  polynomial: Sampled;
  pieces: number;
  moving: number;
  degree: number;
  class: number | null;
}

const MOST = 14;
const defaults: State = {
  points: [
    [0.9, 2.4],
    [2.4, 4.9],
    [4.2, 5.6],
    [5.7, 3.4],
    [7.4, 2.2],
    [9.1, 4.2],
    [11, 5.4],
  ],
  kind: "catmull-rom",
  chosen: 3,
  single: true,
};

interface Texts extends CommonTexts {
  figure: string;
  add: string;
  point(n: number): string;
  at(x: string, y: string): string;
  kind: string;
  kinds: Record<State["kind"], string>;
  single: string;
  more: string;
  last: string;
  reset: string;
  label(n: number): string;
  of(n: string, all: string): string;
  meaning: Record<State["kind"], string>;
  class: string;
  none: string;
  beyond: string;
  beyondSingle: string;
  points: string;
  swept: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "Press an empty place to add a point, drag points to move them.{keys} Tab to a point, then the arrow keys; the buttons add and remove points.",
    figure: "A curve through points that can be added and moved",
    add: "Add a point here",
    point: (n) => `Point ${n}`,
    at: (x, y) => `x ${x}, y ${y}`,
    kind: "The curve",
    kinds: { lines: "lines (C0)", "catmull-rom": "Catmull–Rom (C1)", natural: "natural spline (C2)" },
    single: "the single polynomial, too",
    more: "Add a point",
    last: "Remove the last",
    reset: "As at first",
    label: (n) => `Pieces that move with point ${n}`,
    of: (n, all) => `${n} of ${all}`,
    meaning: {
      lines: "Only the two lines at the point move, and they meet with a kink.",
      "catmull-rom": "Two pieces on either side move, the rest not at all: local control. The direction is continuous, the curvature is not.",
      natural: "Everything moves, but each piece farther away about a quarter as much: that is the price of continuous curvature.",
    },
    class: "Smoothness at the points",
    none: "–",
    beyond: "Moves beyond the neighbours by",
    beyondSingle: "… the single polynomial by",
    points: "Points",
    swept: "Red: what the curve sweeps if the chosen point moves up by one unit.",
    story: [
      "A *spline* goes through its points in pieces, one cubic between two neighbours. How the pieces meet is a choice: *C0* only meets, *C1* (Catmull–Rom) takes the direction at each point from its two neighbours, *C2* (the natural spline) solves for directions that make the bending continuous, too.",
      "What a point moves is the painted area. For C1 it ends two pieces away, exactly; for C2 it never ends, but it fades by a factor of about 3.7 a piece. The red dashed curve is the *one polynomial* through all points: there a point moves everything, and most of all what is far away.",
    ],
    attempts: [
      "Draw a letter. Then choose lines, C1 and C2: where can you see a difference?",
      "Choose a point in the middle and compare the two red areas. Add points: which one grows?",
    ],
  },
  zh: {
    hint: "点空白处添加一个点，拖动可移动。{keys}按 Tab 选点，再按方向键；增减点另有按钮。",
    figure: "穿过若干点的曲线；点可以添加和移动",
    add: "在此添加一个点",
    point: (n) => `第 ${n} 个点`,
    at: (x, y) => `x ${x}，y ${y}`,
    kind: "曲线",
    kinds: { lines: "折线（C0）", "catmull-rom": "Catmull–Rom（C1）", natural: "自然样条（C2）" },
    single: "同时画出单个多项式",
    more: "添加一个点",
    last: "去掉最后一个",
    reset: "恢复原样",
    label: (n) => `随第 ${n} 个点移动的段`,
    of: (n, all) => `${n} / ${all}`,
    meaning: {
      lines: "只有相邻的两条线段移动，而且在点上形成折角。",
      "catmull-rom": "左右各两段移动，其余丝毫不动，这就是局部控制。方向连续，曲率不连续。",
      natural: "每一段都动，但每远一段，只剩大约四分之一：这是曲率连续的代价。",
    },
    class: "各点处的连续性",
    none: "–",
    beyond: "相邻点以外移动",
    beyondSingle: "……单个多项式移动",
    points: "点数",
    swept: "红色：选中的点上移一个单位时，曲线扫过的范围。",
    story: [
      "*样条*分段穿过各点，相邻两点之间是一段三次曲线。段与段怎样相接可以选择：*C0* 只是相接；*C1*（Catmull–Rom）由左右两个邻点定出每一点的方向；*C2*（自然样条）解一个方程组，让弯曲程度也连续。",
      "着色的就是一个点牵动的范围。C1 恰好止于两段之外；C2 永不为零，但每隔一段约缩小到 1/3.7。红色虚线是穿过所有点的*单个多项式*：一点移动，处处都动，越远的地方动得越厉害。",
    ],
    attempts: [
      "画一个字母，再依次选折线、C1、C2：哪里看得出差别？",
      "选中间的一个点，比较两块红色区域。再添几个点：哪一块变大？",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
const chosenOf = ({ chosen, points }: State) => Math.min(chosen, points.length - 1);
const pointsOf = (line: Float32Array): Point[] => Array.from({ length: line.length / 2 }, (_, i) => [line[2 * i]!, line[2 * i + 1]!]);

/** The area between a curve and the same curve after the chosen point moved up by one unit. */
function swept({ line, shares }: Sampled): string {
  const here = pointsOf(line);
  const there = here.map(([x, y], i): Point => [x, y + shares[i]!]);
  return path([...here, ...there.reverse()]);
}

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill } = page;
  const chosen = chosenOf(state);
  const add = (event: MouseEvent & { currentTarget: SVGRectElement }) => {
    const box = event.currentTarget.getBoundingClientRect();
    const place = kept([((event.clientX - box.left) / box.width) * FLAT.width, (1 - (event.clientY - box.top) / box.height) * FLAT.height]);
    set(({ points }) => (points.length < MOST ? { points: [...points, place], chosen: points.length } : {}));
  };
  return (
    <Flat name={texts.figure}>
      <rect class="empty-place" width="100%" height="100%" onClick={add} />
      {state.single && (
        <>
          <path class="swept pale" d={swept(answer.polynomial)} />
          <path class="polynomial before" d={path(pointsOf(answer.polynomial.line), false)} />
        </>
      )}
      <path class="swept" d={swept(answer.spline)} />
      <path class="drawn-spline" d={path(pointsOf(answer.spline.line), false)} />
      {state.points.map((place, i) => (
        <Dot
          key={i}
          name={texts.point(i + 1)}
          spoken={texts.at(say.fixed(place[0]), say.fixed(place[1]))}
          place={place}
          isStill={isStill}
          isFaint={i !== chosen}
          reach={20}
          chosen={() => set({ chosen: i })}
          move={(change) => set(({ points }) => ({ points: points.map((old, k) => (k === i ? change(old) : old)) }))}
        />
      ))}
      <text class="label" x={at(state.points[chosen]!).split(" ")[0]} y={Number(at(state.points[chosen]!).split(" ")[1]) - 16}>
        {chosen + 1}
      </text>
    </Flat>
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  return {
    value: answer.moving,
    shown: texts.of(say.whole(answer.moving), say.whole(answer.pieces)),
    label: texts.label(chosenOf(state) + 1),
    meaning: texts.meaning[state.kind],
    tone: "plain",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  /** Beyond the last point, on the same line; from the border of the figure it goes back. */
  const more = () =>
    set(({ points }) => {
      const [[ax, ay], [bx, by]] = [points[points.length - 2]!, points[points.length - 1]!];
      const next = kept([bx + (bx - ax) / 2, by + (by - ay) / 2]);
      const isSame = next[0] === bx && next[1] === by;
      return points.length < MOST ? { points: [...points, isSame ? kept([6, 4]) : next], chosen: points.length } : {};
    });
  return (
    <>
      <Choice
        name="kind"
        class="stacked"
        legend={texts.kind}
        value={state.kind}
        options={(["lines", "catmull-rom", "natural"] as const).map((value) => ({ value, label: texts.kinds[value] }))}
        choose={(kind) => set({ kind })}
      />
      <label class="check">
        <input type="checkbox" checked={state.single} onChange={() => set(({ single }) => ({ single: !single }))} />
        {texts.single}
      </label>
      <p class="aside">{texts.swept}</p>
      <div class="buttons">
        <button type="button" disabled={state.points.length === MOST} onClick={more}>
          {texts.more}
        </button>
        <button type="button" disabled={state.points.length === 2} onClick={() => set(({ points }) => ({ points: points.slice(0, -1) }))}>
          {texts.last}
        </button>
        <button type="button" onClick={() => set({ points: defaults.points, chosen: defaults.chosen })}>
          {texts.reset}
        </button>
      </div>
      <dl>
        <div>
          <dt>{texts.points}</dt>
          <dd>{say.whole(state.points.length)}</dd>
        </div>
        <Row name="class" label={texts.class} value={answer.class}>
          {answer.class === null ? texts.none : `C${answer.class}`}
        </Row>
        <Row name="beyond" label={texts.beyond} value={answer.spline.beyond}>
          {say.fixed(answer.spline.beyond)}
        </Row>
        {state.single && (
          <Row name="beyond-single" label={texts.beyondSingle} value={answer.polynomial.beyond}>
            {say.fixed(answer.polynomial.beyond)}
          </Row>
        )}
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    points: ["p", points<Point>(2, MOST, [[0, FLAT.width], [0, FLAT.height]])],
    kind: ["c", word("lines", "catmull-rom", "natural")],
    chosen: ["n", number(0, MOST - 1)],
    single: ["b", flag],
  },
  question: (state) => ({ points: state.points, kind: state.kind, chosen: chosenOf(state) }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
