// Triangles over a grid of pixels: each pixel asks the three edge functions at its centre, and blends the corners' colours.
import { Choice, Row } from "../view/parts";
import { css } from "../viewer/color";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { Dot, FLAT, Flat, type Point, at, kept, path, toSvg } from "./Flat";
import { point, points, word } from "./fragment";
import { Grip, px } from "./Grip";
import { CORNERS } from "./paint";
import type { Language } from "./say";

interface State {
  corners: readonly Point[];
  count: "1" | "2";
  size: "large" | "small";
  rule: "top-left" | "closed" | "open";
  show: "signs" | "colors";
  pixel: Point;
}

interface Chosen {
  edges: [number, number, number];
  weights: [number, number, number] | null;
  is_filled: boolean;
}

interface Answer {
  columns: number;
  rows: number;
  owners: Uint32Array;
  signs: Uint32Array;
  colors: Float32Array;
  covered: number;
  twice: number;
  missed: number;
  area: number;
  is_folded: boolean;
  chosen: Chosen[];
}

/** Corners stay on quarters of a large pixel. GPUs round them, too, to a 256th. */
const LATTICE = 0.25;
const COLUMNS = { large: 12, small: 24 } as const;
const defaults: State = {
  corners: [
    [1.5, 1.25],
    [10.25, 2],
    [7.5, 7],
    [2, 6.25],
  ],
  count: "1",
  size: "large",
  rule: "top-left",
  show: "signs",
  pixel: [5, 3],
};

interface Texts extends CommonTexts {
  figure: string;
  corner(name: string): string;
  chosenPixel: string;
  at(x: string, y: string): string;
  place(column: string, row: string): string;
  count: string;
  one: string;
  two: string;
  size: string;
  sizes: Record<State["size"], string>;
  rule: string;
  rules: Record<State["rule"], string>;
  show: string;
  signs: string;
  colors: string;
  label: string;
  of(n: string): string;
  area: string;
  twice: string;
  missed: string;
  edge(name: string): string;
  weight(name: string): string;
  centres(covered: string, area: string): string;
  once: string;
  doubled(n: string): string;
  gaps(n: string): string;
  folded: string;
  inside: string;
  outside: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "Drag a corner, or the square from pixel to pixel.{keys} Tab to one of them, then the arrow keys.",
    figure: "A grid of pixels with triangles over it; corners and a chosen pixel can be moved",
    corner: (name) => `Corner ${name}`,
    chosenPixel: "The chosen pixel",
    at: (x, y) => `x ${x}, y ${y}`,
    place: (column, row) => `column ${column}, row ${row}`,
    count: "Triangles",
    one: "one",
    two: "two that share an edge",
    size: "Pixels",
    sizes: { large: "large", small: "small" },
    rule: "A centre exactly on an edge",
    rules: { "top-left": "by the top-left rule", closed: "counts for both", open: "counts for neither" },
    show: "Show",
    signs: "signs",
    colors: "colours",
    label: "Pixels filled",
    of: (n) => n,
    area: "Area, in pixels",
    twice: "Filled twice",
    missed: "Missed on the shared edge",
    edge: (name) => `Edge function ${name}`,
    weight: (name) => `Weight of ${name}`,
    centres: (covered, area) => `${covered} centres lie in a triangle of ${area} pixels of area.`,
    once: "Every pixel of the two triangles is filled exactly once.",
    doubled: (n) => `${n} centres lie on the shared edge and are filled twice. If the triangles are transparent, a bright seam shows.`,
    gaps: (n) => `${n} centres lie on the shared edge and belong to nobody: a row of holes.`,
    folded: "D is on the same side of A–C as B: the triangles overlap, and no rule can help.",
    inside: "filled",
    outside: "not filled",
    story: [
      "To draw a triangle is to *rasterize* it: every pixel asks whether its centre is inside. The question is the one of the stop before, three *edge functions* with one sign, and each pixel can be asked by itself. So a GPU asks thousands at once.",
      "An edge function changes by the same amount from each pixel to the next, so after the first pixel each costs one addition. Divided by the triangle’s double area the three are the *barycentric* weights, so the test has already computed what blends colours, depth and texture coordinates.",
      "Two triangles that share an edge also share the pixels whose centres lie exactly on it. The *top-left rule* gives each to one: to the triangle that has it on a left or a top edge. In a closed mesh every pixel then has one owner, without a gap and without a second coat.",
    ],
    attempts: [
      "Choose two triangles and let the centres on the edge count for both, then for neither. Which pixels change?",
      "Make a triangle so thin that no pixel is filled, although its area is not zero.",
    ],
  },
  zh: {
    hint: "拖动顶点，或把方框从一个像素拖到另一个。{keys}按 Tab 选中，再按方向键移动。",
    figure: "像素网格上的三角形；顶点和选中的像素都能移动",
    corner: (name) => `顶点 ${name}`,
    chosenPixel: "选中的像素",
    at: (x, y) => `x ${x}，y ${y}`,
    place: (column, row) => `第 ${column} 列，第 ${row} 行`,
    count: "三角形",
    one: "一个",
    two: "两个，共用一条边",
    size: "像素",
    sizes: { large: "大", small: "小" },
    rule: "中心恰好落在边上时",
    rules: { "top-left": "按左上规则归属", closed: "两边都算", open: "两边都不算" },
    show: "显示",
    signs: "符号",
    colors: "颜色",
    label: "填充的像素",
    of: (n) => `${n} 个`,
    area: "面积（像素）",
    twice: "填了两次",
    missed: "公共边上漏填",
    edge: (name) => `边函数 ${name}`,
    weight: (name) => `${name} 的权重`,
    centres: (covered, area) => `三角形面积为 ${area} 个像素，有 ${covered} 个像素中心落在里面。`,
    once: "两个三角形的每个像素都恰好填一次。",
    doubled: (n) => `${n} 个中心落在公共边上，填了两次：半透明时会露出一条亮缝。`,
    gaps: (n) => `${n} 个中心落在公共边上，谁也不填：留下一排小孔。`,
    folded: "D 和 B 在 A–C 的同一侧：两个三角形重叠，什么规则都没用。",
    inside: "填充",
    outside: "不填",
    story: [
      "画三角形就是*光栅化*：每个像素都问一句，我的中心在里面吗？问法和上一站一样：三个*边函数*同号就在里面。各个像素互不相干，GPU 可以同时问成千上万个。",
      "走到相邻像素，边函数总是增减同一个数，所以第一个像素之后，每个只需一次加法。把三个值除以面积的两倍，就是*重心坐标*：判断内外的同时，混合颜色、深度和纹理坐标的权重也就有了。",
      "两个三角形共用一条边，中心恰好落在边上的像素归谁？*左上规则*：这条边对哪个三角形来说是左边或上边，就归哪个。于是封闭网格的每个像素只有一个主人，不漏也不重。",
    ],
    attempts: [
      "选两个三角形，让边上的中心两边都算，再改成都不算：哪些像素变了？",
      "把三角形压到极窄：面积不为零，却一个像素也填不上。",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
const NAMES = ["A", "B", "C", "D"] as const;
/** The edges opposite to the corners of each triangle, as the edge functions are. */
const EDGES = [
  ["BC", "CA", "AB"],
  ["CD", "DA", "AC"],
] as const;
const cornersOf = ({ corners, count }: State) => corners.slice(0, count === "1" ? 3 : 4);

function pixelNear([x, y]: Point, size: State["size"]): Point {
  const within = (value: number, count: number) => Math.min(Math.max(Math.round(value), 0), count - 1);
  return [within(x, COLUMNS[size]), within(y, (COLUMNS[size] * FLAT.height) / FLAT.width)];
}

/** The marks of the signs of all pixels, three in a row each: negative, zero, positive. */
function marksOf({ signs, columns, rows }: Answer): readonly [string, string, string] {
  const width = (FLAT.width * 60) / columns;
  const marks: [string, string, string] = ["", "", ""];
  const h = px(0.09 * width);
  const w = px(0.18 * width);
  signs.forEach((code, i) => {
    const [x, y] = [((i % columns) + 0.5) * width, (rows - Math.floor(i / columns) - 0.5) * width];
    for (let k = 0; k < 3; k++) {
      const sign = Math.floor(code / 3 ** (2 - k)) % 3;
      const [cx, cy] = [px(x + (k - 1) * 0.29 * width), px(y + 0.27 * width)];
      marks[sign] += sign === 1 ? `M${cx} ${cy}m-${h} 0a${h} ${h} 0 1 0 ${w} 0a${h} ${h} 0 1 0 -${w} 0` : `M${cx} ${cy}m-${h} 0h${w}${sign === 2 ? `m-${h} -${h}v${w}` : ""}`;
    }
  });
  return marks;
}

/** The squares of the pixels for which a condition holds, as one path. */
function squares({ owners, columns, rows }: Answer, holds: (owner: number) => boolean): string {
  const width = (FLAT.width * 60) / columns;
  let squares = "";
  owners.forEach((owner, i) => {
    if (holds(owner)) squares += `M${(i % columns) * width} ${(rows - 1 - Math.floor(i / columns)) * width}h${width}v${width}h-${width}z`;
  });
  return squares;
}

function Grid({ columns, rows }: Answer) {
  const width = (FLAT.width * 60) / columns;
  let lines = "";
  let centres = "";
  for (let i = 1; i < columns; i++) lines += `M${i * width} 0V${rows * width}`;
  for (let i = 1; i < rows; i++) lines += `M0 ${i * width}H${columns * width}`;
  for (let i = 0; i < columns * rows; i++) centres += `M${((i % columns) + 0.5) * width} ${(Math.floor(i / columns) + 0.5) * width}h0`;
  return (
    <>
      <path class="pixel-grid" d={lines} />
      <path class="pixel-centres" d={centres} />
    </>
  );
}

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill } = page;
  const corners = cornersOf(state);
  const { columns, rows, owners, colors } = answer;
  const width = (FLAT.width * 60) / columns;
  const middle = corners.reduce(([x, y], p) => [x + p[0] / corners.length, y + p[1] / corners.length], [0, 0] as Point);
  const marks = state.show === "signs" ? marksOf(answer) : undefined;
  const unit = FLAT.width / COLUMNS[state.size];
  const center: Point = [(state.pixel[0] + 0.5) * unit, (state.pixel[1] + 0.5) * unit];
  const [px0, py0] = toSvg(center);
  return (
    <Flat name={texts.figure}>
      {state.show === "colors" ? (
        [...owners].map((owner, i) =>
          owner ? (
            <rect
              key={i}
              x={(i % columns) * width}
              y={(rows - 1 - Math.floor(i / columns)) * width}
              width={width}
              height={width}
              fill={css([colors[3 * i]!, colors[3 * i + 1]!, colors[3 * i + 2]!])}
            />
          ) : null,
        )
      ) : (
        <>
          <path class="filled-pixels" d={squares(answer, (owner) => owner === 1)} />
          <path class="filled-pixels second" d={squares(answer, (owner) => owner === 2)} />
        </>
      )}
      <path class="filled-pixels both" d={squares(answer, (owner) => owner === 3)} />
      <Grid {...answer} />
      {marks && (
        <>
          <path class="sign-marks negative" d={marks[0]} />
          <path class="sign-marks zero" d={marks[1]} />
          <path class="sign-marks positive" d={marks[2]} />
        </>
      )}
      {state.count === "2" && <path class="outline" d={path([corners[0]!, corners[2]!, corners[3]!])} />}
      <path class="outline" d={path(corners.slice(0, 3))} />
      <rect class="chosen-pixel" x={px(px0 - width / 2)} y={px(py0 - width / 2)} width={width} height={width} />
      {corners.map((corner, i) => {
        const [dx, dy] = [corner[0] - middle[0], corner[1] - middle[1]];
        const far = 0.5 / (Math.hypot(dx, dy) || 1);
        const [x, y] = at([corner[0] + dx * far, corner[1] + dy * far - 0.1]).split(" ");
        return (
          <text key={i} class="label" x={x} y={y}>
            {NAMES[i]}
          </text>
        );
      })}
      <Grip
        name={texts.chosenPixel}
        spoken={`${texts.place(say.whole(state.pixel[0] + 1), say.whole(state.pixel[1] + 1))}${say.marks.colon}${answer.chosen.map(({ is_filled }) => (is_filled ? texts.inside : texts.outside)).join(say.marks.comma)}`}
        now={state.pixel[0] + 1}
        low={1}
        high={columns}
        at={[px0, py0]}
        isStill={isStill}
        isFaint
        reach={22}
        grab={() => (dx, dy) => set(({ size }) => ({ pixel: pixelNear([state.pixel[0] + dx / width, state.pixel[1] - dy / width], size) }))}
        step={(right, up) => set(({ pixel, size }) => ({ pixel: pixelNear([pixel[0] + Math.sign(right), pixel[1] + Math.sign(up)], size) }))}
      />
      {corners.map((corner, i) => (
        <Dot
          key={i}
          name={texts.corner(NAMES[i]!)}
          spoken={texts.at(say.fixed(corner[0]), say.fixed(corner[1]))}
          place={corner}
          isStill={isStill}
          lattice={LATTICE}
          move={(change) => set(({ corners }) => ({ corners: corners.map((old, k) => (k === i ? kept(change(old), LATTICE) : old)) }))}
        />
      ))}
    </Flat>
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  const { covered, twice, missed, area, is_folded } = answer;
  const isPair = state.count === "2";
  return {
    value: covered,
    shown: texts.of(say.whole(covered)),
    label: texts.label,
    meaning: !isPair
      ? texts.centres(say.whole(covered), say.fixed(area))
      : is_folded
        ? texts.folded
        : twice
          ? texts.doubled(say.whole(twice))
          : missed
            ? texts.gaps(say.whole(missed))
            : texts.once,
    tone: !isPair ? "plain" : twice || missed ? "bad" : "good",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const isPair = state.count === "2";
  return (
    <>
      <Choice
        name="count"
        legend={texts.count}
        value={state.count}
        options={[
          { value: "1", label: texts.one },
          { value: "2", label: texts.two },
        ]}
        choose={(count) => set({ count })}
      />
      <Choice
        name="show"
        legend={texts.show}
        value={state.show}
        options={[
          { value: "signs", label: texts.signs },
          { value: "colors", label: texts.colors },
        ]}
        choose={(show) => set({ show })}
      />
      <Choice
        name="size"
        legend={texts.size}
        value={state.size}
        options={(["large", "small"] as const).map((value) => ({ value, label: texts.sizes[value] }))}
        choose={(size) =>
          set((state) => {
            const factor = COLUMNS[size] / COLUMNS[state.size];
            return { size, pixel: [Math.floor(state.pixel[0] * factor), Math.floor(state.pixel[1] * factor)] };
          })
        }
      />
      <Choice
        name="rule"
        class="stacked"
        legend={texts.rule}
        value={state.rule}
        options={(["top-left", "closed", "open"] as const).map((value) => ({ value, label: texts.rules[value] }))}
        choose={(rule) => set({ rule })}
      />
      <dl>
        <Row name="area" label={texts.area} value={answer.area}>
          {say.fixed(answer.area)}
        </Row>
        {isPair && (
          <>
            <Row name="twice" label={texts.twice} value={answer.twice}>
              {say.whole(answer.twice)}
            </Row>
            <Row name="missed" label={texts.missed} value={answer.missed}>
              {say.whole(answer.missed)}
            </Row>
          </>
        )}
      </dl>
      <div>
        <h3>
          {texts.chosenPixel}
          {say.marks.colon}
          {texts.place(say.whole(state.pixel[0] + 1), say.whole(state.pixel[1] + 1))}
        </h3>
        {answer.chosen.map(({ edges, weights }, i) => (
          <dl key={i}>
            {edges.map((edge, k) => (
              <Row key={k} class={edge > 0 ? "sided left" : edge < 0 ? "sided right" : ""} name={`edge-${i}-${k}`} label={state.show === "signs" ? texts.edge(EDGES[i]![k]!) : texts.weight(NAMES[[0, i + 1, i + 2][k]!]!)} value={state.show === "signs" ? edge : (weights?.[k] ?? null)}>
                {state.show === "signs" ? say.fixed(edge) : weights ? say.fixed(weights[k]!, 3) : "–"}
              </Row>
            ))}
          </dl>
        ))}
      </div>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    corners: ["p", points<Point>(4, 4, [[0, FLAT.width], [0, FLAT.height]])],
    count: ["c", word("1", "2")],
    size: ["s", word("large", "small")],
    rule: ["r", word("top-left", "closed", "open")],
    show: ["b", word("signs", "colors")],
    pixel: ["q", point([0, 23], [0, 15])],
  },
  question: (state) => ({
    corners: cornersOf(state),
    colors: CORNERS.slice(0, state.count === "1" ? 3 : 4),
    columns: COLUMNS[state.size],
    rule: state.rule,
    pixel: state.pixel,
  }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
