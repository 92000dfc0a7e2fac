// Two cubics that meet with a chosen smoothness, and the curvature comb of both.
import type { Cubic, Point, SeamAnswer, Tooth } from "../core/types";
import type { Key } from "../i18n/en";
import { type Eight, type State, withPoint } from "../state/state";
import { Clauses } from "./Clauses";
import { Polygon } from "./Drawing";
import { Handle, type Move } from "./Handle";
import { Numbers } from "./Numbers";
import { Frame, cubicPath, linePath, pair, px } from "./frame";
import { Choice, Figure, Slider } from "./parts";
import type { Change, Page } from "./page";

const WISHES = ["none", "C0", "C1", "C2"] as const;
/** The index of the first curve's end and that of the second curve's start. */
const END = 3;
const START = 4;

export function firstOf(seam: Eight): Cubic {
  return [seam[0], seam[1], seam[2], seam[3]];
}

export function secondOf(seam: Eight): Cubic {
  return [seam[4], seam[5], seam[6], seam[7]];
}

/** The points that can be moved. At a joint the two end points are one. */
function movable(state: State): number[] {
  const all = [0, 1, 2, 3, 4, 5, 6, 7];
  return state.smoothness === "none" ? all : all.filter((i) => i !== START);
}

/** The change that moves one point. The core computes which other points follow. */
function moved(state: State, index: number, to: Point): Partial<State> {
  let seam = withPoint(state.seam, index, to);
  if (index === END && state.smoothness !== "none") {
    // The joint takes the inner control point before it along, so that the first curve's end keeps its direction.
    const [dx, dy] = [to[0] - state.seam[END][0], to[1] - state.seam[END][1]];
    seam = withPoint(seam, END - 1, [seam[END - 1]![0] + dx, seam[END - 1]![1] + dy]);
    seam = withPoint(seam, START, to);
  }
  return { seam };
}

function nameOf(page: Page, index: number): string {
  const isJoint = index === END && page.state.smoothness !== "none";
  return page.say.text(isJoint ? "point.joint" : (`seam.name.${index + 1}` as Key));
}

export function SeamView({ page, move }: { page: Page; move(change: Change, leader: "first" | "second"): void }) {
  const { say, state } = page;
  const movePoint = (index: number): Move => (change) =>
    move((state) => moved(state, index, change(state.seam[index]!)), index > START ? "second" : "first");
  const points = movable(state).map((i) => ({ name: nameOf(page, i), at: state.seam[i]!, move: movePoint(i) }));
  return (
    <>
      <p class="lead">{say.text("seam.lead")}</p>
      <div class="bench">
        <div class="stage">
          <SeamDrawing page={page} movePoint={movePoint} />
        </div>
        <div class="side">
          <h2 class={`headline ${levelOf(page.answers.seam) === "2" ? "smooth" : "seen"}`}>
            <Clauses text={headline(page)} />
          </h2>
          <div class="side" inert={page.around.isStill}>
            <Choice
              class="wishes"
              name="smoothness"
              legend={say.text("seam.wish")}
              value={state.smoothness}
              options={WISHES.map((value) => ({ value, label: say.text(`seam.${value}`) }))}
              choose={(smoothness) => move({ smoothness }, "first")}
            />
            <Slider
              id="comb"
              label={say.text("seam.comb")}
              shown={say.number(state.comb)}
              spoken={say.text("seam.comb.value", { n: say.number(state.comb) })}
              low={0}
              high={6}
              step={0.1}
              value={state.comb}
              choose={(comb) => page.set({ comb })}
            />
          </div>
          <JoinTable page={page} />
        </div>
        <div class="under">
          <p class="aside">{say.text("seam.why")}</p>
          {!page.around.isStill && <Numbers page={page} id="seam-point" points={points} />}
        </div>
      </div>
    </>
  );
}

function levelOf(seam: SeamAnswer): "none" | "0" | "1" | "2" {
  const level = seam.join.geometric;
  return level === null ? "none" : (String(level) as "0" | "1" | "2");
}

function headline(page: Page): string {
  const { say, answers } = page;
  const angle = answers.seam.join.angle_rad;
  return say.text(`seam.state.${levelOf(answers.seam)}`, { angle: angle === null ? "–" : degrees(page, angle) });
}

function degrees({ say }: Page, radians: number): string {
  return say.text("seam.degrees", { n: say.number((radians * 180) / Math.PI) });
}

function SeamDrawing({ page, movePoint }: { page: Page; movePoint(index: number): Move }) {
  const { say, state, answers, around } = page;
  const frame = new Frame(around.width);
  const { first, second, comb } = answers.seam;
  const how = say.text(`seam.${state.smoothness}`);
  return (
    <svg
      class="drawing"
      viewBox={`0 0 ${px(frame.width)} ${px(frame.height)}`}
      role="group"
      aria-label={say.text("seam.figure.alt", { how })}
      data-figure="seam"
    >
      <g aria-hidden="true">
        <Comb teeth={comb[0]} frame={frame} side="first" />
        <Comb teeth={comb[1]} frame={frame} side="second" />
        <Polygon control={first} frame={frame} />
        <Polygon control={second} frame={frame} />
        <path class="strand first" d={cubicPath(first.map((point) => frame.to(point)))} />
        <path class="strand second" d={cubicPath(second.map((point) => frame.to(point)))} />
      </g>
      {movable(state).map((i) => {
        const at = state.seam[i]!;
        return (
          <Handle
            key={i}
            name={nameOf(page, i)}
            spoken={say.text("point.at", { x: say.coordinate(at[0]), y: say.coordinate(at[1]) })}
            help="seam-point-help"
            at={at}
            frame={frame}
            isStill={around.isStill}
            kind={i === END && state.smoothness !== "none" ? "joint" : i % 4 === 0 || i % 4 === 3 ? "end" : "inner"}
            move={movePoint(i)}
          />
        );
      })}
    </svg>
  );
}

function Comb({ teeth, frame, side }: { teeth: Tooth[]; frame: Frame; side: string }) {
  const tips = teeth.map((tooth) => frame.to(tooth.tip));
  const stems = teeth.map((tooth, i) => `M${pair(frame.to(tooth.on_curve))}L${pair(tips[i]!)}`);
  return (
    <g class={`comb ${side}`}>
      <path class="teeth" d={stems.join("")} />
      <path class="tips" d={linePath(tips)} />
    </g>
  );
}

function JoinTable({ page }: { page: Page }) {
  const { say, answers } = page;
  const join = answers.seam.join;
  const apart = say.text("seam.apart");
  const number = (value: number | null) => (value === null ? say.text("seam.unknown") : say.number(value));
  const signed = (value: number | null) => (value === null ? say.text("seam.unknown") : say.signed(value));
  // Values that the core treats as equal up to rounding are shown as equal; `value` keeps all digits.
  const level = join.geometric ?? -1;
  const angle = level >= 1 ? 0 : join.angle_rad;
  const jump = level >= 2 ? 0 : join.curvature_gap;
  const rows: [label: Key, name: string, value: number | null, shown: string][] = [
    ["seam.parametric", "parametric", join.parametric, join.parametric === null ? apart : `C${join.parametric}`],
    ["seam.geometric", "geometric", join.geometric, join.geometric === null ? apart : `G${join.geometric}`],
    ["seam.position", "position-gap", join.position_gap, say.units(join.position_gap)],
    ["seam.angle", "angle", join.angle_rad, angle === null ? number(null) : degrees(page, angle)],
    ["seam.curvature", "curvature-gap", join.curvature_gap, number(jump)],
  ];
  return (
    <div class="readout">
      <h3>{say.text("seam.is")}</h3>
      <dl>
        {rows.map(([label, name, value, shown]) => (
          <div key={name}>
            <dt>{say.text(label)}</dt>
            <dd>
              <Figure name={name} value={value}>
                {shown}
              </Figure>
            </dd>
          </div>
        ))}
        <div>
          <dt>{say.text("seam.curvatures")}</dt>
          <dd>
            <Figure name="curvature-before" value={join.curvatures[0]}>
              {signed(join.curvatures[0])}
            </Figure>
            {" · "}
            <Figure name="curvature-after" value={join.curvatures[1]}>
              {signed(join.curvatures[1])}
            </Figure>
          </dd>
        </div>
      </dl>
    </div>
  );
}
