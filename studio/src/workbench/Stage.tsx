// The picture: the mesh in 3D over the whole window, its ground and sizes, what is measured on it and where it is cut. Beside it,
// in a panel: the field, the deviation of the mesh, or its shading cost.
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { Grip } from "../exhibits/Grip";
import { PAINT } from "../exhibits/paint";
import { type Pull, Scene } from "../exhibits/Scene";
import { Choice, Slider } from "../view/parts";
import { type Layer, type Picture, type Projector, type Size, type Vec3, projector } from "../viewer";
import { axesOf, cross, minus, plus, unit as unitOf } from "../viewer/view";
import { Working } from "./Certificate";
import { hasField, isScript } from "./document";
import { type Part, boxOf } from "./glb";
import type { LayoutControl } from "./layout/layout";
import { LAYOUT_TEXTS } from "./layout/texts";
import { LiveField } from "./LiveField";
import { levelAt } from "./Levels";
import { MeasureCard, MeasureMarks } from "./measure/Measures";
import { hit, normalOf as faceNormal } from "./measure/solid";
import { MEASURE_TEXTS } from "./measure/texts";
import { TOOLS, type Tool, useMeasures } from "./measure/useMeasures";
import { useSolid } from "./measure/useSolid";
import { besideOf, besides } from "./pictures";
import type { Box } from "./pixels";
import { drawSlice } from "./slice";
import { GridLabels, Sizes, Triad, gridMiddle, groundLayers } from "./stage/ground";
import { roomFor } from "./stage/framing";
import { type Look, layersOf } from "./stage/layers";
import { type Hands, SIDES, SIDE_NAMES, fitted, orbit } from "./stage/orbit";
import { ALIGNED, type Cut, FIRST, flipped, isKept, normalOf, placeOf, planeOf } from "./stage/section";
import type { CallSite } from "./trace/shadow";
import type { Page } from "./words";

const LOOKS: readonly Look[] = ["shaded", "wire", "normals", "culled"];
/** The height of the tools over the picture, in pixels. */
const TOOLS_HEIGHT = 44;
/** Where the first picture's axes are drawn, from the lower left of the part that no panel covers. */
const TRIAD = 46;
/** Degrees for a step of the key that turns the section. */
const TURN = 5;
/** The handle that turns the section is this share of the box's diagonal away from the plane. */
const ARM = 0.3;

/** The part of the window that no panel and no bar covers, in pixels from each side. */
export interface Covered {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

interface StageProps {
  page: Page;
  marked: readonly Vec3[];
  layout: LayoutControl;
  covered: Covered;
  /** The side of a square of the grid, and the symbol of the unit. */
  step: number;
  unit: string;
  /** Layers over the mesh, such as the faces of a line of the script. */
  extra: readonly Layer[];
  /** The calls of the script whose faces are marked. */
  chosen: readonly CallSite[];
  /** Shows a call in the script. */
  show(site: CallSite): void;
  /** A point of a face was pressed while nothing is measured; without one, nothing is to be marked any more. */
  tapped(at?: Vec3, normal?: Vec3): void;
}

export function Stage({ page, marked, layout, covered, step, unit, extra, chosen, show, tapped }: StageProps) {
  const { words, state, control, language } = page;
  const { shown, levels, view, home } = state;
  const texts = LAYOUT_TEXTS[language];
  const measuring = MEASURE_TEXTS[language];
  const { hasGrid, hasSizes } = layout.layout;
  const [look, setLook] = useState<Look>("shaded");
  const [cut, setCut] = useState<Cut | null>(null);
  const [size, setSize] = useState<Size>({ width: 720, height: 480 });
  const level = levelAt(page);
  const parts = level === null ? (shown?.parts ?? NOTHING) : (levels!.parts[level] ?? NOTHING);
  const box = useMemo(() => boxOf(parts), [parts]);
  const plane = useMemo(() => (cut && box ? planeOf(cut, box) : undefined), [cut, box]);
  const solid = useSolid(parts);
  const isShown = (at: Vec3) => isKept(plane?.section, at);
  const measures = useMeasures(solid, parts, isShown, shown?.certificate.bound?.at_most ?? 0);
  const [midX, midY] = gridMiddle(view, step);
  const picture = useMemo<Picture>(
    () => ({
      layers: [
        ...layersOf(parts, look, marked, home.distance),
        ...(hasGrid && box ? groundLayers(box, step, [midX, midY]) : []),
        ...(plane && box ? [outlineOf(plane.at, normalOf(cut!), box)] : []),
        ...extra,
      ],
      ...(plane ? { section: plane.section } : {}),
    }),
    [parts, look, marked, home, hasGrid, box, step, midX, midY, plane, extra],
  );
  const shift = useMemo(
    () => [(covered.left - covered.right) / 2, (covered.top - covered.bottom) / 2] as const,
    [covered.left, covered.right, covered.top, covered.bottom],
  );
  const room = roomFor(size, { width: size.width - covered.left - covered.right, height: size.height - covered.top - covered.bottom - TOOLS_HEIGHT });
  useEffect(() => control?.sight.makeRoom(room), [control, room]);
  const centre = [size.width / 2 + shift[0], size.height / 2 + shift[1]] as const;
  const under = (x: number, y: number) => {
    const from = projector(control!.state.view, { ...size, shift });
    return solid.current ? hit(solid.current, from.origin(x, y), from.ray(x, y), 0, isShown) : undefined;
  };
  const press = (x: number, y: number) => {
    const found = under(x, y);
    if (found) tapped(found.at, faceNormal(solid.current!, found.face));
    else tapped();
  };
  const toggleParallel = () => control?.look({ ...control.state.view, isParallel: !control.state.view.isParallel });

  const hands = useRef<Hands>(null!);
  const at = () => projector(control!.state.view, { ...size, shift });
  hands.current = {
    under: (x, y) => under(x, y)?.at,
    hover: (x, y) => measures.hover(at(), x, y),
    key: ({ key }) => {
      const pressed = key.toLowerCase();
      if (pressed === "p") toggleParallel();
      else if (pressed === "g") layout.change({ hasGrid: !hasGrid });
      else if (pressed === "d") layout.change({ hasSizes: !hasSizes });
      else if (pressed === "c") setCut(cut ? null : FIRST);
      else if (pressed === "f") control?.look(fitted(control.state.view, home));
      else if (pressed === "m") measures.choose(measures.tool ? TOOLS[TOOLS.indexOf(measures.tool) + 1] ?? null : "distance");
      else if (key === "Enter" && measures.tool) measures.press(at(), ...centre);
      else if (key !== "Escape") return false;
      else if (!measures.clear()) tapped();
      return true;
    },
  };
  // Escape clears wherever the focus is, except in a text.
  useEffect(() => {
    const escape = (event: KeyboardEvent) => {
      const isText = event.target instanceof Element && event.target.closest("input[type=text], textarea, .script-editor");
      if (event.key === "Escape" && !isText && !event.defaultPrevented) hands.current.key(event);
    };
    addEventListener("keydown", escape);
    return () => removeEventListener("keydown", escape);
  }, []);

  const across = plane && placeOf(plane);
  const placed = across && `${across.axis} = ${page.say.number(across.value)}${unit && ` ${unit}`}`;
  const pulls: Pull[] =
    cut && plane
      ? [
          {
            name: words.cutAt,
            spoken: page.say.percent(cut.share),
            value: cut.share,
            low: 0,
            high: 1,
            step: 0.01,
            at: plane.at,
            along: plus(plane.at, minus(plane.high, plane.low)),
            move: (change) => setCut((old) => old && { ...old, share: change(old.share) }),
          },
        ]
      : [];
  return (
    <section class="stage-column" id="figure" tabindex={-1} aria-label={words.mesh}>
      <Scene
        name={words.mesh}
        help="turn-hint"
        picture={picture}
        view={view}
        home={home}
        look={(next) => control?.look(next)}
        isStill={!control}
        shift={shift}
        steer={(element, camera) =>
          orbit(element, camera, {
            under: (x, y) => hands.current.under(x, y),
            hover: (x, y) => hands.current.hover(x, y),
            key: (event) => hands.current.key(event),
          })
        }
        tap={(at, x, y) => (measures.tool ? measures.press(at, x, y) : press(x, y))}
        pulls={pulls}
        over={(at) => (
          <>
            {hasGrid && box && <GridLabels page={page} at={at} view={view} box={box} step={step} />}
            {hasSizes && box && <Sizes page={page} at={at} view={view} box={box} unit={unit} />}
            {control && <Triad view={view} x={covered.left + TRIAD} y={size.height - covered.bottom - TRIAD} />}
            <MeasureMarks page={page} at={at} measures={measures} unit={unit} centre={centre} />
            {cut && plane && box && <Turner page={page} cut={cut} at={at} from={plane.at} box={box} set={setCut} />}
          </>
        )}
      />
      <Measure page={page} setSize={setSize} />
      <div class="over-picture">
        <div class="tools" role="group" aria-label={texts.tools}>
          <Switch label={words.section} isOn={cut !== null} set={() => setCut(cut ? null : FIRST)} />
          <select
            aria-label={measuring.measure}
            class={measures.tool ? "on" : ""}
            value={measures.tool ?? ""}
            onChange={(event) => measures.choose((event.currentTarget.value || null) as Tool | null)}
          >
            <option value="">{measures.tool ? measuring.tools.none : `${measuring.measure}…`}</option>
            {TOOLS.map((value) => (
              <option key={value} value={value}>
                {measuring.tools[value]}
              </option>
            ))}
          </select>
          <select aria-label={texts.look} value={look} onChange={(event) => setLook(event.currentTarget.value as Look)}>
            {LOOKS.map((value) => (
              <option key={value} value={value}>
                {words.shows[value]}
              </option>
            ))}
          </select>
          <select
            aria-label={texts.from}
            value=""
            onChange={(event) => {
              const { value } = event.currentTarget;
              const side = SIDE_NAMES.find((name) => name === value);
              control?.look({ ...fitted(view, home), ...(side ? SIDES[side] : {}) });
              event.currentTarget.value = "";
            }}
          >
            <option value="" hidden>
              {texts.from}
            </option>
            {(["fit", ...SIDE_NAMES] as const).map((value) => (
              <option key={value} value={value}>
                {texts.sides[value]}
              </option>
            ))}
          </select>
          <Switch label={texts.parallel} isOn={Boolean(view.isParallel)} set={toggleParallel} />
          <Switch label={texts.grid} isOn={hasGrid} set={() => layout.change({ hasGrid: !hasGrid })} />
          <Switch label={texts.sizes} isOn={hasSizes} set={() => layout.change({ hasSizes: !hasSizes })} />
        </div>
        {cut && (
          <div class="card section-card">
            <Slider
              id="cut"
              label={words.cutAt}
              shown={placed ? `${page.say.percent(cut.share)}, ${placed}` : page.say.percent(cut.share)}
              low={0}
              high={1}
              step={0.01}
              value={cut.share}
              choose={(share) => setCut({ ...cut, share })}
            />
            <div class="row tight">
              {(["x", "y", "z"] as const).map((axis) => (
                <button
                  type="button"
                  key={axis}
                  aria-pressed={cut.azimuth === ALIGNED[axis].azimuth && cut.elevation === ALIGNED[axis].elevation}
                  onClick={() => setCut({ ...cut, ...ALIGNED[axis] })}
                >
                  {measuring.align} {axis}
                </button>
              ))}
              <button type="button" onClick={() => setCut(flipped(cut))}>
                {measuring.flip}
              </button>
            </div>
          </div>
        )}
        {chosen.length > 0 && (
          <p class="card site" role="status">
            {chosen.map((site) => (
              <button type="button" key={site.from} title={texts.toScript} onClick={() => show(site)}>
                {words.atLine(site.line)} <code>{site.name}()</code>
              </button>
            ))}
          </p>
        )}
        <MeasureCard page={page} measures={measures} unit={unit} isReady={solid.isReady} />
      </div>
      <p class="spoken" id="turn-hint">
        <span class="with-pointer">{texts.hint}</span>
        <span class="with-finger">{texts.hintTouch}</span>
      </p>
    </section>
  );
}

/** The same list each time, so that nothing is drawn anew. */
const NOTHING: readonly Part[] = [];

function Switch({ label, isOn, set }: { label: string; isOn: boolean; set(): void }) {
  return (
    <label class="switch">
      <input type="checkbox" checked={isOn} onChange={set} />
      <span>{label}</span>
    </label>
  );
}

/** The handle that turns the section. */
function Turner({ page, cut, at, from, box, set }: { page: Page; cut: Cut; at: Projector; from: Vec3; box: Box; set(cut: Cut): void }) {
  const texts = MEASURE_TEXTS[page.language];
  const arm = ARM * Math.hypot(...minus(box[1], box[0]));
  const normal = normalOf(cut);
  const tip = plus(from, normal, arm);
  const [[x0, y0], [x, y, depth]] = [at.to(from), at.to(tip)];
  const turned = (azimuth: number, elevation: number) =>
    set({ ...cut, azimuth: ((azimuth + 540) % 360) - 180, elevation: Math.min(Math.max(elevation, -90), 90) });
  return (
    <>
      <path class="arm" d={`M${x0.toFixed(1)} ${y0.toFixed(1)}L${x.toFixed(1)} ${y.toFixed(1)}`} />
      <Grip
        name={texts.cutTurn}
        spoken={texts.cutTurned(page.say.degrees(cut.azimuth), page.say.degrees(cut.elevation))}
        now={Math.round(cut.azimuth)}
        low={-180}
        high={180}
        at={[x, y]}
        isStill={!page.control}
        grab={() => {
          const [right, up] = axesOf(page.state.view);
          const scale = at.scale(depth);
          return (dx, dy) => {
            const [nx, ny, nz] = unitOf(plus(plus(minus(tip, from), right, dx / scale), up, -dy / scale));
            turned((Math.atan2(ny, nx) * 180) / Math.PI, (Math.asin(nz) * 180) / Math.PI);
          };
        }}
        step={(right, up) => Number.isFinite(right) && turned(cut.azimuth + TURN * right, cut.elevation + TURN * up)}
      />
    </>
  );
}

/** The outline of the section plane, a little larger than the shape. */
function outlineOf(at: Vec3, normal: Vec3, [low, high]: Box): Layer {
  const steep = Math.abs(normal[2]) > 0.9;
  const u = unitOf(steep ? [normal[2], 0, -normal[0]] : [-normal[1], normal[0], 0]);
  const v = cross(normal, u);
  // The middle of the box is on the line of the plane's own middle, so half of the box's extent along each side suffices.
  const half = (axis: Vec3) => 0.55 * axis.reduce((sum, x, k) => sum + Math.abs(x) * (high[k]! - low[k]!), 0);
  const [a, b] = [half(u), half(v)];
  const corners = [[-a, -b], [a, -b], [a, b], [-a, b]].map(([s, t]) => plus(plus(at, u, s), v, t));
  const positions = Float32Array.from(corners.flatMap((corner, i) => [...corner, ...corners[(i + 1) % 4]!]));
  return { kind: "lines", id: "section", positions, paint: PAINT.mark, width: 2, isWhole: true };
}

/** Reports the size of the picture to the controller, because pixel budgets depend on it. */
function Measure({ page, setSize }: { page: Page; setSize(size: Size): void }) {
  const mark = useRef<HTMLSpanElement>(null);
  const control = useRef(page.control);
  control.current = page.control;
  useEffect(() => {
    const scene = mark.current!.parentElement!.querySelector(".scene")!;
    const sizeObserver = new ResizeObserver(() => {
      const { clientWidth: width, clientHeight: height } = scene;
      if (!width || !height) return;
      setSize({ width, height });
      control.current?.resize({ width, height });
    });
    sizeObserver.observe(scene);
    return () => sizeObserver.disconnect();
  }, []);
  return <span ref={mark} hidden />;
}

/** The picture beside the mesh. */
export function Beside({ page }: { page: Page }) {
  const { words, state, control } = page;
  const canvas = useRef<HTMLCanvasElement>(null);
  const [height, setHeight] = useState(0.5);
  const { picture, slice } = state;
  const kind = besideOf(state.bench, state.beside);
  const isSliced = kind === "sliced";
  const currentPicture = picture?.kind === kind ? picture : null;
  useEffect(() => {
    const element = canvas.current;
    if (!element) return undefined;
    let isOld = false;
    if (currentPicture) {
      void createImageBitmap(new Blob([currentPicture.png as BlobPart])).then((bitmap) => {
        if (!isOld) {
          Object.assign(element, { width: bitmap.width, height: bitmap.height });
          element.getContext("2d")?.drawImage(bitmap, 0, 0);
        }
        bitmap.close();
      });
    } else if (isSliced && slice) drawSlice(element, slice, height);
    return () => {
      isOld = true;
    };
  }, [currentPicture, slice, isSliced, height]);
  const [isLive, setLive] = useState(false);
  const isTraced = kind === "traced";
  const isCurrent = currentPicture?.view === state.view && currentPicture.bench === state.bench;
  const { bound, overshade } = currentPicture?.report.certificate ?? {};
  const still = (
    <canvas
      ref={canvas}
      class="field-picture"
      role="img"
      aria-label={words.beside + page.say.marks.colon + words.besides[kind]}
      hidden={isSliced ? !slice : !currentPicture && !(isTraced && isLive)}
      width={720}
      height={480}
    />
  );
  return (
    <figure class="field-pane">
      <Choice
        name="beside"
        legend={words.beside}
        value={kind}
        options={besides(state.bench).map((value) => ({ value, label: words.besides[value] }))}
        choose={(next) => control?.besides(next)}
      />
      {isTraced ? (
        <LiveField page={page} isCurrent={isCurrent} drawn={setLive}>
          {still}
        </LiveField>
      ) : (
        still
      )}
      {isSliced && slice && (
        <Slider
          id="slice"
          label={words.sliceAt}
          shown={page.say.number(slice.origin[2] + slice.spacing * height * (slice.size[2] - 1))}
          spoken={String(slice.origin[2] + slice.spacing * height * (slice.size[2] - 1))}
          low={0}
          high={1}
          step={1 / Math.max(slice.size[2] - 1, 1)}
          value={height}
          choose={setHeight}
        />
      )}
      {isSliced && !slice && (
        <button type="button" onClick={() => void control?.onDemand.bake()}>
          {words.bakeForSlice}
        </button>
      )}
      {kind === "distance" && bound && (
        <p class="aside" data-says="distance">
          {words.distanceSays(page.say.number(state.shown?.certificate.bound?.at_most ?? bound.at_most ?? 0), page.say.number(bound.at_least))}
        </p>
      )}
      {kind === "overshade" && overshade && (
        <p class="aside" data-says="overshade">
          {words.overshadeSays(page.say.fixed(overshade.every.lanes / Math.max(overshade.covered_px, 1)), overshade.missed + overshade.micro, overshade.in_view)}
        </p>
      )}
      {!isScript(state.bench) && !hasField(state.bench) && isSliced && <p class="aside">{words.noField}</p>}
      <Working page={page} lanes={isSliced ? ["slice"] : ["picture"]} />
    </figure>
  );
}
