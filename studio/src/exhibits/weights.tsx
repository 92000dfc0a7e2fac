// Three weights interpolate the values at three corners; with four corners they are not unique.
import { Choice, Figure as Data, Row } from "../view/parts";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { Dot, FLAT, Flat, type Point, at, path } from "./Flat";
import { point, points, word } from "./fragment";
import { CORNERS } from "./paint";
import type { Language } from "./say";
import { css } from "../viewer/color";

interface State {
  probe: Point;
  /** The corners of the triangle, and those of the quad. */
  three: readonly Point[];
  four: readonly Point[];
  corners: "3" | "4";
  cut: "first" | "second";
}

interface Blend {
  rows: [number, number, number];
  weights: [number, number, number];
  sum: number;
  smallest: number;
  color: [number, number, number];
  is_inside: boolean;
}

interface Answer {
  blends: (Blend | null)[];
  color_gap: number | null;
}

const defaults: State = {
  probe: [5.6, 3.4],
  three: [
    [1.4, 1.1],
    [10.6, 1.6],
    [5.2, 7.2],
  ],
  four: [
    [1.4, 1.1],
    [10.4, 1.3],
    [9.6, 6.9],
    [2.6, 6.6],
  ],
  corners: "3",
  cut: "first",
};
const placesOf = ({ corners, three, four }: State) => (corners === "3" ? three : four);

interface Texts extends CommonTexts {
  figure: string;
  probe: string;
  corner(name: string): string;
  at(x: string, y: string): string;
  corners: string;
  three: string;
  four: string;
  cut: string;
  cutAlong(name: string): string;
  weight(name: string): string;
  label3: string;
  label4: string;
  sum: string;
  outside: string;
  onEdge(name: string): string;
  mixed: string;
  same: string;
  two(percent: string): string;
  swatch: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: "Drag the point or a corner.{keys} Arrow keys move them, with Shift by small steps; Page Up and Page Down by large ones.",
    figure: "A shape with a colour at every corner, blended between them, and a point to move",
    probe: "The probe",
    corner: (name) => `Corner ${name}`,
    at: (x, y) => `x ${x}, y ${y}`,
    corners: "Corners",
    three: "three",
    four: "four",
    cut: "Cut it along",
    cutAlong: (name) => `cut ${name}`,
    weight: (name) => `Weight of ${name}`,
    label3: "Smallest of the three weights",
    sum: "Sum",
    label4: "Two answers for one point: largest difference in a channel",
    outside: "Outside, a weight is negative: the colour would be extrapolated beyond the corners.",
    onEdge: (name) => `On an edge: ${name} has no influence here, and the triangle beyond blends the same colours.`,
    mixed: "All weights are between 0 and 1: the colour is a mixture of the three. No other linear rule gives each corner its own colour.",
    same: "Here both cuts agree.",
    two: (percent) => `The same point, the same four corners, two colours: they differ by ${percent}.`,
    swatch: "Colour at the probe",
    story: [
      "Values at the corners are blended over a triangle. Each corner gets a *weight*, the share of the area that the point spans with the opposite side. The weights always sum to one; the smallest is positive inside, 0 on an edge, negative outside. Three corners have one solution; with four the diagonal decides.",
      "The values may be colours, normals or texture coordinates. At a corner its own weight is 1 and the others are 0; along an edge the third corner has no influence, so neighbours agree there and no seam shows.",
      "Three weights have three conditions, two for the place and one for the sum. With four corners one number is left over; every rule that picks it is a convention, and hardware cuts the quad: so the colour inside depends on the diagonal.",
    ],
    attempts: [
      "Move the probe across an edge and watch the smallest weight. What does the sum do?",
      "Choose four corners, put the probe in the middle, and change the cut.",
    ],
  },
  zh: {
    hint: "拖动测试点或顶点。{keys}方向键移动，加 Shift 走小步，Page Up 和 Page Down 走大步。",
    figure: "每个顶点各有颜色、内部由插值得到的图形，以及一个可移动的点",
    probe: "测试点",
    corner: (name) => `顶点 ${name}`,
    at: (x, y) => `x ${x}，y ${y}`,
    corners: "顶点数",
    three: "三个",
    four: "四个",
    cut: "沿哪条对角线剖分",
    cutAlong: (name) => `沿 ${name}`,
    weight: (name) => `${name} 的权重`,
    label3: "三个权重中最小的",
    sum: "总和",
    label4: "同一点有两个答案：各通道的最大差",
    outside: "在外部有权重为负：颜色靠外推，超出了顶点给出的范围。",
    onEdge: (name) => `在一条边上：${name} 在这里不起作用，边那侧的三角形混合出同样的颜色。`,
    mixed: "权重都在 0 与 1 之间：颜色是三者的混合。没有别的线性规则能让每个顶点保持自己的颜色。",
    same: "在这一点两种剖分结果相同。",
    two: (percent) => `同一个点、同样四个顶点，却有两种颜色，相差 ${percent}。`,
    swatch: "测试点处的颜色",
    story: [
      "顶点上已知的量可以在三角形上插值。每个顶点有一个*权重*：点与对边围成的面积占总面积的比例。权重总和恒为一；最小的一个在内部为正，在边上为零，在外部为负。三个顶点只有一个解；四个顶点则由对角线决定。",
      "插值的可以是颜色、法线、纹理坐标，这些权重就是重心坐标。在顶点处，自身权重为 1，其余为 0；在一条边上，第三个顶点不起作用，因此相邻三角形在公共边上一致，不露痕迹。",
      "三个权重有三个条件：位置两个，总和一个。四个顶点多出的自由度怎么取全凭约定；硬件的约定是把四边形切成两个三角形，于是内部的颜色取决于对角线。",
    ],
    attempts: ["让测试点越过一条边，看最小的权重怎样变，总和呢？", "选四个顶点，把测试点放在中间，再换一种剖分。"],
  },
};

type Page = PageOf<State, Answer, Texts>;
const colorsOf = ({ corners }: State) => CORNERS.slice(0, Number(corners));
/** The triangles of each cut, in the core's order. */
const CUTS: Record<State["cut"], readonly (readonly number[])[]> = {
  first: [
    [0, 1, 2],
    [0, 2, 3],
  ],
  second: [
    [1, 2, 3],
    [1, 3, 0],
  ],
};
const NAMES = { first: "A–C", second: "B–D" } as const;

function Figure({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill, isSmall } = page;
  const places = placesOf(state);
  const triangles = state.corners === "3" ? [[0, 1, 2]] : CUTS[state.cut];
  const blend = answer.blends[state.corners === "4" && state.cut === "second" ? 1 : 0];
  return (
    <Flat name={texts.figure}>
      {triangles.map((rows) => (
        <Blended key={rows.join()} rows={rows} places={places} prefix={isSmall ? "small-" : ""} />
      ))}
      <path class="outline" d={path(places)} />
      {blend &&
        state.corners === "3" &&
        blend.rows.map((row) => <path key={row} class="spoke" d={path([places[row]!, state.probe], false)} />)}
      {places.map((corner, i) => {
        const [dx, dy] = [0, 1].map((k) => corner[k]! - places.reduce((sum, other) => sum + other[k]! / places.length, 0)) as [number, number];
        const far = 0.5 / (Math.hypot(dx, dy) || 1);
        const [x, y] = at([corner[0] + dx * far, corner[1] + dy * far - 0.1]).split(" ");
        return (
          <text key={i} class="label" x={x} y={y}>
            {"ABCD"[i]}
          </text>
        );
      })}
      {blend && <Swatch place={state.probe} color={blend.color} />}
      <Dot
        name={texts.probe}
        spoken={`${texts.at(say.fixed(state.probe[0]), say.fixed(state.probe[1]))}${blend ? say.marks.colon + blend.weights.map((weight) => say.fixed(weight)).join(say.marks.comma) : ""}`}
        place={state.probe}
        isStill={isStill}
        move={(change) => set(({ probe }) => ({ probe: change(probe) }))}
      />
      {places.map((corner, i) => (
        <Dot
          key={i}
          name={texts.corner("ABCD"[i]!)}
          spoken={texts.at(say.fixed(corner[0]), say.fixed(corner[1]))}
          place={corner}
          isStill={isStill}
          isFaint
          reach={20}
          move={(change) =>
            set((state) => ({
              [state.corners === "3" ? "three" : "four"]: placesOf(state).map((old, k) => (k === i ? change(old) : old)),
            }))
          }
        />
      ))}
    </Flat>
  );
}

/** Three gradients, each from black at the opposite side to its corner's colour. The browser adds them: by differences from white, which paper has, too. */
function Blended({ rows, places, prefix }: { rows: readonly number[]; places: readonly Point[]; prefix: string }) {
  const corners = rows.map((row) => places[row]!);
  const outline = path(corners);
  return (
    <g class="blended">
      <path class="base" d={outline} />
      {rows.map((row, k) => {
        const [a, b, c] = [corners[k]!, corners[(k + 1) % 3]!, corners[(k + 2) % 3]!];
        // The foot of the corner on the line of the opposite side.
        const [dx, dy] = [c[0] - b[0], c[1] - b[1]];
        const t = ((a[0] - b[0]) * dx + (a[1] - b[1]) * dy) / (dx * dx + dy * dy);
        const [x1, y1] = at([b[0] + t * dx, b[1] + t * dy]).split(" ");
        const [x2, y2] = at(a).split(" ");
        const id = `${prefix}ramp-${rows.join("")}-${row}`;
        return (
          <g key={row} class="ramped">
            <linearGradient id={id} gradientUnits="userSpaceOnUse" x1={x1} y1={y1} x2={x2} y2={y2}>
              <stop offset="0" stop-color="#000" />
              <stop offset="1" stop-color={css(CORNERS[row]!)} />
            </linearGradient>
            <path class="ramp" d={outline} fill={`url(#${id})`} />
          </g>
        );
      })}
      <path class="turned-back" d={outline} />
    </g>
  );
}

function Swatch({ place, color }: { place: Point; color: readonly [number, number, number] }) {
  const [x, y] = at([place[0] + 0.55, place[1] + 0.62]).split(" ");
  return <circle class="swatch" cx={x} cy={y} r={19} fill={css(color)} />;
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  if (state.corners === "3") {
    const { smallest, weights, rows, is_inside } = answer.blends[0]!;
    const corner = "ABCD"[rows[weights.indexOf(smallest)]!]!;
    return {
      value: smallest,
      shown: say.fixed(smallest, 3),
      label: texts.label3,
      // A weight of zero means that the point is on the opposite edge.
      meaning: !is_inside ? texts.outside : smallest === 0 ? texts.onEdge(corner) : texts.mixed,
      tone: is_inside ? "good" : "bad",
    };
  }
  const gap = answer.color_gap ?? 0;
  return {
    value: gap,
    shown: say.percent(gap),
    label: texts.label4,
    meaning: answer.blends.some((blend) => !blend?.is_inside)
      ? texts.outside
      : gap < 0.005
        ? texts.same
        : texts.two(say.percent(gap)),
    tone: gap < 0.005 ? "plain" : "bad",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const shown = answer.blends.flatMap((blend, i) => (blend ? [{ blend, i }] : []));
  return (
    <>
      {shown.map(({ blend, i }) => (
        <div key={i}>
          {state.corners === "4" && <h3>{texts.cutAlong(i ? NAMES.second : NAMES.first)}</h3>}
          <dl>
            {blend.rows.map((row, k) => (
              <Row key={row} name={`weight-${i}-${k}`} label={texts.weight("ABCD"[row]!)} value={blend.weights[k]!}>
                {say.fixed(blend.weights[k]!, 3)}
              </Row>
            ))}
            <Row name={`sum-${i}`} label={texts.sum} value={blend.sum}>
              {say.fixed(blend.sum, 3)}
            </Row>
            <div>
              <dt>{texts.swatch}</dt>
              <dd class="with-swatch">
                <svg class="chip" viewBox="0 0 16 16" aria-hidden="true">
                  <circle cx="8" cy="8" r="7" fill={css(blend.color)} />
                </svg>
                {blend.color.map((channel, k) => (
                  <Data key={k} name={`color-${i}-${k}`} value={channel}>
                    {say.percent(channel)}
                  </Data>
                ))}
              </dd>
            </div>
          </dl>
        </div>
      ))}
      <Choice
        name="corners"
        legend={texts.corners}
        value={state.corners}
        options={[
          { value: "3", label: texts.three },
          { value: "4", label: texts.four },
        ]}
        choose={(corners) => set({ corners })}
      />
      {state.corners === "4" && (
        <Choice
          name="cut"
          legend={texts.cut}
          value={state.cut}
          options={[
            { value: "first", label: NAMES.first },
            { value: "second", label: NAMES.second },
          ]}
          choose={(cut) => set({ cut })}
        />
      )}
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    probe: ["p", point([0, FLAT.width], [0, FLAT.height])],
    three: ["k", points<Point>(3, 3, [[0, FLAT.width], [0, FLAT.height]])],
    four: ["q", points<Point>(4, 4, [[0, FLAT.width], [0, FLAT.height]])],
    corners: ["c", word("3", "4")],
    cut: ["d", word("first", "second")],
  },
  question: (state) => ({ corners: placesOf(state), colors: colorsOf(state), point: state.probe }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
