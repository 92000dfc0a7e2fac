// The mesh doctor: six defective meshes, the defects that the core finds, and the results of its repairs.
import { CURE_NAMES, type Cure } from "../core/cures";
import { Choice, Figure as Data, Row } from "../view/parts";
import { type Layer, type Picture, type Vec3, type View, facing } from "../viewer";
import { DOCTOR, type Defect, PATIENTS, type Patient, type Texts } from "./doctor_texts";
import { exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { number, view, word, words } from "./fragment";
import { PAINT } from "./paint";
import { Scene } from "./Scene";

interface State {
  patient: Patient;
  cures: readonly Cure[];
  /** The place that the reader chose, counted through all findings; −1 if none. */
  place: number;
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
const NONE = -1;
/** Ten places of each kind of defect. */
const MOST_PLACES = 130;
const HOME: View = { azimuth: -52, elevation: 30, distance: 5.4, target: [0, 0, 0] };
const defaults: State = { patient: "hole", cures: [], place: NONE, view: HOME };
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

/** The lines and dots of places. One corner is a dot, two are an edge, three a triangle. */
function marks(id: string, places: readonly Vec3[][], width: number): Layer[] {
  const flat = (points: readonly Vec3[]) => new Float32Array(points.flat());
  const dots = places.filter((corners) => corners.length === 1).flat();
  const lines = places.flatMap(([a, b, c]) => (c ? [a!, b!, b!, c, c, a!] : b ? [a!, b] : []));
  return [
    ...(lines.length ? [{ kind: "lines", id: `${id}-edges`, positions: flat(lines), paint: "--gap", width, isMark: true } as const] : []),
    ...(dots.length ? [{ kind: "points", id: `${id}-dots`, positions: flat(dots), paint: "--gap", size: 2 * width + 3, isMark: true } as const] : []),
  ];
}

const placesOf = ({ findings }: Answer) => findings.flatMap(({ places }) => places);
const middleOf = (corners: readonly Vec3[]): Vec3 => [0, 1, 2].map((k) => corners.reduce((sum, p) => sum + p[k]!, 0) / corners.length) as unknown as Vec3;

function pictureOf({ state, answer }: Page): Picture {
  const { positions, indices } = answer.mesh;
  const places = placesOf(answer);
  const chosen = places[state.place];
  return {
    layers: [
      { kind: "mesh", id: "patient", positions, indices, paint: PAINT.front, back: PAINT.back, shading: "flat", sides: "both" },
      { kind: "wire", id: "wire", positions, indices, paint: "#24446b", width: 0.8 },
      ...marks("all", places, 3.5),
      ...(chosen ? marks("chosen", [chosen], 8) : []),
    ],
  };
}

function Figure({ page }: { page: Page }) {
  const { state, say, texts, set, isStill } = page;
  return (
    <Scene
      name={`${texts.figure}${say.marks.colon}${texts.patients[state.patient]}`}
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

/** A button for each place of a finding, which turns the view to it. */
function Places({ page, finding }: { page: Page; finding: number }) {
  const { state, answer, texts, say, set } = page;
  const { places, count, defect } = answer.findings[finding]!;
  const first = answer.findings.slice(0, finding).reduce((sum, { places }) => sum + places.length, 0);
  const turn = (k: number) =>
    set(({ view, patient }) => ({ place: first + k, view: facing(middleOf(places[k]!), view, homeOf(patient).target) }));
  return (
    <div class="places" role="group" aria-label={`${texts.places}${say.marks.colon}${texts.defects[defect][1]}`}>
      <span>{places.length < count ? texts.firstPlaces(say.whole(places.length)) : texts.places}</span>
      {places.map((_, k) => (
        <button type="button" key={k} aria-label={texts.place(k + 1)} aria-pressed={first + k === state.place} onClick={() => turn(k)}>
          {k + 1}
        </button>
      ))}
    </div>
  );
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
        choose={(patient) => set({ patient, cures: [], place: NONE, view: homeOf(patient) })}
      />
      <div>
        <h3>{texts.findings}</h3>
        {answer.findings.length === 0 && <p class="aside">{texts.nothing}</p>}
        <ul class="findings">
          {answer.findings.map(({ defect, is_fault, count, cure }, finding) => (
            <li key={defect} class={is_fault ? "fault" : "remark"}>
              <b>
                <Data name={defect} value={count}>
                  {say.whole(count)}
                </Data>{" "}
                {texts.defects[defect][count === 1 ? 0 : 1]}
              </b>
              <p>{texts.defects[defect][2]}</p>
              <Places page={page} finding={finding} />
              {cure && cure === answer.next && answer.findings.find((other) => other.cure === cure)?.defect === defect && (
                <button
                  type="button"
                  onClick={() => set(({ cures }) => (cures.length < MOST_CURES ? { cures: [...cures, cure], place: NONE } : {}))}
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
                {texts.cures[cure]}
                {say.marks.colon}
                {changes.map(([what, n]) => texts.changed(what, say.whole(n))).join(texts.comma)}
                {texts.comma}
                {moved_at_most === 0 ? texts.still : texts.moved(say.number(moved_at_most ?? 0))}
              </li>
            ))}
          </ol>
          <button type="button" onClick={() => set(({ cures }) => ({ cures: cures.slice(0, -1), place: NONE }))}>
            {texts.undo}
          </button>
        </div>
      )}
      <dl>
        {(["closed", "manifold", "oriented"] as const).map((fact) => (
          <Row key={fact} name={fact} label={texts.facts[fact]} value={answer[fact] ? 1 : 0}>
            {answer[fact] ? texts.yes : texts.no}
          </Row>
        ))}
        <Row name="volume" label={texts.volume} value={hasInside(answer) ? answer.volume : null}>
          {answer.volume === null || !hasInside(answer) ? texts.noVolume : say.number(answer.volume)}
        </Row>
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: { patient: ["p", word(...PATIENTS)], cures: ["c", words(CURE_NAMES, MOST_CURES)], place: ["k", number(NONE, MOST_PLACES)], view: ["o", view] },
  question: ({ patient, cures }) => ({ patient, cures }),
  texts: DOCTOR,
  number: liveNumber,
  Figure,
  Panel,
});
