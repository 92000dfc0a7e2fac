// The shading cost of small triangles: a GPU shades blocks of two by two pixels, once for each triangle that touches them.
import { Row, Slider } from "../view/parts";
import { Chart, chain } from "./Chart";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { FLAT, Flat, type Point, path, toSvg } from "./Flat";
import { number } from "./fragment";
import { px } from "./Grip";
import { type Pair, SamePicture, type Side } from "./SamePicture";
import type { Language } from "./say";

interface State {
  stop: number;
  /** Which of the two balls is shown. */
  side: Side;
}

interface Answer {
  mesh: { positions: Float32Array; indices: Uint32Array } | null;
  screen: [number, number];
  launches: number[];
  columns: number;
  triangles: number;
  area_px: number;
  missed: number;
  missed_share: number;
  covered: number;
  lanes: number;
  ratio: number;
  curve: [side: number, ratio: number][];
  ball: Pair & { triangles: number; most: number };
}

/** Sides of the triangles in pixels, from large to small. */
export const STOPS = Array.from({ length: 27 }, (_, i) => Number((16 * 0.86 ** i).toPrecision(2)));
const defaults: State = { stop: 9, side: "coarse" };

interface Texts extends CommonTexts {
  figure: string;
  side: string;
  pixels(n: string): string;
  label: string;
  meaning(triangles: string, area: string): string;
  cliff(missed: string): string;
  triangles: string;
  area: string;
  lanes: string;
  covered: string;
  missed: string;
  chart: string;
  chartX: string;
  chartY: string;
  legend(n: number): string;
  legendName: string;
  balls: string;
  ball(n: string): string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "The slider makes the triangles smaller. Each square is one pixel; heavier lines bound blocks of two by two.",
    figure: "A screen of 36 by 24 pixels, covered by triangles, coloured by how often each block of two by two pixels is shaded",
    side: "Side of a triangle",
    pixels: (n) => `${n} pixels`,
    label: "Shaded pixels per covered pixel",
    meaning: (triangles, area) =>
      `${triangles} triangles of ${area} pixels each. Blocks on an edge are shaded once for every triangle that has a pixel in them.`,
    cliff: (missed) =>
      `Every pixel is shaded four times, and ${missed} of the triangles cover no pixel’s centre and are not seen at all.`,
    triangles: "Triangles on the screen",
    area: "Pixels in a triangle",
    lanes: "Shaded pixels, including discarded ones",
    covered: "Pixels that are covered",
    missed: "Triangles that cover no pixel’s centre, including the border",
    chart: "Shading per pixel by the size of triangles",
    chartX: "side in pixels, smaller to the right",
    chartY: "shaded per pixel",
    legend: (n) => (n >= 8 ? "8 or more" : String(n)),
    legendName: "triangles shaded in a block",
    balls: "A ball of such triangles, enlarged three times",
    ball: (n) => `${n} triangles`,
    story: [
      "A graphics processor shades *blocks of two by two* pixels, because it needs differences between neighbours to read a texture. However few pixels of a block a triangle covers, all four are shaded and the others discarded. The smaller the triangles, the more blocks are on an edge: below a pixel the cost climbs to *four times*, and the ball in the small picture stays the same.",
      "There it stays: then no two pixels of a block belong to the same triangle, so each is shaded four times; more triangles change nothing in the picture, and most of them miss every pixel’s centre. They are transformed, sorted and discarded, and flicker in motion.",
      "So more triangles are not always better. They are worth their cost as long as an error is visible. Once every chord is within a pixel of the true shape, more of them only cost time.",
    ],
    attempts: [
      "Go from 16 pixels down to 4. How much more does every pixel cost?",
      "Find the size below which the number does not grow any more.",
    ],
  },
  zh: {
    hint: "滑块让三角形变小。每个小格是一个像素，粗线围成 2 × 2 的像素块。",
    figure: "36 × 24 像素的屏幕被三角形铺满，颜色表示每个 2 × 2 像素块着色了几次",
    side: "三角形边长",
    pixels: (n) => `${n} 像素`,
    label: "每个被覆盖的像素的着色次数",
    meaning: (triangles, area) =>
      `共 ${triangles} 个三角形，每个面积 ${area} 像素。压在边上的像素块，每有一个三角形占到其中的像素，就要着色一次。`,
    cliff: (missed) => `每个像素着色四次，而且 ${missed} 的三角形不含任何像素中心，根本看不见。`,
    triangles: "屏幕上的三角形",
    area: "每个三角形的像素数",
    lanes: "着色的像素数（含丢弃的）",
    covered: "被覆盖的像素",
    missed: "不含像素中心的三角形（含边界处）",
    chart: "每像素着色次数随三角形大小的变化",
    chartX: "边长（像素），越往右越小",
    chartY: "每像素着色次数",
    legend: (n) => (n >= 8 ? "8 次以上" : String(n)),
    legendName: "一个像素块中着色的三角形数",
    balls: "由这样的三角形组成的球，放大三倍",
    ball: (n) => `${n} 个三角形`,
    story: [
      "图形处理器以 *2 × 2 的像素块*为单位着色，因为读取纹理需要相邻像素之差。三角形哪怕只占到块中一个像素，四个也都要着色，多余的丢弃。三角形越小，压在边上的块越多：小于一个像素时，代价升到*四倍*，小图里的球却没有变化。",
      "代价到此为止：同一块里没有两个像素属于同一个三角形，每个像素要着色四次。再增加三角形，大多数三角形不含任何像素中心：它们照样要变换、要分拣，然后丢弃；一运动还会闪烁。",
      "所以三角形并非越多越好。误差看得见时，它们物有所值；弦的误差一旦都在一个像素以内，再多就只有代价。",
    ],
    attempts: [
      "从 16 像素降到 4 像素：每个像素贵了多少？",
      "找出从哪个大小起，这个数不再增长。",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
/** The number of colours in the heat map. */
const HOTTEST = 8;

function Figure({ page }: { page: Page }) {
  const { answer, texts } = page;
  const { screen, columns, launches, mesh } = answer;
  const unit = FLAT.width / screen[0];
  const block = px(toSvg([2 * unit, 0])[0]);
  // One path for each colour, so that the picture has few elements.
  const heats = Array.from({ length: HOTTEST }, (_, i) =>
    launches
      .map((count, row) => [Math.min(count, HOTTEST), row] as const)
      .filter(([count]) => count === i + 1)
      .map(([, row]) => {
        // Rows of the screen run downward.
        const [x, y] = toSvg([2 * unit * (row % columns), FLAT.height - 2 * unit * Math.floor(row / columns)]).map(px);
        return `M${x} ${y}h${block}v${block}h-${block}z`;
      })
      .join(""),
  );
  const rules = (every: number) =>
    [
      ...Array.from({ length: screen[0] / every + 1 }, (_, i) =>
        path([[i * every * unit, 0], [i * every * unit, FLAT.height]], false)),
      ...Array.from({ length: screen[1] / every + 1 }, (_, j) =>
        path([[0, j * every * unit], [FLAT.width, j * every * unit]], false)),
    ].join("");
  return (
    <Flat name={texts.figure}>
      {heats.map((d, i) => d && <path key={i} class={`heat heat-${i + 1}`} d={d} />)}
      <path class="pixels" d={rules(1)} />
      <path class="blocks" d={rules(2)} />
      {mesh && <path class="edges" d={edges(mesh, unit)} />}
    </Flat>
  );
}

/** The sides of the triangles that reach into the figure. */
function edges({ positions, indices }: NonNullable<Answer["mesh"]>, unit: number): string {
  const at = (row: number): Point => [positions[3 * row]! * unit, positions[3 * row + 1]! * unit];
  const isNear = ([x, y]: Point) => x > -1 && x < FLAT.width + 1 && y > -1 && y < FLAT.height + 1;
  let d = "";
  for (let i = 0; i < indices.length; i += 3) {
    const corners = [0, 1, 2].map((k) => at(indices[i + k]!));
    if (corners.some(isNear)) d += path(corners);
  }
  return d;
}

function liveNumber({ answer, say, texts }: Page): LiveNumber {
  // Where the ratio rounds to 4 in the digits that are shown.
  const isOver = answer.ratio > 3.995;
  return {
    value: answer.ratio,
    shown: say.fixed(answer.ratio),
    label: texts.label,
    meaning: isOver
      ? texts.cliff(say.percent(answer.missed_share))
      : texts.meaning(say.whole(answer.triangles), say.number(answer.area_px)),
    tone: answer.ratio < 1.5 ? "good" : answer.ratio > 3 ? "bad" : "plain",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const side = STOPS[state.stop]!;
  const rows = [
    ["triangles", texts.triangles, answer.triangles],
    ["covered", texts.covered, answer.covered],
    ["lanes", texts.lanes, answer.lanes],
  ] as const;
  return (
    <>
      <Slider
        id="side"
        label={texts.side}
        shown={texts.pixels(say.number(side))}
        low={0}
        high={STOPS.length - 1}
        value={state.stop}
        choose={(stop) => set({ stop })}
      />
      <Chart
        name={texts.chart}
        x={{ low: 16, high: 0.3, isLog: true, label: texts.chartX, ticks: [16, 8, 4, 2, 1, 0.5].map((x) => [x, String(x)]) }}
        y={{ low: 1, high: 4.2, label: texts.chartY, ticks: [1, 2, 3, 4].map((y) => [y, String(y)]) }}
      >
        {(at) => (
          <>
            <path class="drawn" d={chain(at, answer.curve)} />
            <circle class="here" r="6" cx={px(at(side, answer.ratio)[0])} cy={px(at(side, answer.ratio)[1])} />
          </>
        )}
      </Chart>
      <p class="legend heats" aria-label={texts.legendName}>
        {[1, 2, 4, 6, 8].map((n) => (
          <span key={n} class={`heat-${n}`}>
            {texts.legend(n)}
          </span>
        ))}
        {texts.legendName}
      </p>
      <div>
        <h3>{texts.balls}</h3>
        <SamePicture
          pair={answer.ball}
          side={state.side}
          names={[texts.ball(say.whole(answer.ball.triangles)), texts.ball(say.whole(answer.ball.most))]}
          scale={3}
          say={say}
          isStill={page.isStill}
          choose={(side) => set({ side })}
        />
      </div>
      <dl>
        {rows.map(([name, label, value]) => (
          <Row key={name} name={name} label={label} value={value}>
            {say.whole(value)}
          </Row>
        ))}
        <Row name="missed" label={texts.missed} value={answer.missed}>
          {say.percent(answer.missed_share)}
        </Row>
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: { stop: ["n", number(0, STOPS.length - 1)] },
  question: ({ stop }) => ({ side: STOPS[stop] }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
