// Marching squares: samples on a lattice, lines through it, ambiguous cells, and corners that are cut off. Then one cube.
import { Choice, Row, Slider } from "../view/parts";
import type { View } from "../viewer";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { Dot, FLAT, Flat, type Point, at, path, toSvg } from "./Flat";
import { flag, number, point, view, word } from "./fragment";
import { px } from "./Grip";
import { type CubeAnswer, CubeFigure, CubePanel, HOME, PRESETS, type Preset, cubeNumber } from "./OneCube";
import { type Loops, outline } from "./Regions";
import { texts } from "./squares_texts";

type Method = "squares" | "corners";
type Look = "lattice" | "cube";

type Part = "square" | "wedge" | "disc";
const PARTS: readonly Part[] = ["square", "wedge", "disc"];

interface State extends Record<Part, Point> {
  look: Look;
  cells: number;
  method: Method;
  /** For the cube: its corners that are inside, as bits. */
  signs: number;
  /** Whether the single inside corner is the corner of a box. */
  sharp: boolean;
  view: View;
}

interface LatticeAnswer {
  look: "lattice";
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

/** The answer for the chosen look, or for the previous one until it arrives. */
type Answer = LatticeAnswer | CubeAnswer;

const [FEWEST, MOST] = [6, 48] as const;
const defaults: State = { look: "lattice", cells: 13, method: "squares", square: [3.3, 3.9], wedge: [7.45, 4.75], disc: [9.8, 2.5], signs: PRESETS.diagonal, sharp: false, view: HOME };

export interface Texts extends CommonTexts {
  look: string;
  looks: Record<Look, string>;
  figure: string;
  cells: string;
  along(n: number): string;
  parts: Record<Part, string>;
  at(x: string, y: string): string;
  method: string;
  squares: string;
  corners: string;
  label: string;
  meaning: Record<Method, (cells: string, segments: string) => string>;
  ambiguous: string;
  segments: string;
  ofCell: string;
  cube: {
    figure: string;
    label: string;
    none: string;
    one(triangles: string): string;
    two(readings: string): string;
    tip(lost: string): string;
    corners: string;
    corner(n: number): string;
    preset: string;
    presets: Record<Preset, string>;
    triangles: string;
    pieces: string;
    readings: string;
    patterns: string;
    of(n: string, all: string): string;
    lost: string;
  };
}

export type Page = PageOf<State, Answer, Texts>;

function Figure({ page }: { page: Page }) {
  const { answer } = page;
  return answer.look === "cube" ? <CubeFigure page={page} answer={answer} /> : <LatticeFigure page={page} answer={answer} />;
}

function LatticeFigure({ page: { state, texts, say, set, isStill, isSmall }, answer }: { page: Page; answer: LatticeAnswer }) {
  const { step, size, values } = answer;
  const [nx, ny] = size;
  const rules = [
    ...Array.from({ length: nx }, (_, i) => path([[i * step, 0], [i * step, (ny - 1) * step]], false)),
    ...Array.from({ length: ny }, (_, j) => path([[0, j * step], [(nx - 1) * step, j * step]], false)),
  ].join("");
  // All inside samples, and all outside ones, are dots of one path each: a thousand elements would be slow.
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
      {PARTS.map((part) => (
        <Dot
          key={part}
          name={texts.parts[part]}
          spoken={texts.at(say.fixed(state[part][0]), say.fixed(state[part][1]))}
          place={state[part]}
          isStill={isStill}
          isFaint
          move={(change) => set((state) => ({ [part]: change(state[part]) }))}
        />
      ))}
    </Flat>
  );
}

function liveNumber(page: Page): LiveNumber {
  const { state, answer, say, texts } = page;
  if (answer.look === "cube") return cubeNumber(page, answer);
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
  const { state, answer, texts, set } = page;
  return (
    <>
      <Choice
        name="look"
        legend={texts.look}
        value={state.look}
        options={(["lattice", "cube"] as const).map((value) => ({ value, label: texts.looks[value] }))}
        choose={(look) => set({ look })}
      />
      {answer.look === "cube" ? <CubePanel page={page} answer={answer} /> : <LatticePanel page={page} answer={answer} />}
    </>
  );
}

function LatticePanel({ page, answer }: { page: Page; answer: LatticeAnswer }) {
  const { state, texts, say, set } = page;
  return (
    <>
      <Slider
        id="cells"
        label={texts.cells}
        shown={String(state.cells)}
        spoken={texts.along(state.cells)}
        low={FEWEST}
        high={MOST}
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
        <Row name="ambiguous" label={texts.ambiguous} value={answer.ambiguous.length}>
          {String(answer.ambiguous.length)}
        </Row>
        <Row name="segments" label={texts.segments} value={answer.segments}>
          {String(answer.segments)}
        </Row>
        <div>
          <dt>{texts.ofCell}</dt>
          <dd>{say.fixed(answer.error / answer.step)}</dd>
        </div>
      </dl>
    </>
  );
}

const PLACE = point([0, FLAT.width], [0, FLAT.height]);

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    look: ["k", word("lattice", "cube")],
    cells: ["n", number(FEWEST, MOST)],
    method: ["s", word("squares", "corners")],
    signs: ["g", number(0, 255)],
    sharp: ["t", flag],
    view: ["o", view],
    square: ["a", PLACE],
    wedge: ["b", PLACE],
    disc: ["c", PLACE],
  },
  question: ({ look, cells, method, signs, square, wedge, disc }) =>
    look === "cube" ? { look, signs } : { look, cells, method, parts: [square, wedge, disc] },
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
