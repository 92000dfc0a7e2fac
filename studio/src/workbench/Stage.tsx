// The pictures: the mesh in 3D, and beside it the field, the deviation of the mesh, or its shading cost.
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { PAINT } from "../exhibits/paint";
import { Scene } from "../exhibits/Scene";
import { Choice, Slider } from "../view/parts";
import type { Layer, Picture, Section, Vec3 } from "../viewer";
import { Working } from "./Certificate";
import { hasField, isScript } from "./document";
import { besideOf, besides } from "./pictures";
import { type Part, boxOf } from "./glb";
import { levelAt } from "./Levels";
import { isOutdated } from "./outdated";
import { drawSlice } from "./slice";
import type { Page } from "./words";

type Look = "shaded" | "wire" | "normals" | "culled";
const LOOKS: readonly Look[] = ["shaded", "wire", "normals", "culled"];
/** Longer lists of normals hide the surface. */
const MOST_NORMALS = 4000;

export function Stage({ page, marked }: { page: Page; marked: readonly Vec3[] }) {
  const { words, state, control } = page;
  const { shown, levels, view, home, bench } = state;
  const [look, setLook] = useState<Look>("shaded");
  const [pane, setPane] = useState<"mesh" | "field" | "both">("both");
  /** Position of the section, from 0 at the front to 1 at the back; `null` without a section. */
  const [cut, setCut] = useState<number | null>(null);
  const level = levelAt(page);
  const parts = level === null ? (shown?.parts ?? []) : (levels!.parts[level] ?? []);
  const section = useMemo(() => sectionOf(parts, cut), [parts, cut]);
  const picture = useMemo<Picture>(
    () => ({ layers: layersOf(parts, look, marked, home.distance), ...(section ? { section } : {}) }),
    [parts, look, marked, home, section],
  );
  const isTwo = pane === "both";
  return (
    <section class="stage-column" id="figure" tabindex={-1}>
      <div class="row tight">
        <Choice
          name="pane"
          legend={words.panes}
          value={pane}
          options={(["mesh", "field", "both"] as const).map((value) => ({ value, label: words[value] }))}
          choose={(next) => setPane(next)}
        />
        <Choice
          name="look"
          legend={words.show}
          value={look}
          options={LOOKS.map((value) => ({ value, label: words.shows[value] }))}
          choose={(next) => setLook(next)}
        />
      </div>
      <div class={`panes${isTwo ? " two" : ""}`}>
        {pane !== "field" && (
          <figure class="pane">
            <Scene
              name={words.mesh}
              help="turn-hint"
              picture={picture}
              view={view}
              home={home}
              look={(next) => control?.look(next)}
              isStill={!control}
            />
            <Measure page={page} />
            <label class="cut">
              <input type="checkbox" checked={cut !== null} onChange={(event) => setCut(event.currentTarget.checked ? 0.5 : null)} />
              {words.section}
            </label>
            {cut !== null && (
              <Slider
                id="cut"
                label={words.cutAt}
                shown={page.say.percent(cut)}
                spoken={page.say.percent(cut)}
                low={0}
                high={1}
                step={0.01}
                value={cut}
                choose={setCut}
              />
            )}
          </figure>
        )}
        {pane !== "mesh" && (
          <figure class="pane field-pane">
            <Beside page={page} />
            <Choice
              name="beside"
              legend={words.beside}
              value={besideOf(bench, state.beside)}
              options={besides(bench).map((value) => ({ value, label: words.besides[value] }))}
              choose={(next) => control?.besides(next)}
            />
          </figure>
        )}
      </div>
      {isOutdated(state) && <p class="outdated">{words.outdated}</p>}
      <p class="aside hint" id="turn-hint">
        {words.turnHint}
      </p>
      {!isScript(bench) && !hasField(bench) && pane !== "mesh" && besideOf(bench, state.beside) === "sliced" && <p class="aside">{words.noField}</p>}
    </section>
  );
}

/** Reports the size of the picture to the controller, because pixel budgets depend on it. */
function Measure({ page }: { page: Page }) {
  const mark = useRef<HTMLSpanElement>(null);
  const control = useRef(page.control);
  control.current = page.control;
  useEffect(() => {
    const scene = mark.current!.parentElement!.querySelector(".scene")!;
    const sizeObserver = new ResizeObserver(() => {
      const { clientWidth: width, clientHeight: height } = scene;
      if (width && height) control.current?.resize({ width, height });
    });
    sizeObserver.observe(scene);
    return () => sizeObserver.disconnect();
  }, []);
  return <span ref={mark} hidden />;
}

function Beside({ page }: { page: Page }) {
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
  const { bound, overshade } = currentPicture?.report.certificate ?? {};
  return (
    <>
      <canvas
        ref={canvas}
        class="field-picture"
        role="img"
        aria-label={`${words.beside}: ${words.besides[kind]}`}
        hidden={isSliced ? !slice : !currentPicture}
        width={720}
        height={480}
      />
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
        <button type="button" onClick={() => void control?.bake()}>
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
      <Working page={page} lanes={isSliced ? ["slice"] : ["picture"]} />
    </>
  );
}

/** A section plane across y: the half nearer to the initial eye is cut away. */
function sectionOf(parts: readonly Part[], cut: number | null): Section | undefined {
  const box = cut === null ? undefined : boxOf(parts);
  if (!box) return undefined;
  const [low, high] = [box[0][1], box[1][1]];
  return { normal: [0, -1, 0], offset: -(low + cut! * (high - low)), paint: PAINT.mark };
}

function layersOf(parts: readonly Part[], look: Look, marked: readonly Vec3[], distance: number): Layer[] {
  const layers = parts.flatMap((part, k): Layer[] => {
    const { positions, indices, normals, colors, groups, paints, uv, decoded } = part;
    const pictures = uv && decoded?.some(Boolean) && look !== "wire" ? { uv, of: decoded } : undefined;
    const paint = (color: string | undefined, k: number) => color ?? (pictures?.of[k] ? "#ffffff" : PAINT.front);
    const mesh: Layer = {
      kind: "mesh",
      id: `mesh-${k}`,
      positions,
      indices,
      ...(normals && look !== "wire" ? { normals } : {}),
      ...(colors && !pictures ? { colors } : {}),
      // With a single paint the triangles can share vertices, so no groups are needed.
      ...(paints.length > 1 || pictures ? { groups: { of: groups, paints: paints.map(paint) } } : {}),
      ...(pictures ? { pictures } : {}),
      paint: paint(paints[0], 0),
      back: PAINT.back,
      shading: normals && look !== "wire" ? "smooth" : "flat",
      sides: look === "culled" ? "front" : "both",
    };
    if (look === "wire") {
      return [mesh, { kind: "wire", id: `wire-${k}`, positions, indices, paint: "#1d232b", width: 1 }];
    }
    if (look === "normals" && normals) {
      const step = Math.max(1, Math.ceil(positions.length / 3 / MOST_NORMALS));
      const thinned = (rows: Float32Array) => rows.filter((_, i) => Math.floor(i / 3) % step === 0);
      return [
        mesh,
        { kind: "normals", id: `normals-${k}`, at: thinned(positions), directions: thinned(normals), length: distance / 60, paint: "#8a5a00", width: 1.5 },
      ];
    }
    return [mesh];
  });
  if (marked.length) {
    layers.push({ kind: "points", id: "marked", positions: Float32Array.from(marked.flat()), paint: "#c62a12", size: 14, isOnTop: true });
  }
  return layers;
}
