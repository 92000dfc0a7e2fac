// One mesh, stored with an index and without.
import { Choice, Figure as Data, Row, Slider } from "../view/parts";
import { type MeshLayer, type Picture, type Projector, type Vec3, type View, exploded, pick, row } from "../viewer";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { number, numbers, type Part, view, word } from "./fragment";
import { FRAME } from "./frame_texts";
import { PAINT } from "./paint";
import { Scene } from "./Scene";
import type { Language } from "./say";

interface State {
  /** The largest distance allowed from the teapot, as a stop of the slider. */
  stop: number;
  storage: "indexed" | "unindexed";
  /** The vertex nearest to this point is marked, however fine the mesh is. */
  near: Vec3;
  view: View;
}

interface Answer {
  mesh: { positions: Float32Array; indices: Uint32Array };
  normals: Float32Array;
  triangles: number;
  vertices: number;
  bytes: number;
  position_bytes: number;
  unindexed_bytes: number;
  times: number;
  triangles_per_vertex: number;
  vertex: { row: number; at: Vec3; faces: number[] };
}

/** The stops of the slider: from 0.5 units down to 0.005, each four fifths of the previous one. */
const STOPS = Array.from({ length: 22 }, (_, i) => Number((0.5 * 0.8 ** i).toPrecision(3)));
const HOME: View = { azimuth: -68, elevation: 22, distance: 10.6, target: [0.35, 0, 1.5] };
/** On the belly, which faces the initial view. */
const NEAR: Vec3 = [0.35, -1.9, 1.3];
const defaults: State = { stop: 4, storage: "indexed", near: NEAR, view: HOME };
/** Within the teapot's box, in thousandths: vertices of the finest mesh are farther apart. */
const place = numbers(3, 3, number(-4, 4, 1000)) as unknown as Part<Vec3>;

interface Texts extends CommonTexts {
  figure: string;
  handle: string;
  finer(n: string): string;
  storage: string;
  indexed: string;
  unindexed: string;
  label: Record<State["storage"], string>;
  meaning: Record<State["storage"], (times: string, n: string) => string>;
  positions: string;
  indices: string;
  triangles: string;
  vertices: string;
  perVertex: string;
  here: string;
  shared(n: string): string;
  another: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: `Press a vertex to mark it. ${FRAME.en.turn}`,
    figure: "A teapot of triangles; those that share one marked vertex are yellow",
    handle: "Triangles",
    finer: (n) => `${n} triangles`,
    storage: "Stored",
    indexed: "with an index",
    unindexed: "corner by corner",
    label: { indexed: "Bytes with an index", unindexed: "Bytes without an index" },
    meaning: {
      indexed: (times, n) =>
        `Without an index it would be ${times} times as much. A vertex is used by ${n} triangles on average.`,
      unindexed: (times, n) =>
        `${times} times as much as with an index: every corner is written again for each of the ${n} triangles around it.`,
    },
    positions: "positions, 12 bytes each",
    indices: "indices, 6 bytes a triangle",
    triangles: "Triangles",
    vertices: "Vertices",
    perVertex: "Triangles at a vertex, mean",
    here: "At the marked vertex",
    shared: (n) => `${n} triangles`,
    another: "Mark the next one",
    story: [
      "Every triangle of a closed surface has three edges, and every edge two triangles; by Euler’s formula *about six triangles share a vertex*. Written corner by corner, a triangle takes 36 bytes. With a list of vertices and three small indices it takes 12: six for the indices, six for its half of a vertex.",
      "The attributes of a position (normal, colour, texture coordinate) are stored once, too, and moved once if the shape moves. And a vertex that was just computed need not be computed again for the next triangle that uses it.",
      "An index also says which triangles are connected. Corner by corner, two triangles touch only because their numbers happen to agree; that is how an STL file is written, and why it has to be welded before neighbours can be found.",
    ],
    attempts: [
      "Store it corner by corner: the triangles come apart, because nothing connects them.",
      "Give it more triangles. The mean number at a vertex comes closer to six: the rims, where it is smaller, matter less.",
    ],
  },
  zh: {
    hint: `点一下顶点，把它标出来。${FRAME.zh.turn}`,
    figure: "由三角形构成的茶壶；共用同一个标出顶点的三角形为黄色",
    handle: "三角形数",
    finer: (n) => `${n} 个三角形`,
    storage: "存储方式",
    indexed: "带索引",
    unindexed: "各存各的",
    label: { indexed: "带索引时的字节数", unindexed: "不带索引时的字节数" },
    meaning: {
      indexed: (times, n) => `不带索引则要 ${times} 倍。平均每个顶点由 ${n} 个三角形共用。`,
      unindexed: (times, n) => `是带索引时的 ${times} 倍：每个顶点周围平均有 ${n} 个三角形，就要重写这么多次。`,
    },
    positions: "位置，每个 12 字节",
    indices: "索引，每个三角形 6 字节",
    triangles: "三角形",
    vertices: "顶点",
    perVertex: "每个顶点的三角形数（平均）",
    here: "标出的顶点处",
    shared: (n) => `${n} 个三角形`,
    another: "标出下一个",
    story: [
      "在封闭曲面上，每个三角形有三条边，每条边属于两个三角形；由欧拉公式，*一个顶点约由六个三角形共用*。各存各的，一个三角形要 36 字节；改为顶点表加三个小整数的索引，只要 12 字节：索引六字节，分摊到的半个顶点六字节。",
      "随位置存放的属性（法线、颜色、纹理坐标）同样只存一次；形状变化时也只移动一次。刚算过的顶点，下一个用到它的三角形不必再算。",
      "索引还说明谁与谁相连。各存各的时候，两个三角形只是坐标恰好相等才挨在一起；STL 文件就是这样写的，所以要先焊接顶点，才谈得上相邻关系。",
    ],
    attempts: [
      "改成各存各的：三角形散开了，因为没有任何东西把它们连在一起。",
      "增加三角形：每个顶点的平均数更接近六，因为不足六个的壶口边缘所占比例变小了。",
    ],
  },
};

type Page = PageOf<State, Answer, Texts>;

/** Caches the exploded triangles of the last mesh. */
let explodedCache: { positions: Float32Array; mesh: ReturnType<typeof exploded>; ground: Float32Array } | undefined;

/** A copy a little below the surface, to hide the far side behind the gaps. */
const below = ({ mesh, normals }: Answer) => mesh.positions.map((x, i) => x - 0.04 * normals[i]!);

function pictureOf({ state, answer, isStill }: Page): Picture {
  const isApart = state.storage === "unindexed";
  const original = answer.mesh.positions;
  if (isApart && explodedCache?.positions !== original) explodedCache = { positions: original, mesh: exploded(answer.mesh, 0.16), ground: below(answer) };
  const { positions, indices } = isApart ? explodedCache!.mesh : answer.mesh;
  const groups = new Uint32Array(indices.length / 3);
  for (const face of answer.vertex.faces) groups[face] = 1;
  const mesh: MeshLayer = {
    kind: "mesh",
    id: "teapot",
    positions,
    indices,
    groups: { of: groups, paints: [PAINT.front, PAINT.mark] },
    paint: PAINT.front,
    shading: "flat",
    // Nothing of the inside is seen, and a still has a shape for each triangle.
    sides: isStill ? "front" : "both",
  };
  // Only for triangles that are apart: each has nine numbers of its own then, in the order of the
  // faces.
  const corners = answer.vertex.faces.flatMap((face) =>
    [0, 1, 2]
      .filter((k) => answer.mesh.indices[3 * face + k] === answer.vertex.row)
      .flatMap((k) => [...positions.subarray(9 * face + 3 * k, 9 * face + 3 * k + 3)]),
  );
  const dots = new Float32Array(isApart ? corners : answer.vertex.at);
  const isFine = answer.triangles > 4000;
  return {
    layers: [
      ...(isApart
        ? ([
            {
              kind: "mesh",
              id: "ground",
              positions: explodedCache!.ground,
              indices: answer.mesh.indices,
              paint: "--raised",
              shading: "none",
              sides: "both",
            },
          ] as const)
        : []),
      mesh,
      ...(isApart
        ? []
        : ([{ kind: "wire", id: "wire", positions, indices, paint: "#24446b", width: isFine ? 0.6 : 1 }] as const)),
      { kind: "points", id: "dots", positions: dots, paint: "--gap", size: isApart ? 7 : 10, isMark: true },
    ],
  };
}

/** The vertex under a pixel, or rather the nearest corner of the triangle there. */
function vertexAt({ state, answer }: Page, at: Projector, x: number, y: number): Vec3 | undefined {
  const { positions, indices } = state.storage === "unindexed" && explodedCache ? explodedCache.mesh : answer.mesh;
  const face = pick(at, x, y, positions, indices);
  if (face === undefined) return undefined;
  const away = (k: number) => {
    const [right, down] = at.to(row(positions, indices[3 * face + k]!));
    return Math.hypot(right - x, down - y);
  };
  const corner = [0, 1, 2].reduce((best, k) => (away(k) < away(best) ? k : best));
  // Triangles that are apart are in the order of those that are not.
  return row(answer.mesh.positions, answer.mesh.indices[3 * face + corner]!);
}

function Figure({ page }: { page: Page }) {
  const { state, texts, set, isStill } = page;
  return (
    <Scene
      name={texts.figure}
      help="hint"
      picture={pictureOf(page)}
      view={state.view}
      home={HOME}
      look={(view) => set({ view })}
      isStill={isStill}
      tap={(at, x, y) => {
        const near = vertexAt(page, at, x, y);
        if (near) set({ near });
      }}
    />
  );
}

function liveNumber({ state, answer, say, texts }: Page): LiveNumber {
  const { storage } = state;
  const value = storage === "indexed" ? answer.bytes : answer.unindexed_bytes;
  return {
    value,
    shown: say.bytes(value),
    label: texts.label[storage],
    meaning: texts.meaning[storage](say.number(answer.times), say.number(answer.triangles_per_vertex)),
    tone: storage === "indexed" ? "good" : "bad",
  };
}

const WIDE = 300;

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const wide = (bytes: number) => (WIDE * bytes) / answer.unindexed_bytes;
  return (
    <>
      <Slider
        id="triangles"
        label={texts.handle}
        shown={
          <Data name="triangles" value={answer.triangles}>
            {say.whole(answer.triangles)}
          </Data>
        }
        spoken={texts.finer(say.whole(answer.triangles))}
        low={0}
        high={STOPS.length - 1}
        value={state.stop}
        choose={(stop) => set({ stop })}
      />
      <Choice
        name="storage"
        legend={texts.storage}
        value={state.storage}
        options={[
          { value: "indexed", label: texts.indexed },
          { value: "unindexed", label: texts.unindexed },
        ]}
        choose={(storage) => set({ storage })}
      />
      <div>
        <svg
          class="bytes"
          viewBox={`0 0 ${WIDE} 96`}
          role="img"
          aria-label={[
            [texts.label.indexed, answer.bytes] as const,
            [texts.label.unindexed, answer.unindexed_bytes] as const,
          ].map(([label, bytes]) => label + say.marks.colon + say.bytes(bytes)).join(say.marks.stop)}
        >
          <text x="0" y="13" class={state.storage === "indexed" ? "chosen" : ""}>
            {texts.indexed}
            {say.marks.colon}
            {say.bytes(answer.bytes)}
          </text>
          <rect class="positions" x="0" y="20" height="18" width={wide(answer.position_bytes)} />
          <rect
            class="indices"
            x={wide(answer.position_bytes)}
            y="20"
            height="18"
            width={wide(answer.bytes - answer.position_bytes)}
          />
          <text x="0" y="62" class={state.storage === "unindexed" ? "chosen" : ""}>
            {texts.unindexed}
            {say.marks.colon}
            {say.bytes(answer.unindexed_bytes)}
          </text>
          <rect class="positions" x="0" y="69" height="18" width={WIDE} />
        </svg>
        <p class="legend">
          <span class="positions">{texts.positions}</span>
          <span class="indices">{texts.indices}</span>
        </p>
      </div>
      <dl>
        <Row name="vertices" label={texts.vertices} value={answer.vertices}>
          {say.whole(answer.vertices)}
        </Row>
        <Row name="per-vertex" label={texts.perVertex} value={answer.triangles_per_vertex}>
          {say.fixed(answer.triangles_per_vertex)}
        </Row>
        <Row name="ring" label={texts.here} value={answer.vertex.faces.length}>
          {texts.shared(String(answer.vertex.faces.length))}
        </Row>
      </dl>
      <div class="buttons">
        <button
          type="button"
          onClick={() => set({ near: row(answer.mesh.positions, (answer.vertex.row + 1) % answer.vertices) })}
        >
          {texts.another}
        </button>
      </div>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    stop: ["n", number(0, STOPS.length - 1)],
    storage: ["s", word("indexed", "unindexed")],
    near: ["p", place],
    view: ["o", view],
  },
  question: ({ stop, near }) => ({ shape: "teapot", length: STOPS[stop], near }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
