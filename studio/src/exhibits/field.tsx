// One shape in both forms: a function that can be evaluated at any point, and a mesh of its outline.
import { Choice, Row, Slider } from "../view/parts";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { Dot, FLAT, Flat, type Point, at, path, toSvg } from "./Flat";
import { number, point, word } from "./fragment";
import { FRAME } from "./frame_texts";
import { px } from "./Grip";
import { type Loops, type Region, Regions, outline } from "./Regions";
import type { Language } from "./say";

interface State {
  probe: Point;
  asked: "field" | "mesh";
  stop: number;
}

type Normal = readonly [number, number, number] | null;

interface Answer {
  levels: Region[];
  value: number;
  normal: Normal;
  quality: { outside: string; inside: string };
  mesh: {
    loops: Loops;
    edges: number;
    bound: number;
    distance: number;
    normal: Normal;
    winding: number | null;
    crossings: [Point, 1 | -1][];
  };
  apart: number;
}

/** The stops of the slider: the largest error of the mesh. */
const STOPS = [0.8, 0.4, 0.2, 0.1, 0.05, 0.02, 0.01] as const;
const defaults: State = { probe: [11, 7.2], asked: "field", stop: 2 };

interface Texts extends CommonTexts {
  figure: string;
  probe: string;
  at(x: string, y: string): string;
  asked: string;
  field: string;
  mesh: string;
  label: Record<State["asked"], string>;
  inside: string;
  outside: string;
  byField(side: string): string;
  byMesh(side: string, sum: string, edges: string): string;
  unsure: string;
  finer: string;
  edges(n: string): string;
  other: Record<State["asked"], string>;
  apart: string;
  proved: string;
  evaluations: string;
  normal: string;
  none: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: FRAME.en.drag,
    figure: "A rounded frame around a hole, the lines of equal distance to it, and a point to move",
    probe: "The point",
    at: (x, y) => `x ${x}, y ${y}`,
    asked: "Ask",
    field: "the field",
    mesh: "the mesh",
    label: { field: "Signed distance, by the field", mesh: "Signed distance, by the mesh" },
    inside: "inside",
    outside: "outside",
    byField: (side) =>
      `Its sign says ${side}, and the circle of that radius touches the shape. The gradient is the normal there. That took one evaluation.`,
    byMesh: (side, sum, edges) =>
      `Edges that the ray crosses upward count +1, downward −1. The sum is ${sum}: ${side}. For that, and for the distance, all ${edges} edges were tested.`,
    unsure: "The point lies on the mesh, or the ray meets a corner.",
    finer: "The mesh may be off by",
    edges: (n) => `${n} edges`,
    other: { field: "By the mesh", mesh: "By the field" },
    apart: "The two differ by",
    proved: "at most, proved",
    evaluations: "Edges of the mesh",
    normal: "Normal",
    none: "none",
    story: [
      "A mesh lists points on a shape, which can be drawn at once. A distance field is a rule that can be evaluated at any point: inside is *one sign*, the size is the distance, and the gradient is the normal of the nearest point. The mesh has to be searched: a ray leaves the point, and the edges that it crosses are counted by their direction.",
      "For this frame the rule is one line: the distance to a rounded rectangle, its absolute value, minus half of the wall. For the mesh, the distance is the smallest of the distances to all edges. Trees make the search fast, but they have to be built.",
      "A mesh of a round shape has an error. The core proves a bound on it, so the two distances differ by no more than that.",
    ],
    attempts: [
      "Move the point into the hole. Both say outside: which of the two had to count?",
      "Ask the mesh, allow an error of 0.8, and follow the rounded corners: there the two differ.",
    ],
  },
  zh: {
    hint: FRAME.zh.drag,
    figure: "一个带孔的圆角框、到它的等距线，以及一个可移动的点",
    probe: "测试点",
    at: (x, y) => `x ${x}，y ${y}`,
    asked: "询问",
    field: "场",
    mesh: "网格",
    label: { field: "有向距离（由场给出）", mesh: "有向距离（由网格给出）" },
    inside: "内部",
    outside: "外部",
    byField: (side) => `由符号可知在${side}；以这个距离为半径的圆与形状相切，梯度就是那里的法线。只求了一次函数值。`,
    byMesh: (side, sum, edges) =>
      `射线向上穿过的边记 +1，向下记 −1，总和为 ${sum}：在${side}。为此以及为求距离，${edges} 条边都要检查。`,
    unsure: "点在网格上，或射线恰好经过顶点。",
    finer: "网格允许的误差",
    edges: (n) => `${n} 条边`,
    other: { field: "由网格给出", mesh: "由场给出" },
    apart: "两者相差",
    proved: "已证明的上界",
    evaluations: "网格的边数",
    normal: "法线",
    none: "无",
    story: [
      "网格列出形状上的点，拿来就能画。距离场是一条规则，任何点都能代入：内外*只看一个符号*，绝对值就是距离，梯度就是最近点处的法线。网格则要搜索：从点出发作一条射线，按方向给穿过的边计数。",
      "这个框的规则只有一行：到圆角矩形的距离取绝对值，再减去壁厚的一半。网格的距离是到所有边的距离中最小的；用树可以加速，但树要先建好。",
      "用网格表示圆的东西，总有误差。核心证明了误差的上界，所以两种距离之差不会超过它。",
    ],
    attempts: [
      "把点移进孔里：两者都说在外部。哪一个需要计数？",
      "询问网格，允许误差取 0.8，沿圆角移动：两者在那里有差别。",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
const sideOf = ({ answer, state, texts }: Page) =>
  (state.asked === "field" ? answer.value : answer.mesh.distance) < 0 ? texts.inside : texts.outside;

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill } = page;
  const { probe, asked } = state;
  const { mesh } = answer;
  const [value, normal] = asked === "field" ? [answer.value, answer.normal] : [mesh.distance, mesh.normal];
  const [x, y] = toSvg(probe);
  return (
    <Flat name={texts.figure}>
      <Regions regions={answer.levels} class={asked === "mesh" ? "faint" : ""} />
      {asked === "mesh" && (
        <g class="polygon">
          <path d={outline(mesh.loops)} fill-rule="evenodd" />
          {mesh.loops.flatMap((line) =>
            Array.from({ length: line.length / 2 }, (_, i) => {
              const [cx, cy] = toSvg([line[2 * i]!, line[2 * i + 1]!]);
              return <circle key={i} cx={px(cx)} cy={px(cy)} r="2.6" />;
            }),
          )}
          <path class="ray" d={path([probe, [FLAT.width, probe[1]]], false)} />
          {mesh.crossings.map(([place, turn]) => {
            const [cx, cy] = toSvg(place);
            return (
              <g key={cx} class={turn > 0 ? "up" : "down"}>
                <circle cx={px(cx)} cy={px(cy)} r="6" />
                <text class="label" x={px(cx)} y={px(cy - 12)}>
                  {turn > 0 ? "+1" : "−1"}
                </text>
              </g>
            );
          })}
        </g>
      )}
      <circle class="free" cx={px(x)} cy={px(y)} r={px(toSvg([Math.abs(value), 0])[0])} />
      {normal && <Arrow probe={probe} value={value} normal={normal} />}
      <Dot
        name={texts.probe}
        spoken={`${texts.at(say.fixed(probe[0]), say.fixed(probe[1]))}${say.marks.stop}${say.fixed(value)}${say.marks.colon}${sideOf(page)}`}
        place={probe}
        isStill={isStill}
        move={(change) => set(({ probe }) => ({ probe: change(probe) }))}
      />
    </Flat>
  );
}

/** An arrow from the point to the nearest point of the shape, and the normal there. */
function Arrow({ probe, value, normal: [nx, ny] }: { probe: Point; value: number; normal: NonNullable<Normal> }) {
  const foot: Point = [probe[0] - value * nx, probe[1] - value * ny];
  const on = (along: number, aside = 0): Point => [
    foot[0] + along * nx - aside * ny,
    foot[1] + along * ny + aside * nx,
  ];
  return (
    <g class="normal">
      <path class="way" d={path([probe, foot], false)} />
      <path d={`M${at(foot)}L${at(on(0.85))}M${at(on(0.62, 0.14))}L${at(on(0.85))}L${at(on(0.62, -0.14))}`} />
    </g>
  );
}

function liveNumber(page: Page): LiveNumber {
  const { state, answer, say, texts } = page;
  const { mesh } = answer;
  const isField = state.asked === "field";
  const value = isField ? answer.value : mesh.distance;
  const meaning = isField
    ? texts.byField(sideOf(page))
    : mesh.winding === null
      ? texts.unsure
      : texts.byMesh(sideOf(page), String(mesh.winding), String(mesh.edges));
  return {
    value,
    shown: say.fixed(value) + (isField ? "" : ` ± ${say.number(mesh.bound)}`),
    label: texts.label[state.asked],
    meaning,
    tone: "plain",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const { mesh } = answer;
  const other = state.asked === "field" ? mesh.distance : answer.value;
  const normal = state.asked === "field" ? answer.normal : mesh.normal;
  return (
    <>
      <Choice
        name="asked"
        legend={texts.asked}
        value={state.asked}
        options={[
          { value: "field", label: texts.field },
          { value: "mesh", label: texts.mesh },
        ]}
        choose={(asked) => set({ asked })}
      />
      <Slider
        id="length"
        label={texts.finer}
        shown={say.number(STOPS[state.stop]!)}
        spoken={`${say.number(STOPS[state.stop]!)}, ${texts.edges(String(mesh.edges))}`}
        low={0}
        high={STOPS.length - 1}
        value={state.stop}
        choose={(stop) => set({ stop })}
      />
      <dl>
        <Row name="other" label={texts.other[state.asked]} value={other}>
          {say.fixed(other)}
        </Row>
        <Row name="apart" label={texts.apart} value={answer.apart}>
          {say.fixed(answer.apart, 3)}
        </Row>
        <Row name="bound" label={texts.proved} value={mesh.bound}>
          {say.fixed(mesh.bound, 3)}
        </Row>
        <Row name="edges" label={texts.evaluations} value={mesh.edges}>
          {String(mesh.edges)}
        </Row>
        <div>
          <dt>{texts.normal}</dt>
          <dd>{normal ? `(${say.fixed(normal[0])}, ${say.fixed(normal[1])})` : texts.none}</dd>
        </div>
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    probe: ["p", point([0, FLAT.width], [0, FLAT.height])],
    asked: ["a", word("field", "mesh")],
    stop: ["n", number(0, STOPS.length - 1)],
  },
  question: (state) => ({ point: state.probe, length: STOPS[state.stop] }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
