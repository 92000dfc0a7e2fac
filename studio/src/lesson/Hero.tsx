// The first picture: a teapot that moves away. On the left as one sees it, at its true size; on the right the triangles that this
// takes, held up close. They fall away, and the picture on the left is never off by more than half a pixel.
import { px } from "../exhibits/Grip";
import { Awake, Scene } from "../exhibits/Scene";
import { type Language, Say } from "../exhibits/say";
import { Figure as Data } from "../view/parts";
import { type Picture, projector, type Size, type View } from "../viewer";
import type { Words } from "./lesson";
import { type TeapotLevel, WIDTH } from "./teapot_levels";

/** The camera of the figure, which is not the one that moves away. */
export const HOME: View = { azimuth: -90, elevation: 17, distance: 1.24, target: [0.005, 0, 0.052] };
/** The error that is allowed, in pixels. */
const ALLOWED = 0.5;
/** The distances of the handle: from where the teapot is as large as the one beside it, to where it is some pixels wide. */
export const DISTANCES = Array.from({ length: 37 }, (_, i) => Number((1.3 * 10 ** (i / 22)).toPrecision(2)));
/** Where the play comes to rest: small, and still a teapot. */
export const REST = 27;
/** The first one that a picture shows before any script runs. */
export const STILL_STEP = 15;
/** The places of both, and the share of the picture's width that the larger one takes. */
const APART = 0.25;
const SHARE = 0.43;

export interface HeroState {
  step: number;
  /** How far both are turned, in degrees. */
  spin: number;
  /** Whether the left one is drawn with all triangles, for comparison. */
  isFull: boolean;
  elevation: number;
}

export const START: HeroState = { step: 0, spin: 24, isFull: false, elevation: HOME.elevation };

interface HeroProps {
  levels: readonly TeapotLevel[];
  state: HeroState;
  language: Language;
  words: Words;
  size: Size;
  isStill: boolean;
  isAwake: boolean;
  set(change: Partial<HeroState>): void;
  play(): void;
}

/** The coarsest level whose error is at most half a pixel from there. */
export const levelAt = (levels: readonly TeapotLevel[], distance: number) =>
  levels.findLast(({ from }) => from / ALLOWED <= distance) ?? levels[0]!;

/** The teapot turned, scaled, and moved aside. */
function placed({ positions }: TeapotLevel, spin: number, scale: number, aside: number): Float32Array {
  const turn = (spin * Math.PI) / 180;
  const [sin, cos] = [Math.sin(turn) * scale, Math.cos(turn) * scale];
  const moved = new Float32Array(positions.length);
  for (let i = 0; i < positions.length; i += 3) {
    const [x, y, z] = [positions[i]!, positions[i + 1]!, positions[i + 2]!];
    moved[i] = cos * x - sin * y + aside;
    moved[i + 1] = sin * x + cos * y;
    // About the middle of its height.
    moved[i + 2] = scale * (z - HOME.target[2]) + HOME.target[2];
  }
  return moved;
}

/** Pixels of a metre at a metre, in the middle of a screen of 1920 by 1080 with a field of view of 45 degrees. */
const LENS = 1080 / 2 / Math.tan(Math.PI / 8);

/** The teapot's width on that screen, in pixels. */
export const widthAt = (distance: number) => (WIDTH * LENS) / distance;

/** Where both stand, and their sizes in pixels. */
function standing({ levels, state, size }: HeroProps) {
  const distance = DISTANCES[state.step]!;
  const level = levelAt(levels, distance);
  const at = projector({ ...HOME, elevation: state.elevation }, size);
  const pixels = (at.to([WIDTH, 0, HOME.target[2]])[0] - at.to([0, 0, HOME.target[2]])[0]) / WIDTH;
  const most = SHARE * size.width;
  // Nearer than this it would not fit beside the other one.
  return { level, at, pixels, most, seen: Math.min(widthAt(distance), most), aside: (APART * size.width) / pixels };
}

function pictureOf(props: HeroProps): Picture {
  const { levels, state, isStill } = props;
  const { level, pixels, most, seen, aside } = standing(props);
  const far = state.isFull ? levels[0]! : level;
  const near = placed(level, state.spin, most / (pixels * WIDTH), aside);
  const sides = isStill ? "front" : "both";
  return {
    layers: [
      {
        kind: "mesh",
        id: `seen ${far.triangles}`,
        positions: placed(far, state.spin, seen / (pixels * WIDTH), -aside),
        indices: far.indices,
        paint: "#86acd9",
        shading: "smooth",
        sides,
      },
      { kind: "mesh", id: `near ${level.triangles}`, positions: near, indices: level.indices, paint: "#a9c4e6", shading: "flat", sides },
      { kind: "wire", id: `wire ${level.triangles}`, positions: near, indices: level.indices, paint: "#1c3d66", width: 1 },
    ],
  };
}

/** The lens between both: two circles, and their outer tangents. */
function Lens(props: HeroProps) {
  const { at, most, seen, aside } = standing(props);
  const [[x, y], [far]] = [at.to([-aside, 0, HOME.target[2]]), at.to([aside, 0, HOME.target[2]])];
  const [r, big] = [0.56 * seen + 3, 0.54 * most];
  const tilt = Math.asin(Math.min((big - r) / (far! - x!), 1));
  const [sin, cos] = [Math.sin(tilt), Math.cos(tilt)];
  const line = (side: 1 | -1) =>
    `M${px(x! - r * sin)} ${px(y! + side * r * cos)}L${px(far! - big * sin)} ${px(y! + side * big * cos)}`;
  return (
    <g class="lens">
      <circle cx={px(x!)} cy={px(y!)} r={px(r)} />
      <circle cx={px(far!)} cy={px(y!)} r={px(big)} />
      {r < big - 2 && <path d={line(1) + line(-1)} />}
    </g>
  );
}

export function HeroBench(props: HeroProps) {
  const { levels, state, language, words, isStill, isAwake, set, play } = props;
  const say = new Say(language);
  const distance = DISTANCES[state.step]!;
  const level = levelAt(levels, distance);
  const metres = `${say.number(distance)} m`;
  return (
    <Awake.Provider value={isAwake}>
      <div class="stage" id="figure" tabindex={-1}>
        <Scene
          name={words.heroPicture}
          help="hero-hint"
          picture={pictureOf(props)}
          view={{ ...HOME, elevation: state.elevation }}
          home={HOME}
          // The camera stays: a drag turns both teapots, each about itself.
          look={({ azimuth, elevation }) =>
            set({ spin: state.spin - (azimuth - HOME.azimuth), elevation: Math.min(Math.max(elevation, 2), 60) })
          }
          isStill={isStill}
          over={() => <Lens {...props} />}
        />
        <p class="halves" id="hero-hint">
          <span>{words.seenFrom(metres, say.whole(Math.round(widthAt(distance))))}</span>
          <span>{words.upClose}</span>
        </p>
      </div>
      <div class="hero-panel" {...(isStill ? { inert: true } : {})}>
        <p class="live good">
          <b>
            <Data name="hero-triangles" value={level.triangles}>
              {say.whole(level.triangles)}
            </Data>
          </b>{" "}
          {words.enough(say.number(level.from / distance))}
        </p>
        <div class="hero-controls">
          <label for="hero-distance">{words.distance}</label>
          <input
            id="hero-distance"
            type="range"
            aria-valuetext={words.spokenAt(metres, say.whole(level.triangles))}
            min={0}
            max={DISTANCES.length - 1}
            step={1}
            value={state.step}
            onInput={(event) => set({ step: Number(event.currentTarget.value) })}
          />
          {!isStill && (
            <>
              <button type="button" aria-pressed={state.isFull} onClick={() => set({ isFull: !state.isFull })}>
                ⇄ {words.all(say.whole(levels[0]!.triangles))}
              </button>
              <button type="button" class="again" onClick={play}>
                {words.again}
              </button>
            </>
          )}
        </div>
      </div>
    </Awake.Provider>
  );
}
