// A texture on a triangle: the tangent and bitangent follow the texture coordinates, and a mirrored texture has the other hand.
import { Figure as Data, Row } from "../view/parts";
import { type Picture, type Vec3, type View } from "../viewer";
import { plus } from "../viewer/view";
import { CornerLabels } from "./CornerLabels";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { points, view } from "./fragment";
import { FRAME } from "./frame_texts";
import { Grip, px } from "./Grip";
import { Knob } from "./Knob";
import { Scene } from "./Scene";
import type { Language } from "./say";

type Uv = readonly [number, number];

interface State {
  corners: readonly Vec3[];
  uv: readonly Uv[];
  view: View;
}

interface Answer {
  mesh: { positions: Float32Array; indices: Uint32Array };
  of: Uint32Array;
  texture: number[][];
  is_mapped: boolean;
  tangent: Vec3;
  bitangent: Vec3 | null;
  normal: Vec3 | null;
  sign: number;
  /** Of the derivatives by u and v. */
  lengths: [number | null, number | null];
  uv_area: number;
  middle: Vec3;
}

const HOME: View = { azimuth: -64, elevation: 34, distance: 6.8, target: [0, 0.05, 0.3] };
const WITHIN = 2;
/** The part of the plane of the texture that is shown; the texture itself is the unit square. */
const SHOWN = [-0.25, 1.25] as const;
const PICTURE = 360;
/** Light cells, dark cells, and the F. */
const PAINTS = ["#f1eee6", "#9fb3cf", "#c62a12"] as const;
const defaults: State = {
  corners: [
    [-1.5, -1, 0],
    [1.5, -1, 0],
    [-0.9, 1.3, 0.5],
  ],
  uv: [
    [0, 0],
    [1, 0.05],
    [0.1, 1],
  ],
  view: HOME,
};

interface Texts extends CommonTexts {
  figure: string;
  texture: string;
  corner(name: string): string;
  coordinate(name: string): string;
  at(x: string, y: string, z: string): string;
  uv(u: string, v: string): string;
  label: string;
  right: string;
  mirrored: string;
  flat: string;
  none: string;
  mirror: string;
  turn: string;
  reset: string;
  tangent: string;
  bitangent: string;
  normal: string;
  lengths: string;
  area: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: `Drag the corners in the texture or in space. ${FRAME.en.turn}{keys} Tab to a corner, then the arrow keys.`,
    figure: "A textured triangle in space with its tangent, bitangent and normal",
    texture: "The texture, and the triangle in it",
    corner: (name) => `Corner ${name} in space`,
    coordinate: (name) => `Corner ${name} in the texture`,
    at: (x, y, z) => `x ${x}, y ${y}, z ${z}`,
    uv: (u, v) => `u ${u}, v ${v}`,
    label: "Handedness of tangent space",
    right: "u, v and the normal are right-handed: the F can be read.",
    mirrored: "The texture is mirrored: the F is reversed, and the bitangent needs the sign −1, or every dent of a normal map becomes a bump.",
    flat: "The three coordinates are on one line: the texture has no two directions here, so there is no tangent.",
    none: "none",
    mirror: "Mirror u",
    turn: "Turn by a quarter",
    reset: "As at first",
    tangent: "Tangent T",
    bitangent: "Bitangent B",
    normal: "Normal N",
    lengths: "Length of a step of u, of v",
    area: "Signed area in the texture",
    story: [
      "Each corner stores its place in the texture, *u and v*, and they are blended across like any attribute. So the position is a linear function of u and v, and its derivatives are arrows on the triangle: along u the *tangent*, along v the *bitangent*. With the normal they are the axes of *tangent space*.",
      "A *normal map* stores directions in those axes, so a brick wall can be baked once and wrapped around any surface. Baker and renderer must agree on the axes to the last detail, which is what *MikkTSpace* is for: it keeps the tangent, makes it perpendicular to the normal, and stores only a sign for the bitangent: B = sign · (N × T).",
      "Artists mirror a texture to paint half of a face only. There the sign is −1. On the seam, two corners at one place have different tangents, so the vertex is stored twice.",
    ],
    attempts: [
      "Drag one corner of the texture across the opposite side. When does the sign change?",
      "Make the triangle in the texture small. What happens to the cells on the surface, and to T?",
    ],
  },
  zh: {
    hint: `在纹理中或空间中拖动顶点。${FRAME.zh.turn}{keys}按 Tab 选中顶点，再按方向键移动。`,
    figure: "空间中带纹理的三角形，以及切线、副切线和法线",
    texture: "纹理，以及三角形在其中的位置",
    corner: (name) => `空间中的顶点 ${name}`,
    coordinate: (name) => `纹理中的顶点 ${name}`,
    at: (x, y, z) => `x ${x}，y ${y}，z ${z}`,
    uv: (u, v) => `u ${u}，v ${v}`,
    label: "切线空间的手性",
    right: "u、v 与法线构成右手系：F 字是正的。",
    mirrored: "纹理被镜像：F 字反了，副切线要带上符号 −1，否则法线贴图里凹的会变成凸的。",
    flat: "三个纹理坐标共线：这里的纹理不足两个方向，所以没有切线。",
    none: "无",
    mirror: "镜像 u",
    turn: "转四分之一圈",
    reset: "恢复原样",
    tangent: "切线 T",
    bitangent: "副切线 B",
    normal: "法线 N",
    lengths: "u、v 各走一步，在曲面上走多远",
    area: "纹理中的有向面积",
    story: [
      "每个顶点记着自己在纹理中的位置 *u 和 v*，在三角形内部与其他属性一样插值。于是位置是 u、v 的线性函数，它的导数就是三角形上的两支箭头：沿 u 的是*切线*，沿 v 的是*副切线*。再加上法线，便是*切线空间*的三条轴。",
      "*法线贴图*里的方向是按这三条轴记录的，一面砖墙只要烘焙一次，就能贴到任何表面。烘焙与渲染必须用完全相同的轴，*MikkTSpace* 为此而定：保留切线，使它垂直于法线，副切线只存一个符号：B = 符号 ·（N × T）。",
      "画师常把纹理镜像，一张脸只画半边；镜像的一半符号为 −1。接缝处同一位置的两个顶点切线不同，所以顶点要存两份。",
    ],
    attempts: [
      "在纹理中把一个顶点拖过对边：符号什么时候改变？",
      "把纹理中的三角形缩小：表面上的方格和 T 怎样变化？",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;
const floats = (...points: readonly Vec3[]) => new Float32Array(points.flat());
const NAMES = ["A", "B", "C"] as const;
/** The axes are drawn at this length, a little above the surface. */
const AXIS = 0.9;

function axesOf({ answer }: Page): { id: string; name: string; paint: string; from: Vec3; to: Vec3 }[] {
  const { normal, tangent, bitangent, middle, is_mapped } = answer;
  if (!normal) return [];
  const from = plus(middle, normal, 0.02);
  const axis = (id: string, name: string, paint: string, along: Vec3) => ({ id, name, paint, from, to: plus(from, along, AXIS) });
  return [
    ...(is_mapped && bitangent ? [axis("t", "T", "--chain", tangent), axis("b", "B", "--good", bitangent)] : []),
    axis("n", "N", "--ink", normal),
  ];
}

function pictureOf(page: Page): Picture {
  const { state, answer } = page;
  const [a, b, c] = state.corners as [Vec3, Vec3, Vec3];
  return {
    layers: [
      {
        kind: "mesh",
        id: "cells",
        ...answer.mesh,
        groups: { of: answer.of, paints: PAINTS },
        paint: PAINTS[0],
        shading: "none",
        sides: "both",
      },
      { kind: "lines", id: "outline", positions: floats(a, b, b, c, c, a), paint: "--ink", width: 2 },
      ...axesOf(page).map(({ id, paint, from, to }) => ({ kind: "lines" as const, id, positions: floats(from, to), paint, width: 4, isOnTop: true })),
    ],
  };
}

function Figure({ page }: { page: Page }) {
  const { state, texts, say, set, isStill, isSmall } = page;
  const middle = page.answer.middle;
  const scene = (
    <Scene
      name={texts.figure}
      help="hint"
      picture={pictureOf(page)}
      view={state.view}
      home={HOME}
      look={(view) => set({ view })}
      isStill={isStill}
      over={(at) => (
        <>
          <CornerLabels at={at} corners={state.corners} middle={middle} names={NAMES} />
          {axesOf(page).map(({ id, name, to }) => {
            const [x, y] = at.to(to);
            return (
              <text key={id} class={`label axis-${id}`} x={x + 12} y={y - 4}>
                {name}
              </text>
            );
          })}
          {state.corners.map((place, i) => (
            <Knob
              key={i}
              name={texts.corner(NAMES[i]!)}
              spoken={texts.at(say.fixed(place[0]), say.fixed(place[1]), say.fixed(place[2]))}
              place={place}
              at={at}
              isStill={isStill}
              within={WITHIN}
              isFaint
              move={(change) => set(({ corners }) => ({ corners: corners.map((old, k) => (k === i ? change(old) : old)) }))}
            />
          ))}
        </>
      )}
    />
  );
  return isSmall ? (
    scene
  ) : (
    <div class="side-by-side">
      {scene}
      <TexturePlane page={page} />
    </div>
  );
}

const SCALE = PICTURE / (SHOWN[1] - SHOWN[0]);
const placeOf = ([u, v]: Uv): [number, number] => [(u - SHOWN[0]) * SCALE, (SHOWN[1] - v) * SCALE];
const keptUv = ([u, v]: Uv): Uv => {
  const kept = (x: number) => Math.round(Math.min(Math.max(x, SHOWN[0] + 0.03), SHOWN[1] - 0.03) * 100) / 100;
  return [kept(u), kept(v)];
};

/** The texture with the triangle in it. */
function TexturePlane({ page }: { page: Page }) {
  const { state, answer, texts, say, set, isStill } = page;
  const cell = SCALE / answer.texture.length;
  const [left, top] = placeOf([0, 1]);
  const corners = state.uv.map(placeOf);
  const cells = (group: number) =>
    answer.texture
      .flatMap((line, row) => line.flatMap((of, column) => (of === group ? [`M${px(left + column * cell)} ${px(top + row * cell)}h${cell}v${cell}h-${cell}z`] : [])))
      .join("");
  const middle = corners.reduce<[number, number]>(([x, y], p) => [x + p[0] / 3, y + p[1] / 3], [0, 0]);
  return (
    <svg class="plane-of-texture" data-figure viewBox={`0 0 ${PICTURE} ${PICTURE}`} role="group" aria-label={texts.texture}>
      {PAINTS.map((paint, group) => (
        <path key={group} d={cells(group)} fill={paint} />
      ))}
      <path class="outline-of-texture" d={`M${px(left)} ${px(top)}h${px(SCALE)}v${px(SCALE)}h-${px(SCALE)}z`} />
      <text class="axis-name" x={px(left + SCALE)} y={px(top + SCALE + 20)}>
        u
      </text>
      <text class="axis-name" x={px(left - 12)} y={px(top + 6)}>
        v
      </text>
      <path class={answer.sign < 0 ? "in-texture mirrored" : "in-texture"} d={`M${corners.map((p) => p.map(px).join(" ")).join("L")}z`} />
      {corners.map(([x, y], i) => {
        const far = Math.hypot(x - middle[0], y - middle[1]) || 1;
        return (
          <text key={i} class="label" x={px(x + (22 * (x - middle[0])) / far)} y={px(y + (22 * (y - middle[1])) / far + 6)}>
            {NAMES[i]}
          </text>
        );
      })}
      {state.uv.map((place, i) => (
        <Grip
          key={i}
          name={texts.coordinate(NAMES[i]!)}
          spoken={texts.uv(say.fixed(place[0]), say.fixed(place[1]))}
          now={place[0]}
          low={SHOWN[0]}
          high={SHOWN[1]}
          at={corners[i]!}
          isStill={isStill}
          reach={22}
          grab={() => (dx, dy) => moveUv(set, i, () => [place[0] + dx / SCALE, place[1] - dy / SCALE])}
          step={(right, up) => Number.isFinite(right) && moveUv(set, i, ([u, v]) => [u + 0.02 * right, v + 0.02 * up])}
        />
      ))}
    </svg>
  );
}

const moveUv = (set: Page["set"], i: number, change: (uv: Uv) => Uv) =>
  set(({ uv }) => ({ uv: uv.map((old, k) => (k === i ? keptUv(change(old)) : old)) }));

function liveNumber({ answer, texts }: Page): LiveNumber {
  const { is_mapped, sign } = answer;
  return {
    value: is_mapped ? sign : 0,
    shown: !is_mapped ? texts.none : sign > 0 ? "+1" : "−1",
    label: texts.label,
    meaning: !is_mapped ? texts.flat : sign > 0 ? texts.right : texts.mirrored,
    tone: !is_mapped ? "bad" : sign > 0 ? "good" : "plain",
  };
}

function Panel({ page }: { page: Page }) {
  const { answer, texts, say, set } = page;
  const vector = (name: string, value: Vec3 | null) =>
    value
      ? value.map((x, k) => (
          <Data key={k} name={`${name}-${k}`} value={x}>
            {say.fixed(x)}
            {k < 2 ? ", " : ""}
          </Data>
        ))
      : "–";
  return (
    <>
      <div class="buttons">
        <button type="button" onClick={() => set(({ uv }) => ({ uv: uv.map(([u, v]) => keptUv([1 - u, v])) }))}>
          {texts.mirror}
        </button>
        <button type="button" onClick={() => set(({ uv }) => ({ uv: uv.map(([u, v]) => keptUv([1 - v, u])) }))}>
          {texts.turn}
        </button>
        <button type="button" onClick={() => set({ uv: defaults.uv, corners: defaults.corners })}>
          {texts.reset}
        </button>
      </div>
      <dl class="vectors">
        <div class="axis-t">
          <dt>{texts.tangent}</dt>
          <dd>{vector("tangent", answer.is_mapped ? answer.tangent : null)}</dd>
        </div>
        <div class="axis-b">
          <dt>{texts.bitangent}</dt>
          <dd>{vector("bitangent", answer.is_mapped ? answer.bitangent : null)}</dd>
        </div>
        <div>
          <dt>{texts.normal}</dt>
          <dd>{vector("normal", answer.normal)}</dd>
        </div>
        <div>
          <dt>{texts.lengths}</dt>
          <dd>
            {answer.lengths.map((length, k) => (
              <Data key={k} name={`length-${k}`} value={length}>
                {length === null ? "–" : say.fixed(length)}
                {k ? "" : ", "}
              </Data>
            ))}
          </dd>
        </div>
        <Row name="uv-area" label={texts.area} value={answer.uv_area}>
          {say.fixed(answer.uv_area)}
        </Row>
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    corners: ["p", points<Vec3>(3, 3, [[-WITHIN, WITHIN], [-WITHIN, WITHIN], [-WITHIN, WITHIN]])],
    uv: ["c", points<Uv>(3, 3, [SHOWN, SHOWN])],
    view: ["o", view],
  },
  question: ({ corners, uv }) => ({ corners, uv }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
