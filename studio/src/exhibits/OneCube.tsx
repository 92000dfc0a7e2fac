// One cell of marching cubes: eight corners to switch, the triangles by the core, and the ambiguous faces.
import { Row } from "../view/parts";
import { type Layer, type Picture, type Vec3, type View, painted } from "../viewer";
import type { LiveNumber } from "./exhibit";
import { PAINT } from "./paint";
import { Scene } from "./Scene";
import type { Page } from "./squares";

export interface CubeAnswer {
  look: "cube";
  signs: number;
  mesh: { positions: Float32Array; indices: Uint32Array } | null;
  triangles: number;
  pieces: number;
  /** The corners of each ambiguous face. */
  faces: [number, number, number, number][];
  /** The segments of the readings that were not chosen. */
  other: Float32Array;
  readings: number;
  patterns: number;
  patterns_with_two: number;
  lost: number | null;
}

export const HOME: View = { azimuth: -64, elevation: 21, distance: 3.5, target: [0, 0, -0.05] };
const CORNERS = [0, 1, 2, 3, 4, 5, 6, 7] as const;
/** The radius of a finger, in pixels. */
const REACH = 26;

/** The signs as bits, 1 for inside. */
export const PRESETS = { corner: 4, edge: 12, diagonal: 9, opposite: 129, every: 105, sharp: 4 } as const;
export type Preset = keyof typeof PRESETS;

/** The bits of `i` are the coordinates of corner `i`. */
const positionOf = (corner: number): Vec3 => [0, 1, 2].map((k) => ((corner >> k) & 1) - 0.5) as unknown as Vec3;
const EDGES = CORNERS.flatMap((a) => [1, 2, 4].filter((bit) => !(a & bit)).flatMap((bit) => [positionOf(a), positionOf(a | bit)]));
const floats = (points: readonly Vec3[]) => new Float32Array(points.flat());
const isInside = (signs: number, corner: number) => ((signs >> corner) & 1) === 1;

/** The edges, within the cell, of a box with one corner in the middle of the cell. */
function box(signs: number): Vec3[] {
  // A single corner is inside, so `signs` has one bit.
  const insideCorner = positionOf(Math.log2(signs));
  const along = (...axes: number[]): Vec3 => [0, 1, 2].map((k) => (axes.includes(k) ? insideCorner[k]! : 0)) as unknown as Vec3;
  return [0, 1, 2].flatMap((k) => [along(), along(k), along(k), along(k, (k + 1) % 3), along(k), along(k, (k + 2) % 3)]);
}

function pictureOf({ state }: Page, answer: CubeAnswer): Picture {
  const { mesh, faces, other } = answer;
  const layers: Layer[] = [{ kind: "lines", id: "cell", positions: floats(EDGES), paint: "--soft", width: 1.4 }];
  if (faces.length) {
    layers.push({
      kind: "mesh",
      id: "faces",
      positions: floats(faces.flat().map(positionOf)),
      indices: new Uint32Array(faces.flatMap((_, i) => [0, 1, 2, 0, 2, 3].map((k) => 4 * i + k))),
      paint: PAINT.mark,
      shading: "none",
      sides: "both",
      opacity: 0.3,
    });
  }
  if (mesh) {
    layers.push(
      { kind: "mesh", id: "surface", ...mesh, paint: PAINT.front, back: PAINT.other, shading: "flat", sides: "both" },
      { kind: "wire", id: "sides", ...mesh, paint: "--ink", width: 2 },
    );
  }
  if (faces.length) layers.push({ kind: "lines", id: "other", positions: other, paint: "--gap", width: 2.4, isMark: true });
  if (state.sharp && answer.lost !== null) {
    layers.push({ kind: "lines", id: "box", positions: floats(box(answer.signs)), paint: "--good", width: 2.4, isMark: true });
  }
  return { layers };
}

/** Switches a corner; the shape is no longer the corner of a box. */
const switched = (signs: number, corner: number) => ({ signs: signs ^ (1 << corner), sharp: false });

export function CubeFigure({ page, answer }: { page: Page; answer: CubeAnswer }) {
  const { state, texts, set, isStill } = page;
  return (
    <Scene
      name={texts.cube.figure}
      help="hint"
      picture={pictureOf(page, answer)}
      view={state.view}
      home={HOME}
      look={(view) => set({ view })}
      isStill={isStill}
      tap={(at, x, y) => {
        const far = (corner: number) => Math.hypot(at.to(positionOf(corner))[0] - x, at.to(positionOf(corner))[1] - y);
        const nearest = CORNERS.reduce((best: number, corner) => (far(corner) < far(best) ? corner : best), 0);
        if (far(nearest) <= REACH) set(({ signs }) => switched(signs, nearest));
      }}
      over={(at) =>
        CORNERS.map((corner) => {
          const [x, y] = at.to(positionOf(corner));
          const is = isInside(state.signs, corner);
          return (
            <g key={corner} class={is ? "corner inside" : "corner"}>
              <circle cx={x} cy={y} r={12} fill={painted(is ? "--chain" : "--raised")} stroke={painted("--chain")} />
              <text x={x} y={y + 5}>
                {corner + 1}
              </text>
            </g>
          );
        })
      }
    />
  );
}

export function cubeNumber({ state, say, texts }: Page, answer: CubeAnswer): LiveNumber {
  const { faces, triangles, readings, lost } = answer;
  const { cube } = texts;
  const meaning =
    state.sharp && lost !== null
      ? cube.tip(say.fixed(lost))
      : faces.length
        ? cube.two(say.whole(readings))
        : triangles
          ? cube.one(say.whole(triangles))
          : cube.none;
  return {
    value: faces.length,
    shown: say.whole(faces.length),
    label: cube.label,
    meaning,
    tone: faces.length ? "bad" : state.sharp ? "plain" : "good",
  };
}

export function CubePanel({ page, answer }: { page: Page; answer: CubeAnswer }) {
  const { state, texts, say, set } = page;
  const { cube } = texts;
  const rows = [
    ["triangles", cube.triangles, answer.triangles, say.whole(answer.triangles)],
    ["pieces", cube.pieces, answer.pieces, say.whole(answer.pieces)],
    ["readings", cube.readings, answer.readings, say.whole(answer.readings)],
    ["patterns", cube.patterns, answer.patterns_with_two, cube.of(say.whole(answer.patterns_with_two), say.whole(answer.patterns))],
    ...(state.sharp && answer.lost !== null ? ([["lost", cube.lost, answer.lost, say.fixed(answer.lost)]] as const) : []),
  ] as const;
  return (
    <>
      <div role="group" aria-label={cube.corners} class="switches">
        <p class="aside">{cube.corners}</p>
        <div class="buttons">
          {CORNERS.map((corner) => (
            <button
              key={corner}
              type="button"
              aria-label={cube.corner(corner + 1)}
              aria-pressed={isInside(state.signs, corner)}
              onClick={() => set(({ signs }) => switched(signs, corner))}
            >
              {corner + 1}
            </button>
          ))}
        </div>
      </div>
      <div role="group" aria-label={cube.preset} class="switches">
        <p class="aside">{cube.preset}</p>
        <div class="buttons">
          {(Object.keys(PRESETS) as Preset[]).map((preset) => {
            const sharp = preset === "sharp";
            return (
              <button
                key={preset}
                type="button"
                aria-pressed={state.signs === PRESETS[preset] && state.sharp === sharp}
                onClick={() => set({ signs: PRESETS[preset], sharp })}
              >
                {cube.presets[preset]}
              </button>
            );
          })}
        </div>
      </div>
      <dl>
        {rows.map(([name, label, value, shown]) => (
          <Row key={name} name={name} label={label} value={value}>
            {shown}
          </Row>
        ))}
      </dl>
    </>
  );
}
