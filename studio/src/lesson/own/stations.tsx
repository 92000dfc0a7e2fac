// The stations at which the lesson shows a shape of the reader's own, one component for each. Every number is of a report.
import type { ComponentType } from "preact";
import { useMemo, useState } from "preact/hooks";
import { PAINT } from "../../exhibits/paint";
import { Choice, Figure as Data } from "../../view/parts";
import { type Layer, type Vec3, exploded } from "../../viewer";
import { meaningIn, nameIn } from "../../workbench/command_zh";
import { isMesh } from "../../workbench/document";
import { type Part, toZUp, upOf } from "../../workbench/glb";
import { Said } from "../../workbench/Said";
import { layersOf } from "../../workbench/stage/layers";
import type { StationId } from "../outline";
import { Levels } from "./levels_station";
import { Live, Off, Pictured, type Row, Rows, Station, type StationPage, benchWords, isGood, knownBy } from "./parts";
import { BUDGETS, CELLS, type Run, SHADINGS, type Shading } from "./shape";

type Props = { page: StationPage };

/** The triangles of a run; none until it has made some. */
const partsOf = (run: Run | null): readonly Part[] => run?.made?.levels[0] ?? NONE;
const NONE: readonly Part[] = [];

/** The layers of parts, made once for each. */
function useLayers(parts: readonly Part[], look: "shaded" | "wire" | "normals", marked: readonly Vec3[] = NOWHERE, distance = 1): Layer[] {
  return useMemo(() => layersOf(parts, look, marked, distance), [parts, look, marked, distance]);
}
const NOWHERE: readonly Vec3[] = [];

function BudgetChoice({ page: { own, words, id } }: Props) {
  return (
    <Choice
      name={`own-${id}-budget`}
      legend={words.budget}
      value={own.budget}
      options={BUDGETS.map((value) => ({ value, label: value }))}
      choose={(budget) => own.choose(budget)}
    />
  );
}

function Triangles({ page }: Props) {
  const { own, words, say } = page;
  const run = own.mesh;
  const { made } = run;
  const layers = useLayers(partsOf(run), "wire");
  const bound = made?.certificate.bound ?? null;
  return (
    <Station page={page} runs={[run]} figure={<Pictured page={page} layers={layers} />} controls={<BudgetChoice page={page} />}>
      {made && (
        <>
          <Live
            label={words.triangles}
            name="triangles"
            value={made.certificate.output!.triangles!}
            shown={say.whole(made.certificate.output!.triangles!)}
            meaning={<Off page={page} name="off" bound={bound} />}
            isGood={isGood(bound)}
          />
          {made.isShort && <p class="aside">{words.short}</p>}
          <Rows page={page} rows={[[words.inFile, "in-file", made.report.run?.input_triangles]]} />
        </>
      )}
    </Station>
  );
}

const STORAGES = ["indexed", "unindexed"] as const;
/** How far the triangles come apart, as in the teapot's figure. */
const APART = 0.16;

function Buffers({ page }: Props) {
  const { own, words, say } = page;
  const [storage, setStorage] = useState<(typeof STORAGES)[number]>("indexed");
  const [run, mesh] = [own.inspection, own.mesh];
  const parts = partsOf(mesh);
  const whole = useLayers(parts, "wire");
  const apart = useMemo(
    () =>
      storage === "indexed"
        ? []
        : parts.map((part, k): Layer => ({ kind: "mesh", id: `apart-${k}`, ...exploded(part, APART), paint: PAINT.front, shading: "flat", sides: "both" })),
    [parts, storage],
  );
  const { certificate, report } = run?.made ?? {};
  const sizes = report?.inspection?.sizes;
  return (
    <Station
      page={page}
      runs={run === own.facts ? [mesh, run] : [mesh, own.facts, own.plain, run]}
      figure={<Pictured page={page} layers={storage === "indexed" ? whole : apart} />}
      controls={
        <Choice
          name="own-storage"
          legend={words.storage}
          value={storage}
          options={STORAGES.map((value) => ({ value, label: words.stored[value] }))}
          choose={(value) => setStorage(value)}
        />
      }
    >
      {certificate && sizes && (
        <>
          <Live label={words.indexed} name="indexed" value={sizes.indexed_bytes} shown={say.bytes(sizes.indexed_bytes)} isGood={false} />
          <Rows
            page={page}
            rows={[
              [words.unindexed, "unindexed", sizes.unindexed_bytes, say.bytes(sizes.unindexed_bytes)],
              [words.vertices, "vertices", certificate.output?.vertices],
              // A file doubles vertices where normals or textures meet.
              ...(certificate.output?.positions === certificate.output?.vertices ? [] : ([[words.positions, "positions", certificate.output?.positions]] as const)),
              [words.triangles, "inspected-triangles", certificate.output?.triangles],
              [words.perVertex, "per-vertex", certificate.valid?.triangles_per_vertex],
            ]}
          />
        </>
      )}
    </Station>
  );
}

function Normals({ page }: Props) {
  const { own, words, say } = page;
  const [shading, setShading] = useState<Shading>("crease=30deg");
  const runs = SHADINGS.map((one) => own.normals(one));
  const run = runs[SHADINGS.indexOf(shading)]!;
  const layers = useLayers(partsOf(run), "normals", NOWHERE, own.home.distance);
  const vertices = run?.made?.certificate.output?.vertices;
  return (
    <Station
      page={page}
      runs={[own.plain, ...runs]}
      figure={<Pictured page={page} layers={layers} />}
      controls={
        <Choice
          name="own-shading"
          legend={words.shading}
          value={shading}
          options={SHADINGS.map((value) => ({ value, label: words.shadings[value] }))}
          choose={(value) => setShading(value)}
        />
      }
    >
      {vertices !== undefined && (
        <>
          <Live label={words.verticesOf} name="normal-vertices" value={vertices} shown={say.whole(vertices)} isGood={false} />
          <Rows
            page={page}
            rows={SHADINGS.map((one, k): Row => [words.shadings[one], `normal-vertices-${one}`, runs[k]?.made?.certificate.output?.vertices])}
          />
        </>
      )}
    </Station>
  );
}

function Sound({ page }: Props) {
  const { own, words, say, language } = page;
  const [run, mesh] = [own.inspection, own.mesh];
  const { certificate, report } = run?.made ?? {};
  const valid = certificate?.valid;
  // Places of the file itself, unless its nodes move the parts.
  const places = useMemo(
    () => (isMesh(own.shape!) && valid?.in_place !== false ? (valid?.witnesses ?? []).map(({ at }) => toZUp(at, upOf(own.shape!.name, certificate!.frame))) : NOWHERE),
    [valid, certificate],
  );
  const layers = useLayers(partsOf(mesh), "shaded", places);
  const isSound = Boolean(valid?.closed && valid.manifold);
  const yes = (is: boolean) => (is ? words.yes : words.no);
  return (
    <Station page={page} runs={run === own.facts ? [mesh, run] : [mesh, own.facts, own.plain, run]} figure={<Pictured page={page} layers={layers} />}>
      {valid && (
        <>
          <Rows
            page={page}
            rows={[
              [words.isClosed, "closed", Number(valid.closed), yes(valid.closed)],
              [words.isManifold, "manifold", Number(valid.manifold), yes(valid.manifold)],
              [words.components, "components", valid.components],
              [benchWords(page).genus, "genus", valid.genus],
            ]}
          />
          <p>{isSound ? words.inside : words.noInside}</p>
          <ul class="own-found">
            {(report!.inspection!.findings ?? []).map((finding) => (
              <li key={finding.of}>
                <data data-name={`own-found-${finding.of}`} value={finding.count}>
                  {say.whole(finding.count)}
                </data>{" "}
                <Said words={nameIn(language, finding)} />. <Said words={meaningIn(language, finding)} />
              </li>
            ))}
          </ul>
          {places.length > 0 && <p class="aside">{words.places(say.whole(places.length))}</p>}
        </>
      )}
    </Station>
  );
}

function Field({ page }: Props) {
  const { own, words, say } = page;
  const [cells, setCells] = useState<(typeof CELLS)[number]>(20);
  const [facts, field, back] = [own.facts, own.field(cells), own.back(cells)];
  const layers = useLayers(partsOf(back), "wire");
  const rule = facts.made?.report.inspection?.field;
  const mesh = rule ? own.mesh : null;
  const baked = field.made?.certificate.baked;
  const certificate = back?.made?.certificate;
  const total = certificate?.history?.total;
  return (
    <Station
      page={page}
      runs={[facts, field, back, ...(mesh ? [mesh] : [])]}
      figure={<Pictured page={page} layers={layers} />}
      controls={
        <Choice
          name="own-cells"
          legend={words.cells}
          value={cells}
          options={CELLS.map((value) => ({ value, label: String(value) }))}
          choose={(value) => setCells(value)}
        />
      }
    >
      {baked && certificate && (
        <>
          <Live
            label={words.backTriangles}
            name="back-triangles"
            value={certificate.output!.triangles!}
            shown={say.whole(certificate.output!.triangles!)}
            meaning={<Off page={page} name="back-off" bound={total ?? null} />}
            isGood={isGood(total)}
          />
          <Rows
            page={page}
            rows={[
              ...(rule ? ([[words.terms, "terms", rule.terms], [words.outside, "outside", null, words.worth[rule.outside] ?? rule.outside]] as const) : []),
              ...(mesh?.made ? ([[words.ruleOff, "rule-off", mesh.made.certificate.bound?.at_most]] as const) : []),
              [words.samples, "samples", null, baked.size.join(" × ")],
              [words.spacing, "spacing", baked.spacing],
              [words.samplesOff, "samples-off", baked.off_at_most],
            ]}
          />
        </>
      )}
    </Station>
  );
}

function Bound({ page }: Props) {
  const { own, words, say } = page;
  const run = own.mesh;
  const { made } = run;
  const layers = useLayers(partsOf(run), "shaded");
  const { bound, budget, output } = made?.certificate ?? {};
  return (
    <Station page={page} runs={[run]} figure={<Pictured page={page} layers={layers} />} controls={<BudgetChoice page={page} />}>
      {made && bound && (
        <>
          <p class="own-bound">
            {bound.at_most === null || !budget?.length ? (
              <Off page={page} name="bound" bound={bound} />
            ) : (
              words.broughtAndLeft(
                own.budget,
                <Data name="own-length" value={budget.length}>
                  {say.number(budget.length)}
                </Data>,
                <Data name="own-left" value={output!.triangles!}>
                  {say.whole(output!.triangles!)}
                </Data>,
                <Data name="own-bound" value={bound.at_most}>
                  {say.number(bound.at_most)}
                </Data>,
                knownBy(page, bound),
              )
            )}
          </p>
          {made.isShort && <p class="aside">{words.short}</p>}
        </>
      )}
      {own.address && (
        <p>
          <a class="begin" href={`${page.language === "en" ? "workbench.html" : "workbench.zh.html"}${own.address}`}>
            {words.openBench}
          </a>
          <br />
          <span class="aside">{words.benchNote}</span>
        </p>
      )}
    </Station>
  );
}

export const COMPONENTS: Record<StationId, ComponentType<Props>> = {
  triangles: Triangles,
  buffers: Buffers,
  normals: Normals,
  sound: Sound,
  field: Field,
  levels: Levels,
  bound: Bound,
};
