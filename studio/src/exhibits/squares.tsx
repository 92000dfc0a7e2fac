// Marching squares: samples on a lattice, lines through it, ambiguous cells, and the corners that are lost.
import { Choice, Figure as Data, Slider } from "../view/parts";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { Flat, type Point, at, path, toSvg } from "./Flat";
import { number, word } from "./fragment";
import { px } from "./Grip";
import { type Loops, outline } from "./Regions";
import type { Language } from "./say";

type Method = "squares" | "corners";

interface State {
  cells: number;
  method: Method;
}

interface Answer {
  step: number;
  size: [number, number];
  values: Float32Array;
  truth: Loops;
  lines: Loops;
  segments: number;
  ambiguous: Point[];
  error: number;
  worst: [Point, Point];
}

const [FEWEST, MOST] = [6, 48] as const;
const defaults: State = { cells: 13, method: "squares" };

interface Texts extends CommonTexts {
  figure: string;
  cells: string;
  along(n: number): string;
  method: string;
  squares: string;
  corners: string;
  label: string;
  meaning: Record<Method, (cells: string, segments: string) => string>;
  ambiguous: string;
  segments: string;
  ofCell: string;
  legend: { inside: string; two: string; worst: string };
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "The slider changes the number of cells along the figure. It takes the arrow keys, too.",
    figure: "A square, a triangle and a disc sampled on a lattice, and the lines that are drawn from the samples",
    cells: "Cells along the figure",
    along: (n) => `${n} cells`,
    method: "Lines by",
    squares: "marching squares",
    corners: "the core’s mesher",
    label: "Largest error",
    meaning: {
      squares: (cells, segments) =>
        `That is ${cells} of a cell, at the red mark: ${segments} segments, and the samples do not know about the corner.`,
      corners: (cells, segments) =>
        `That is ${cells} of a cell, with ${segments} segments only: corners have vertices of their own, and straight sides need no more.`,
    },
    ambiguous: "Cells that can be read in two ways",
    segments: "Segments",
    ofCell: "In cells",
    legend: { inside: "samples inside", two: "two readings", worst: "largest error" },
    story: [
      "To draw a field, ask it at the points of a lattice. Where neighbours differ in sign, the outline passes between them, and the two values say where: between −1 and 3, a quarter of the way. Joining the crossings of each cell gives closed lines: *marching squares*. With cubes and triangles it is marching cubes.",
      "Two weaknesses. If the signs *alternate* around a cell, its four crossings can be joined in two ways, and nothing in the samples says which: parts may touch that are apart. It takes a rule, the same for both neighbours, or the mesh gets a hole.",
      "And a *sharp corner* lies inside a cell, where nothing was asked: it is cut off. Twice as many cells cut off half as much on average; how much exactly depends on where in its cell the corner lies. The error of a smooth outline falls with the square of the cell.",
      "The core’s mesher of fields knows the parts of which the field is made. Where two of them vanish together it puts a vertex, so a corner stays a corner. The error here is enclosed between two proved bounds; shown is the upper one.",
    ],
    attempts: [
      "Look for sizes with coloured cells: four crossings, two ways to join them. Which one was taken?",
      "Double the cells. By how much does the largest error fall?",
      "Take the core’s mesher, allowed a quarter of a cell: where is its largest error now?",
    ],
  },
  zh: {
    hint: "滑块改变图形宽度方向上的单元数，也可以用方向键。",
    figure: "在网格点上采样的正方形、三角形和圆盘，以及由样本连成的线",
    cells: "宽度方向的单元数",
    along: (n) => `${n} 个单元`,
    method: "连线方法",
    squares: "移动正方形",
    corners: "内核的网格化",
    label: "最大误差",
    meaning: {
      squares: (cells, segments) => `合 ${cells} 个单元，在红色标记处：共 ${segments} 条线段，样本并不知道那里有角。`,
      corners: (cells, segments) => `合 ${cells} 个单元，只用 ${segments} 条线段：角上有自己的顶点，直边不需要更多。`,
    },
    ambiguous: "有两种连法的单元",
    segments: "线段数",
    ofCell: "合单元",
    legend: { inside: "内部的样本", two: "两种连法", worst: "最大误差" },
    story: [
      "要画出一个场，就在格点上求它的值。相邻格点符号不同，轮廓就从中间经过，两个值决定经过的位置：−1 与 3 之间，在四分之一处。把每个单元的交点连起来，得到封闭的线：*移动正方形法*。换成立方体和三角形，就是移动立方体法。",
      "它有两个弱点。若单元四角的符号*交替*，四个交点就有两种连法，样本无法判断该用哪一种：分开的部分可能连在一起。必须有一条规则，相邻单元都遵守，否则网格会出洞。",
      "另外，*尖角*落在单元内部，那里没有采样，于是被切掉。单元数加倍，切掉的平均只减半，具体取决于角在单元中的位置；而光滑轮廓的误差随单元大小的平方下降。",
      "内核的场网格化知道场由哪些部分组成：在两个部分同时为零的地方放一个顶点，角就保住了。这里的误差夹在两个已证明的界之间，显示的是上界。",
    ],
    attempts: [
      "找出有橙色单元的大小：四个交点，两种连法。这里取了哪一种？",
      "把单元数加倍，最大误差下降多少？",
      "改用内核的网格化，允许误差为四分之一单元：现在最大误差在哪里？",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;

function Figure({ page }: { page: Page }) {
  const { answer, texts, isSmall } = page;
  const { step, size, values } = answer;
  const [nx, ny] = size;
  const rules = [
    ...Array.from({ length: nx }, (_, i) => path([[i * step, 0], [i * step, (ny - 1) * step]], false)),
    ...Array.from({ length: ny }, (_, j) => path([[0, j * step], [(nx - 1) * step, j * step]], false)),
  ].join("");
  // Samples as dots of one path each, inside and outside: a thousand elements would be slow.
  const radius = px(Math.min(4.5, 9 * step));
  const dots = (isInside: boolean) =>
    Array.from(values, (value, row) => [value, row] as const)
      .filter(([value]) => value < 0 === isInside)
      .map(([, row]) => `M${at([(row % nx) * step, Math.floor(row / nx) * step])}h0`)
      .join("");
  const [from, to] = answer.worst;
  const [x, y] = toSvg(from).map(px);
  return (
    <Flat name={texts.figure}>
      <path class="lattice" d={rules} />
      {answer.ambiguous.map(([i, j]) => {
        const [a, b] = toSvg([i * step, (j + 1) * step]).map(px);
        const side = px(toSvg([step, 0])[0]);
        return <rect key={`${i},${j}`} class="two" x={a} y={b} width={side} height={side} />;
      })}
      <path class="truth-of" d={outline(answer.truth)} />
      <path class="found" d={outline(answer.lines)} />
      {!isSmall && (
        <>
          <path class="sample" stroke-width={radius} d={dots(false)} />
          <path class="sample inside" stroke-width={px(2 * Number(radius))} d={dots(true)} />
        </>
      )}
      <g class="worst">
        <path d={path([from, to], false)} />
        <circle cx={x} cy={y} r="9" />
      </g>
    </Flat>
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  const cells = say.fixed(answer.error / answer.step);
  return {
    value: answer.error,
    shown: say.fixed(answer.error),
    label: texts.label,
    meaning: texts.meaning[state.method](cells, String(answer.segments)),
    tone: state.method === "squares" ? "bad" : "good",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  return (
    <>
      <Slider
        id="cells"
        label={texts.cells}
        shown={String(state.cells)}
        spoken={texts.along(state.cells)}
        low={FEWEST}
        high={MOST}
        step={1}
        value={state.cells}
        choose={(cells) => set({ cells })}
      />
      <Choice
        name="method"
        legend={texts.method}
        value={state.method}
        options={[
          { value: "squares", label: texts.squares },
          { value: "corners", label: texts.corners },
        ]}
        choose={(method) => set({ method })}
      />
      <dl>
        <div>
          <dt>{texts.ambiguous}</dt>
          <dd>
            <Data name="ambiguous" value={answer.ambiguous.length}>
              {String(answer.ambiguous.length)}
            </Data>
          </dd>
        </div>
        <div>
          <dt>{texts.segments}</dt>
          <dd>
            <Data name="segments" value={answer.segments}>
              {String(answer.segments)}
            </Data>
          </dd>
        </div>
        <div>
          <dt>{texts.ofCell}</dt>
          <dd>{say.fixed(answer.error / answer.step)}</dd>
        </div>
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: { cells: ["n", number(FEWEST, MOST)], method: ["s", word("squares", "corners")] },
  question: (state) => ({ cells: state.cells, method: state.method }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
