// The mesh doctor: six defective meshes, the defects that the core finds, and the results of its repairs.
import { CURE_NAMES, type Cure } from "../core/cures";
import { Choice, Figure as Data } from "../view/parts";
import type { Layer, Picture, Vec3, View } from "../viewer";
import { DOCTOR, type Defect, PATIENTS, type Patient, type Texts } from "./doctor_texts";
import { exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { view, word, words } from "./fragment";
import { PAINT } from "./paint";
import { Scene } from "./Scene";

interface State {
  patient: Patient;
  cures: readonly Cure[];
  view: View;
}

interface Found {
  defect: Defect;
  is_fault: boolean;
  count: number;
  cure: Cure | null;
  places: Vec3[][];
}

interface Answer {
  mesh: { positions: Float32Array; indices: Uint32Array };
  findings: Found[];
  faults: number;
  next: Cure | null;
  done: { cure: Cure; changes: [string, number][]; moved_at_most: number | null }[];
  triangles: number;
  vertices: number;
  components: number;
  closed: boolean;
  manifold: boolean;
  oriented: boolean;
  outward: boolean | null;
  volume: number | null;
}

const MOST_CURES = 16;
const HOME: View = { azimuth: -52, elevation: 30, distance: 5.4, target: [0, 0, 0] };
const defaults: State = { patient: "hole", cures: [], view: HOME };
/** Two cubes need more room than a ball. */
const FRAMES: Record<Patient, Pick<View, "distance" | "target">> = {
  hole: HOME,
  seam: HOME,
  flipped: HOME,
  double: HOME,
  crack: { distance: 7.6, target: [0, 0, 0] },
  branch: { distance: 12, target: [1, 1, 0] },
};
const homeOf = (patient: Patient): View => ({ ...HOME, ...FRAMES[patient] });

type Page = PageOf<State, Answer, Texts>;

function pictureOf({ answer }: Page): Picture {
  const { positions, indices } = answer.mesh;
  // Highlights the defects that the next repair is for, or all if no repair helps.
  const shown = answer.next ? answer.findings.filter(({ cure }) => cure === answer.next) : answer.findings;
  const places = shown.flatMap(({ places }) => places);
  const flat = (points: readonly Vec3[]) => new Float32Array(points.flat());
  // One corner is a dot, two are an edge, three a triangle.
  const dots = places.filter((corners) => corners.length === 1).flat();
  const lines = places.flatMap(([a, b, c]) => (c ? [a!, b!, b!, c, c, a!] : b ? [a!, b] : []));
  const layers: Layer[] = [
    { kind: "mesh", id: "patient", positions, indices, paint: PAINT.front, back: PAINT.back, shading: "flat", sides: "both" },
    { kind: "wire", id: "wire", positions, indices, paint: "#24446b", width: 0.8 },
  ];
  if (lines.length)
    layers.push({ kind: "lines", id: "edges", positions: flat(lines), paint: "--gap", width: 3.5, isOnTop: true });
  if (dots.length) layers.push({ kind: "points", id: "dots", positions: flat(dots), paint: "--gap", size: 10, isOnTop: true });
  return { layers };
}

function Figure({ page }: { page: Page }) {
  const { state, texts, set, isStill } = page;
  return (
    <Scene
      name={`${texts.figure}: ${texts.patients[state.patient]}`}
      help="hint"
      picture={pictureOf(page)}
      view={state.view}
      home={homeOf(state.patient)}
      look={(view) => set({ view })}
      isStill={isStill}
    />
  );
}

const hasInside = ({ closed, manifold, oriented }: Answer) => closed && manifold && oriented;

function liveNumber({ answer, say, texts }: Page): LiveNumber {
  return {
    value: answer.faults,
    shown: say.whole(answer.faults),
    label: texts.label,
    meaning: answer.faults ? (hasInside(answer) ? texts.left : texts.sick) : texts.well(say.number(answer.volume ?? 0)),
    tone: answer.faults ? "bad" : "good",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  return (
    <>
      <Choice
        name="patient"
        class="patients"
        legend={texts.patient}
        value={state.patient}
        options={PATIENTS.map((value) => ({ value, label: texts.patients[value] }))}
        choose={(patient) => set({ patient, cures: [], view: homeOf(patient) })}
      />
      <div>
        <h3>{texts.findings}</h3>
        {answer.findings.length === 0 && <p class="aside">{texts.nothing}</p>}
        <ul class="findings">
          {answer.findings.map(({ defect, is_fault, count, cure }) => (
            <li key={defect} class={is_fault ? "fault" : "remark"}>
              <b>
                <Data name={defect} value={count}>
                  {say.whole(count)}
                </Data>{" "}
                {texts.defects[defect][count === 1 ? 0 : 1]}
              </b>
              <p>{texts.defects[defect][2]}</p>
              {cure && cure === answer.next && answer.findings.find((other) => other.cure === cure)?.defect === defect && (
                <button
                  type="button"
                  onClick={() => set(({ cures }) => (cures.length < MOST_CURES ? { cures: [...cures, cure] } : {}))}
                >
                  {texts.cures[cure]}
                </button>
              )}
            </li>
          ))}
        </ul>
      </div>
      {answer.done.length > 0 && (
        <div>
          <h3>{texts.done}</h3>
          <ol class="done">
            {answer.done.map(({ cure, changes, moved_at_most }, i) => (
              <li key={i}>
                {texts.cures[cure]}: {changes.map(([what, n]) => texts.changed(what, say.whole(n))).join(texts.comma)}
                {texts.comma}
                {moved_at_most === 0 ? texts.still : texts.moved(say.number(moved_at_most ?? 0))}
              </li>
            ))}
          </ol>
          <button type="button" onClick={() => set(({ cures }) => ({ cures: cures.slice(0, -1) }))}>
            {texts.undo}
          </button>
        </div>
      )}
      <dl>
        {(["closed", "manifold", "oriented"] as const).map((fact) => (
          <div key={fact}>
            <dt>{texts.facts[fact]}</dt>
            <dd>
              <Data name={fact} value={answer[fact] ? 1 : 0}>
                {answer[fact] ? texts.yes : texts.no}
              </Data>
            </dd>
          </div>
        ))}
        <div>
          <dt>{texts.volume}</dt>
          <dd>
            <Data name="volume" value={hasInside(answer) ? answer.volume : null}>
              {answer.volume === null || !hasInside(answer) ? texts.noVolume : say.number(answer.volume)}
            </Data>
          </dd>
        </div>
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: { patient: ["p", word(...PATIENTS)], cures: ["c", words(CURE_NAMES, MOST_CURES)], view: ["o", view] },
  question: ({ patient, cures }) => ({ patient, cures }),
  texts: DOCTOR,
  number: liveNumber,
  Figure,
  Panel,
});
