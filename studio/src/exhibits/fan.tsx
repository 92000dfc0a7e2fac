// A polygon that one cuts into n − 2 triangles oneself, beside a fan and the library's ear clipping.
import { Choice, Row } from "../view/parts";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { Dot, FLAT, Flat, type Point, at, kept, path } from "./Flat";
import { number, numbers, points, word } from "./fragment";
import type { Language } from "./say";

interface State {
  points: readonly Point[];
  way: "own" | "fan" | "ears";
  apex: number;
  /** The ends of each cut, one after the other. */
  cuts: readonly number[];
}

type Pair = [number, number];

interface Cutting {
  triangles: [number, number, number][];
  folded: number;
  is_folded: boolean[];
}

interface Answer {
  needed: number;
  is_convex: boolean;
  is_simple: boolean;
  area: number;
  fan: Cutting;
  ears: Cutting;
  pieces: number[][];
  made: Pair[];
  allowed: Pair[];
  cut_off: number;
}

const SHAPES: Record<"convex" | "arrow" | "comb", readonly Point[]> = {
  convex: [
    [3.4, 1],
    [7.6, 0.9],
    [10.3, 3],
    [9.8, 5.8],
    [6.6, 7.2],
    [3, 6.6],
    [1.5, 3.8],
  ],
  arrow: [
    [1.2, 3],
    [6.2, 3],
    [6.2, 1],
    [10.8, 4],
    [6.2, 7],
    [6.2, 5],
    [1.2, 5],
  ],
  comb: [
    [1.2, 1.2],
    [10.8, 1.2],
    [10.8, 6.8],
    [8.4, 3.2],
    [6.6, 6.8],
    [5.2, 3.2],
    [3.4, 6.8],
    [1.6, 3.6],
  ],
};
const defaults: State = { points: SHAPES.convex, way: "own", apex: 0, cuts: [] };
const MOST = 12;

interface Texts extends CommonTexts {
  figure: string;
  corner(name: string): string;
  at(x: string, y: string): string;
  shape: string;
  shapes: Record<keyof typeof SHAPES, string>;
  more: string;
  fewer: string;
  way: string;
  ways: Record<State["way"], string>;
  apex: string;
  cut(name: string): string;
  undo(name: string): string;
  possible: string;
  none: string;
  reset: string;
  labelOwn: string;
  ofNeeded(n: string, needed: string): string;
  labelFan: string;
  labelEars: string;
  left(n: number): string;
  complete(corners: string, needed: string): string;
  stuck: string;
  fanWorks: string;
  fanFails(n: number): string;
  earsWork(needed: string): string;
  crosses: string;
  corners: string;
  needed: string;
  kind: string;
  convex: string;
  concave: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "Press a dashed line to cut along it, and a cut to undo it. Drag the corners.{keys} Tab to a corner and use the arrow keys; the cuts are buttons, too.",
    figure: "A polygon with its diagonals; corners can be moved, diagonals can be cut",
    corner: (name) => `Corner ${name}`,
    at: (x, y) => `x ${x}, y ${y}`,
    shape: "Begin with",
    shapes: { convex: "a convex one", arrow: "an arrow", comb: "a comb" },
    more: "One corner more",
    fewer: "One corner fewer",
    way: "Who cuts",
    ways: { own: "you", fan: "a fan", ears: "ear clipping" },
    apex: "The fan starts at",
    cut: (name) => `Cut ${name}`,
    undo: (name) => `Undo ${name}`,
    possible: "Diagonals that can be cut",
    none: "No diagonal is left: every piece is a triangle.",
    reset: "Undo all cuts",
    labelOwn: "Triangles cut off so far",
    ofNeeded: (n, needed) => `${n} of ${needed}`,
    labelFan: "Triangles of the fan that fold over",
    labelEars: "Triangles by ear clipping",
    left: (n) => `Choose a diagonal: ${n === 1 ? "one triangle is" : `${n} triangles are`} still missing.`,
    complete: (corners, needed) => `Complete. ${corners} corners give ${needed} triangles, whichever diagonals you choose.`,
    stuck: "The polygon crosses itself: it has no inside that triangles could fill.",
    fanWorks: "All triangles face the same way and fill the polygon.",
    fanFails: (n) =>
      n === 1
        ? "One triangle faces the other way: it reaches outside the polygon, or covers what another one covers."
        : `${n} triangles face the other way: they reach outside the polygon, or cover what others cover.`,
    earsWork: (needed) => `${needed} triangles, none folded: every polygon that does not cross itself has an ear to cut off.`,
    crosses: "The polygon crosses itself, so some triangle has to fold.",
    corners: "Corners",
    needed: "Triangles needed",
    kind: "Shape",
    convex: "convex",
    concave: "concave",
    story: [
      "A polygon of n corners needs *n − 2* triangles, and which diagonals one chooses makes no difference: each cut turns one piece into two, and adds the two corners at its ends once more. Nothing is lost by storing only triangles.",
      "If a polygon is *convex*, all diagonals out of one corner will do: a *triangle fan*. Beyond a concave corner the fan leaves the polygon, and its triangles fold back. They are the red ones, and a renderer would draw them.",
      "*Ear clipping* always works: an ear is a corner whose neighbours can be joined by a diagonal, and every polygon with more than three corners has at least two (G. H. Meisters, 1975). Cut one off, and the rest is a polygon again. Whether a diagonal is inside is decided exactly here, not within a tolerance.",
    ],
    attempts: [
      "Cut the heptagon in two different ways, and count the triangles.",
      "Take the arrow and a fan. From which corners does it work? Then let ear clipping do it.",
    ],
  },
  zh: {
    hint: "点虚线就沿它剖开，点实线则取消。顶点可以拖动。{keys}按 Tab 选中顶点，再按方向键；每条对角线另有按钮。",
    figure: "多边形及其对角线；顶点可以移动，对角线可以剖开",
    corner: (name) => `顶点 ${name}`,
    at: (x, y) => `x ${x}，y ${y}`,
    shape: "从哪个形状开始",
    shapes: { convex: "凸多边形", arrow: "箭头", comb: "梳子" },
    more: "多一个顶点",
    fewer: "少一个顶点",
    way: "由谁来剖分",
    ways: { own: "自己动手", fan: "扇形", ears: "耳切法" },
    apex: "扇形从哪个顶点出发",
    cut: (name) => `剖开 ${name}`,
    undo: (name) => `取消 ${name}`,
    possible: "还能剖开的对角线",
    none: "没有对角线可剖了：每一块都是三角形。",
    reset: "取消全部",
    labelOwn: "已经切出的三角形",
    ofNeeded: (n, needed) => `${n} / ${needed}`,
    labelFan: "扇形中翻折的三角形",
    labelEars: "耳切法得到的三角形",
    left: (n) => `再选一条对角线，还差 ${n} 个三角形。`,
    complete: (corners, needed) => `完成。${corners} 个顶点总是得到 ${needed} 个三角形，选哪几条对角线都一样。`,
    stuck: "多边形与自身相交：没有一个说得清的内部可以填。",
    fanWorks: "三角形方向一致，恰好铺满多边形。",
    fanFails: (n) => `有 ${n} 个三角形方向相反：它们伸到多边形外面，或与别的三角形重叠。`,
    earsWork: (needed) => `${needed} 个三角形，没有一个翻折：不自交的多边形总有“耳朵”可切。`,
    crosses: "多边形与自身相交，总会有三角形翻折。",
    corners: "顶点数",
    needed: "需要的三角形",
    kind: "形状",
    convex: "凸",
    concave: "凹",
    story: [
      "n 个顶点的多边形恰好剖成 *n − 2* 个三角形，与选哪几条对角线无关：每剖一刀，一块变成两块，两个端点各多算一次。只存三角形，什么也没有丢。",
      "*凸*多边形最省事：从一个顶点向其余顶点连线，就是*三角形扇*。遇到凹进去的顶点，扇形会伸到多边形外面，三角形随之翻折，就是图中红色的那些；渲染器会照画不误。",
      "*耳切法*总能成功：若某个顶点的两个邻点之间可以连一条对角线，它就是一只“耳朵”；多于三个顶点的多边形至少有两只（G. H. Meisters，1975）。切掉一只，剩下的仍是多边形。对角线是否在内部，这里用精确算术判定，不靠容差。",
    ],
    attempts: [
      "用两种不同的方法剖开七边形，数一数三角形。",
      "选箭头和扇形：从哪些顶点出发行得通？再交给耳切法。",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
const nameOf = (i: number) => "ABCDEFGHIJKL"[i]!;
const pairName = ([a, b]: Pair) => `${nameOf(a)}–${nameOf(b)}`;
const isSame = ([a, b]: Pair, [c, d]: Pair) => (a === c && b === d) || (a === d && b === c);
const pairsOf = (cuts: readonly number[]): Pair[] => Array.from({ length: cuts.length >> 1 }, (_, i) => [cuts[2 * i]!, cuts[2 * i + 1]!]);
const without = (cuts: readonly number[], pair: Pair) => pairsOf(cuts).filter((other) => !isSame(other, pair)).flat();

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill } = page;
  const { points } = state;
  const corners = (rows: readonly number[]) => rows.map((i) => points[i]!);
  const middle = points.reduce(([x, y], p) => [x + p[0] / points.length, y + p[1] / points.length], [0, 0] as Point);
  const cutting = state.way === "fan" ? answer.fan : answer.ears;
  const line = (pair: Pair) => path(corners(pair), false);
  return (
    <Flat name={texts.figure}>
      {state.way === "own"
        ? answer.pieces.map((piece, i) => <path key={i} class={piece.length === 3 ? "piece done" : "piece"} d={path(corners(piece))} />)
        : cutting.triangles.map((rows, i) => <path key={i} class={cutting.is_folded[i] ? "piece folded" : "piece done"} d={path(corners(rows))} />)}
      <path class="outline" d={path(points)} />
      {state.way === "own" && (
        <>
          {answer.allowed.map((pair) => (
            <g key={pairName(pair)} class="diagonal target" onClick={() => set(({ cuts }) => ({ cuts: [...cuts, ...pair] }))}>
              <path class="hit" d={line(pair)} />
              <path class="dashed" d={line(pair)} />
            </g>
          ))}
          {answer.made.map((pair) => (
            <g key={pairName(pair)} class="diagonal target" onClick={() => set(({ cuts }) => ({ cuts: without(cuts, pair) }))}>
              <path class="hit" d={line(pair)} />
              <path class="cut" d={line(pair)} />
            </g>
          ))}
        </>
      )}
      {points.map((corner, i) => {
        const [dx, dy] = [corner[0] - middle[0], corner[1] - middle[1]];
        const far = 0.5 / (Math.hypot(dx, dy) || 1);
        const [x, y] = at([corner[0] + dx * far, corner[1] + dy * far - 0.1]).split(" ");
        return (
          <text key={i} class="label" x={x} y={y}>
            {nameOf(i)}
          </text>
        );
      })}
      {points.map((corner, i) => (
        <Dot
          key={i}
          name={texts.corner(nameOf(i))}
          spoken={texts.at(say.fixed(corner[0]), say.fixed(corner[1]))}
          place={corner}
          isStill={isStill}
          reach={20}
          move={(change) => set(({ points }) => ({ points: points.map((old, k) => (k === i ? change(old) : old)) }))}
        />
      ))}
    </Flat>
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  const { needed, cut_off, fan, ears, is_simple } = answer;
  if (state.way === "own") {
    const isDone = cut_off === needed;
    return {
      value: cut_off,
      shown: texts.ofNeeded(say.whole(cut_off), say.whole(needed)),
      label: texts.labelOwn,
      meaning: isDone
        ? texts.complete(say.whole(state.points.length), say.whole(needed))
        : is_simple
          ? texts.left(needed - cut_off)
          : texts.stuck,
      tone: isDone ? "good" : is_simple ? "plain" : "bad",
    };
  }
  if (state.way === "fan") {
    return {
      value: fan.folded,
      shown: say.whole(fan.folded),
      label: texts.labelFan,
      meaning: fan.folded ? texts.fanFails(fan.folded) : texts.fanWorks,
      tone: fan.folded ? "bad" : "good",
    };
  }
  return {
    value: ears.triangles.length,
    shown: say.whole(ears.triangles.length),
    label: texts.labelEars,
    meaning: is_simple ? texts.earsWork(say.whole(needed)) : texts.crosses,
    tone: is_simple ? "good" : "bad",
  };
}

/** The polygon with a new corner in the middle of its longest side. */
function withCorner(points: readonly Point[]): readonly Point[] {
  const side = (i: number) => [points[i]!, points[(i + 1) % points.length]!] as const;
  const length = (i: number) => Math.hypot(side(i)[1][0] - side(i)[0][0], side(i)[1][1] - side(i)[0][1]);
  const longest = points.reduce((best, _, i) => (length(i) > length(best) ? i : best), 0);
  const [a, b] = side(longest);
  return [...points.slice(0, longest + 1), kept([(a[0] + b[0]) / 2, (a[1] + b[1]) / 2]), ...points.slice(longest + 1)];
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const begin = (points: readonly Point[]) => set({ points, cuts: [], apex: 0 });
  return (
    <>
      <Choice
        name="way"
        legend={texts.way}
        value={state.way}
        options={(["own", "fan", "ears"] as const).map((value) => ({ value, label: texts.ways[value] }))}
        choose={(way) => set({ way })}
      />
      {state.way === "own" && (
        <div>
          <p class="aside">{answer.allowed.length ? texts.possible : texts.none}</p>
          <div class="buttons">
            {answer.allowed.map((pair) => (
              <button key={pairName(pair)} type="button" aria-label={texts.cut(pairName(pair))} onClick={() => set(({ cuts }) => ({ cuts: [...cuts, ...pair] }))}>
                {pairName(pair)}
              </button>
            ))}
            {answer.made.map((pair) => (
              <button key={pairName(pair)} type="button" class="made" aria-label={texts.undo(pairName(pair))} onClick={() => set(({ cuts }) => ({ cuts: without(cuts, pair) }))}>
                {pairName(pair)} ×
              </button>
            ))}
          </div>
        </div>
      )}
      {state.way === "fan" && (
        <Choice
          name="apex"
          legend={texts.apex}
          value={state.apex}
          options={state.points.map((_, value) => ({ value, label: nameOf(value) }))}
          choose={(apex) => set({ apex })}
        />
      )}
      <div>
        <p class="aside">{texts.shape}</p>
        <div class="buttons">
          {(["convex", "arrow", "comb"] as const).map((shape) => (
            <button key={shape} type="button" onClick={() => begin(SHAPES[shape])}>
              {texts.shapes[shape]}
            </button>
          ))}
          <button type="button" disabled={state.points.length === MOST} onClick={() => begin(withCorner(state.points))}>
            {texts.more}
          </button>
          <button type="button" disabled={state.points.length === 3} onClick={() => begin(state.points.slice(0, -1))}>
            {texts.fewer}
          </button>
          {state.cuts.length > 0 && (
            <button type="button" onClick={() => set({ cuts: [] })}>
              {texts.reset}
            </button>
          )}
        </div>
      </div>
      <dl>
        <div>
          <dt>{texts.corners}</dt>
          <dd>{say.whole(state.points.length)}</dd>
        </div>
        <Row name="needed" label={texts.needed} value={answer.needed}>
          {say.whole(answer.needed)}
        </Row>
        <div>
          <dt>{texts.kind}</dt>
          <dd>{answer.is_convex ? texts.convex : texts.concave}</dd>
        </div>
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    points: ["p", points<Point>(3, MOST, [[0, FLAT.width], [0, FLAT.height]])],
    way: ["b", word("own", "fan", "ears")],
    apex: ["a", number(0, MOST - 1)],
    cuts: ["c", numbers(0, 2 * MOST, number(0, MOST - 1))],
  },
  // An address may name corners that its polygon does not have.
  question: ({ points, apex, cuts }) => ({ points, apex: Math.min(apex, points.length - 1), cuts: pairsOf(cuts) }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
