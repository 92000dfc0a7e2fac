// Two shapes under minimum and maximum: the sign is right everywhere, but the value is not a distance everywhere.
import { Choice, Row } from "../view/parts";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { Dot, FLAT, Flat, type Point, toSvg } from "./Flat";
import { point, word } from "./fragment";
import { px } from "./Grip";
import { type Region, Regions, outline } from "./Regions";
import type { Language } from "./say";

type Operation = "union" | "intersection" | "difference";

interface State {
  probe: Point;
  disc: Point;
  slab: Point;
  operation: Operation;
}

interface Answer {
  levels: Region[];
  wrong: Region[];
  parts: [Region[], Region[]];
  of: [number, number];
  value: number;
  truth: number;
  share: number | null;
  quality: { outside: string; inside: string };
}

const defaults: State = { probe: [6.1, 4.3], disc: [4.6, 4.3], slab: [7.2, 3.8], operation: "union" };

interface Texts extends CommonTexts {
  figure: string;
  probe: string;
  shapes: readonly [string, string];
  at(x: string, y: string): string;
  legend: string;
  operation: Record<Operation, string>;
  rule: Record<Operation, string>;
  label: string;
  surface: string;
  exact(truth: string): string;
  less(value: string, truth: string): string;
  value: string;
  truth: string;
  of: readonly [string, string];
  says(side: string, what: string): string;
  outside: string;
  inside: string;
  known: Record<string, string>;
  wrong: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "Drag the point and both shapes.{keys} Arrow keys move them, with Shift by small steps; Page Up and Page Down by large ones.",
    figure: "A disc and a rectangle combined, with lines of equal value; red where the value is not a distance",
    probe: "The probe",
    shapes: ["Disc A", "Rectangle B"],
    at: (x, y) => `x ${x}, y ${y}`,
    legend: "Disc A and rectangle B",
    operation: { union: "union", intersection: "intersection", difference: "A without B" },
    rule: { union: "min(a, b)", intersection: "max(a, b)", difference: "max(a, −b)" },
    label: "Value as a share of the true distance",
    surface: "The probe is on the surface: both are zero.",
    exact: (truth) => `Here the value is the distance, ${truth}: both circles coincide.`,
    less: (value, truth) =>
      `The value says ${value}, the nearest point of the surface is ${truth} away. Still safe: the value is never larger.`,
    value: "Value",
    truth: "True distance",
    of: ["Value of A", "Value of B"],
    says: (side, what) => `${side} ${what}`,
    outside: "Known outside:",
    inside: "Known inside:",
    known: { "exact distance": "the exact distance", "lower bound": "a lower bound of it" },
    wrong: "red: the value is not a distance",
    story: [
      "On fields a boolean is one line. The union contains points in either shape: *min(a, b)*. The intersection contains points in both: *max(a, b)*. A without B is *max(a, −b)*. The sign is right everywhere; the value is not. Inside a union the nearest surface of a part may be covered by the other, and the value is *smaller in size* than the distance.",
      "Likewise outside an intersection: the nearest point of one part may not lie in the other. On two meshes a boolean has to intersect their triangles, and cracks if rounding goes wrong.",
      "A smaller value is harmless for sphere tracing, which only takes shorter steps. It matters for shells, offsets and rounded edges, which rely on the value. The core tracks this on either side: exact, bound, or only a sign.",
      "The true distance is measured to the outline of the result, traced within a thousandth of a unit.",
    ],
    attempts: [
      "Union: move the probe from A to B through the red. To which hidden surface does the value still refer?",
      "A without B: find the point outside where the value is farthest from the truth.",
    ],
  },
  zh: {
    hint: "拖动测试点和两个形状。{keys}方向键移动，加 Shift 走小步，Page Up 和 Page Down 走大步。",
    figure: "圆盘与矩形的组合及其等值线；红色处的值不是距离",
    probe: "测试点",
    shapes: ["圆盘 A", "矩形 B"],
    at: (x, y) => `x ${x}，y ${y}`,
    legend: "圆盘 A 与矩形 B",
    operation: { union: "并", intersection: "交", difference: "A 减 B" },
    rule: { union: "min(a, b)", intersection: "max(a, b)", difference: "max(a, −b)" },
    label: "值与真实距离之比",
    surface: "测试点在表面上：两者都是零。",
    exact: (truth) => `这里的值就是距离 ${truth}：两个圆重合。`,
    less: (value, truth) => `值为 ${value}，而到表面最近点的距离是 ${truth}。仍然安全：值从不大于距离。`,
    value: "值",
    truth: "真实距离",
    of: ["A 的值", "B 的值"],
    says: (side, what) => `${side}${what}`,
    outside: "核心所知，外部：",
    inside: "核心所知，内部：",
    known: { "exact distance": "精确距离", "lower bound": "下界" },
    wrong: "红色：值不是距离",
    story: [
      "对场来说，布尔运算只要一行。并集是至少属于其一：*min(a, b)*；交集是两者都属于：*max(a, b)*；A 减 B 是 *max(a, −b)*。符号处处正确，值却不然：在并集内部，某一部分最近的表面可能被另一部分盖住，这时值的大小*小于*距离。",
      "在交集外部也一样：某一部分的最近点可能不在另一部分里。换成两个网格，就要求所有三角形的交，舍入一出错便有裂缝。",
      "值偏小对球面追踪无害，只是步子变短。但对抽壳、偏移和倒圆角就有影响，它们直接把值当作距离。核心对内外两侧分别记账：精确、下界，或只有符号。",
      "真实距离是到结果轮廓的距离，轮廓的误差在千分之一个单位以内。",
    ],
    attempts: [
      "并：让测试点从 A 穿过红色区域到 B。这时值指的仍是哪一段被盖住的表面？",
      "A 减 B：在外部找出值偏离最大的点。",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
/** Values that differ by less than this share are treated as equal: the drawing shows no difference. */
const ALIKE = 0.02;
const isExact = ({ share }: Answer) => share === null || Math.abs(share - 1) < ALIKE;

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill } = page;
  const [x, y] = toSvg(state.probe).map(px);
  // In pixels: x is 0 at the left edge, so a length is the x of a point that far from it.
  const radius = (value: number) => px(toSvg([Math.abs(value), 0])[0]);
  return (
    <Flat name={texts.figure}>
      <Regions regions={answer.levels} />
      {answer.wrong.map(({ level, loops }) => (
        <path key={level} class="wrong" d={outline(loops)} fill-rule="evenodd" />
      ))}
      {answer.parts.map(([part], i) => (
        <path key={i} class="part" d={outline(part!.loops)} />
      ))}
      <circle class="truth" cx={x} cy={y} r={radius(answer.truth)} />
      <circle class="free" cx={x} cy={y} r={radius(answer.value)} />
      {(["disc", "slab"] as const).map((shape, i) => {
        const [cx, cy] = toSvg(state[shape]);
        return (
          <g key={shape}>
            <text class="label" x={px(cx)} y={px(cy - 20)}>
              {"AB"[i]}
            </text>
            <Dot
              name={texts.shapes[i]!}
              spoken={texts.at(say.fixed(state[shape][0]), say.fixed(state[shape][1]))}
              place={state[shape]}
              isStill={isStill}
              isFaint
              move={(change) => set((state) => ({ [shape]: change(state[shape]) }))}
            />
          </g>
        );
      })}
      <Dot
        name={texts.probe}
        spoken={`${texts.at(say.fixed(state.probe[0]), say.fixed(state.probe[1]))}${say.marks.stop}${liveNumber(page).meaning}`}
        place={state.probe}
        isStill={isStill}
        move={(change) => set(({ probe }) => ({ probe: change(probe) }))}
      />
    </Flat>
  );
}

function liveNumber({ answer, say, texts }: Page): LiveNumber {
  const { share } = answer;
  const [value, truth] = [say.fixed(Math.abs(answer.value)), say.fixed(Math.abs(answer.truth))];
  return {
    value: share,
    shown: share === null ? "—" : say.percent(share),
    label: texts.label,
    meaning: share === null ? texts.surface : isExact(answer) ? texts.exact(truth) : texts.less(value, truth),
    tone: isExact(answer) ? "good" : "bad",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const rows = [
    ["value", texts.value, answer.value],
    ["truth", texts.truth, answer.truth],
    ["a", texts.of[0], answer.of[0]],
    ["b", texts.of[1], answer.of[1]],
  ] as const;
  return (
    <>
      <Choice
        name="operation"
        legend={texts.legend}
        value={state.operation}
        options={(["union", "intersection", "difference"] as const).map((value) => ({
          value,
          label: texts.operation[value],
          extra: <small> {texts.rule[value]}</small>,
        }))}
        choose={(operation) => set({ operation })}
      />
      <dl>
        {rows.map(([name, label, value]) => (
          <Row key={name} name={name} label={label} value={value}>
            {say.fixed(value)}
          </Row>
        ))}
      </dl>
      <p class="aside">
        {texts.says(texts.outside, texts.known[answer.quality.outside] ?? answer.quality.outside)}
        <br />
        {texts.says(texts.inside, texts.known[answer.quality.inside] ?? answer.quality.inside)}
      </p>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    probe: ["p", point([0, FLAT.width], [0, FLAT.height])],
    disc: ["a", point([0, FLAT.width], [0, FLAT.height])],
    slab: ["c", point([0, FLAT.width], [0, FLAT.height])],
    operation: ["b", word("union", "intersection", "difference")],
  },
  question: ({ operation, disc, slab, probe }) => ({ operation, parts: [disc, slab], point: probe }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
