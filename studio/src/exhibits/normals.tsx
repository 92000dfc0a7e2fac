// Where normals are stored: at faces, at shared vertices, or at vertices that are split at hard edges.
import { Choice, Row, Slider } from "../view/parts";
import { type Picture, type View, middles } from "../viewer";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { flag, number, view, word } from "./fragment";
import { FRAME } from "./frame_texts";
import { PAINT } from "./paint";
import { Scene } from "./Scene";
import type { Language } from "./say";

type Body = "cube" | "cylinder" | "ball" | "teapot";

interface State {
  shape: Body;
  crease: number;
  on: "vertices" | "faces";
  arrows: boolean;
  view: View;
}

interface Answer {
  mesh: { positions: Float32Array; indices: Uint32Array };
  normals: Float32Array;
  face_normals: Float32Array;
  vertices: number;
  positions: number;
  triangles: number;
  bytes: number;
}

const HOME: View = { azimuth: -58, elevation: 26, distance: 8.8, target: [0, 0, 0] };
const defaults: State = { shape: "cube", crease: 60, on: "vertices", arrows: true, view: HOME };
/** The distance is chosen so that all bodies have the same size in the picture. */
const homeOf = (shape: Body): View => ({ ...HOME, distance: { cube: 8.8, cylinder: 7.2, ball: 5.2, teapot: 5 }[shape] });
const BODIES: readonly Body[] = ["cube", "cylinder", "ball", "teapot"];

interface Texts extends CommonTexts {
  figure: string;
  handle: string;
  help: string;
  shape: string;
  shapes: Record<Body, string>;
  on: string;
  vertices: string;
  faces: string;
  arrows: string;
  label: string;
  places: string;
  bytes: string;
  triangles: string;
  none: string;
  all: string;
  some(n: string): string;
  facesOnly: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: FRAME.en.turn,
    figure: "A body with its normals as strokes",
    handle: "An edge is hard above",
    help: "If the normals of two faces differ by more, their vertices are split and each side keeps its own normal.",
    shape: "Body",
    shapes: { cube: "cube", cylinder: "cylinder", ball: "ball", teapot: "teapot" },
    on: "Light it by normals of",
    vertices: "vertices",
    faces: "faces",
    arrows: "Show the normals",
    label: "Vertices to store",
    places: "Corners in space",
    bytes: "Position and normal, 24 bytes each",
    triangles: "Triangles",
    none: "Every corner is stored once: no edge is hard, and the shading is smooth across all of them.",
    all: "Each face has its own corners: flat shading, facet by facet.",
    some: (n) => `${n} more than the number of corners: along hard edges a corner is stored once for each side.`,
    facesOnly: "Lit by faces, each triangle has one tone: right for a cut gem, wrong for a ball.",
    story: [
      "The direction of (v₁ − v₀) × (v₂ − v₀), one for the whole triangle, gives *flat shading*. Averaged around each vertex and blended across each triangle, the normals give *smooth shading*, and the same coarse mesh looks round; only its outline still shows the triangles. An average across a hard edge is wrong on both sides, so there the corner is stored once for each side: a cube has *24 vertices* and not 8.",
      "One number decides which edges are hard: the angle between the normals on both sides. For the cube it is 90° everywhere; for a cylinder of 24 sides it is 15° around and 90° at the rims, so that one angle between the two suits both.",
    ],
    attempts: [
      "Move the angle to 90° on the cube: 24 falls to 8, and the light goes wrong.",
      "Choose the cylinder and find the angles where it is round and its rims are sharp.",
    ],
  },
  zh: {
    hint: FRAME.zh.turn,
    figure: "一个物体，法线画成短线",
    handle: "硬边的最小夹角",
    help: "两个面的法线夹角大于它时，公共边上的顶点被拆开，两侧各有自己的法线。",
    shape: "物体",
    shapes: { cube: "立方体", cylinder: "圆柱", ball: "球", teapot: "茶壶" },
    on: "按哪种法线着色",
    vertices: "顶点法线",
    faces: "面法线",
    arrows: "显示法线",
    label: "需要存储的顶点数",
    places: "空间中的顶点",
    bytes: "位置与法线，每个 24 字节",
    triangles: "三角形",
    none: "每个顶点只存一次：没有硬边，明暗在所有边上连续过渡。",
    all: "每个面都有自己的顶点：逐面的平直着色。",
    some: (n) => `比空间中的顶点多 ${n} 个：硬边上的顶点要为每一侧各存一次。`,
    facesOnly: "按面法线着色，每个三角形只有一种明暗：适合刻面宝石，不适合球。",
    story: [
      "(v₁ − v₀) × (v₂ − v₀) 的方向，整个三角形共用一个，就是*平直着色*。把每个顶点周围的法线取平均，再在三角形内插值，就是*平滑着色*：同样粗的网格看起来就圆了，只有轮廓还露出三角形。跨过硬边的平均值对哪一侧都不对，所以那里的顶点每侧各存一份：立方体有 *24 个顶点*，而不是 8 个。",
      "哪些边是硬边，由一个数决定：两侧面法线的夹角。立方体处处是 90°；24 边的圆柱侧面相邻 15°，端面边缘 90°，取两者之间的角度，就都合适。",
    ],
    attempts: [
      "对立方体把角度移到 90°：24 降到 8，明暗也错了。",
      "选圆柱，找出侧面圆滑而边缘锐利的角度范围。",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;

function pictureOf({ state, answer, isStill }: Page): Picture {
  const { positions, indices } = answer.mesh;
  const byFaces = state.on === "faces";
  const length = { cube: 0.42, cylinder: 0.42, ball: 0.18, teapot: 0.12 }[state.shape];
  return {
    layers: [
      {
        kind: "mesh",
        id: "body",
        positions,
        indices,
        normals: answer.normals,
        paint: PAINT.front,
        shading: byFaces ? "flat" : "smooth",
        sides: isStill ? "front" : "both",
      },
      { kind: "wire", id: "wire", positions, indices, paint: "#24446b", width: 0.7 },
      ...(state.arrows
        ? ([
            {
              kind: "normals",
              id: "normals",
              at: byFaces ? middles(positions, indices) : positions,
              directions: byFaces ? answer.face_normals : answer.normals,
              length,
              paint: "--gap",
              width: 2.2,
            },
            { kind: "points", id: "feet", positions: byFaces ? middles(positions, indices) : positions, paint: "--gap", size: 5 },
          ] as const)
        : []),
    ],
  };
}

function Figure({ page }: { page: Page }) {
  const { state, texts, set, isStill } = page;
  return (
    <Scene
      name={texts.figure}
      help="hint"
      picture={pictureOf(page)}
      view={state.view}
      home={homeOf(state.shape)}
      look={(view) => set({ view })}
      isStill={isStill}
    />
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  const more = answer.vertices - answer.positions;
  const meaning =
    state.on === "faces"
      ? texts.facesOnly
      : more === 0
        ? texts.none
        : answer.vertices === 3 * answer.triangles
          ? texts.all
          : texts.some(say.whole(more));
  return { value: answer.vertices, shown: say.whole(answer.vertices), label: texts.label, meaning, tone: "plain" };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  return (
    <>
      <div>
        <Slider
          id="crease"
          label={texts.handle}
          shown={say.degrees(state.crease)}
          low={0}
          high={180}
          value={state.crease}
          choose={(crease) => set({ crease })}
        />
        <p class="aside">{texts.help}</p>
      </div>
      <Choice
        name="shape"
        legend={texts.shape}
        value={state.shape}
        options={BODIES.map((value) => ({ value, label: texts.shapes[value] }))}
        choose={(shape) => set(({ view }) => ({ shape, view: { ...view, distance: homeOf(shape).distance } }))}
      />
      <Choice
        name="on"
        legend={texts.on}
        value={state.on}
        options={[
          { value: "vertices", label: texts.vertices },
          { value: "faces", label: texts.faces },
        ]}
        choose={(on) => set({ on })}
      />
      <label class="check">
        <input type="checkbox" checked={state.arrows} onChange={(event) => set({ arrows: event.currentTarget.checked })} />{" "}
        {texts.arrows}
      </label>
      <dl>
        <Row name="positions" label={texts.places} value={answer.positions}>
          {say.whole(answer.positions)}
        </Row>
        <Row name="bytes" label={texts.bytes} value={answer.bytes}>
          {say.bytes(answer.bytes)}
        </Row>
        <Row name="triangles" label={texts.triangles} value={answer.triangles}>
          {say.whole(answer.triangles)}
        </Row>
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    shape: ["b", word(...BODIES)],
    crease: ["a", number(0, 180)],
    on: ["l", word("vertices", "faces")],
    arrows: ["n", flag],
    view: ["o", view],
  },
  question: ({ shape, crease }) => ({ shape, crease_deg: crease }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
