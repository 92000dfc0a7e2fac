// A block minus a drill, by the textbook method for meshes and as a field: where a mesh cracks, a field cannot.
import { Choice, Row, Slider } from "../view/parts";
import type { Layer, Picture, Vec3, View } from "../viewer";
import { type CommonTexts, exhibit, type LiveNumber, type Page as PageOf } from "./exhibit";
import { flag, number, point, view, word } from "./fragment";
import { FRAME } from "./frame_texts";
import { Knob } from "./Knob";
import { PAINT } from "./paint";
import { Scene } from "./Scene";
import type { Language } from "./say";

type Way = "textbook" | "field";

interface State {
  way: Way;
  place: readonly [number, number];
  /** An index into the heights of the drill's tip. */
  tip: number;
  /** An index into its tilts. */
  tilt: number;
  drill: boolean;
  view: View;
}

interface Answer {
  mesh: { positions: Float32Array; indices: Uint32Array };
  edges: Float32Array;
  drill: { positions: Float32Array; indices: Uint32Array };
  /** The ends of edges that do not have two triangles, one in each direction. */
  open: Float32Array;
  open_edges: number;
  closed: boolean;
  triangles: number;
  textbook: number;
  /** `null` until it is shown. */
  field: number | null;
  volume: number;
  close: number;
}

/** Heights of the drill's tip over the block's lower face. */
const TIPS = [0.6, 0.3, 0.1, 0.001, 0.0001, 0.00002, 0.00001, 0, -0.00001, -0.00002, -0.0001, -0.001, -0.1, -0.3];
/** Tilts of the drill, in radians: as slopes, one in 33,000 to one in ten. */
const TILTS = [0, 0.00003, 0.00005, 0.0001, 0.001, 0.01, 0.1];
const HOME: View = { azimuth: -58, elevation: 28, distance: 6.4, target: [0, 0, 0.05] };
const defaults: State = { way: "textbook", place: [0.3, 0.1], tip: 6, tilt: 2, drill: false, view: HOME };

interface Texts extends CommonTexts {
  figure: string;
  handle: string;
  at(x: string, y: string): string;
  way: string;
  ways: Record<Way, string>;
  rule: Record<Way, string>;
  tip: string;
  above(height: string): string;
  below(depth: string): string;
  level: string;
  tilt: string;
  slope(n: string): string;
  upright: string;
  drill: string;
  label: string;
  closed(triangles: string): string;
  open(n: string): string;
  textbook: string;
  field: string;
  volume: string;
}

const texts: Record<Language, Texts> = {
  en: {
    hint: `Drag the drill over the block. ${FRAME.en.turn}`,
    figure: "A block from which a drill of 24 sides is subtracted; open edges are red",
    handle: "Drill",
    at: (x, y) => `x ${x}, y ${y}`,
    way: "Block minus drill",
    ways: { textbook: "textbook mesh", field: "field" },
    rule: { textbook: "planes cut polygons", field: "max(a, −b)" },
    tip: "Tip of the drill",
    above: (height) => `${height} above the lower face`,
    below: (depth) => `${depth} below the lower face`,
    level: "level with the lower face",
    tilt: "Tilt of the drill",
    slope: (n) => `1 in ${n}`,
    upright: "upright",
    drill: "show the drill",
    label: "Open edges",
    closed: (triangles) => `Closed: ${triangles} triangles have an inside.`,
    open: (n) => `${n} edges do not have two triangles, one on each side: it leaks, and has no inside.`,
    textbook: "Open edges, textbook",
    field: "Open edges, field",
    volume: "Volume",
    story: [
      "For a field, block minus drill is *max(a, −b)*, a number for each point; there is nothing to fit together. For meshes, every face of one has to be cut along the faces of the other, and the pieces have to meet again. The *textbook* way cuts polygons by planes in floating point, and asks whether a corner is *on* a plane, which it calls everything within 0.00001. In general places that works.",
      "Near special places it does not. If the drill ends *almost* level with the lower face and leans a little, one corner counts as on the plane and its neighbour as beside it; pieces are kept twice or not at all, and the mesh *cracks*. No tolerance helps: a smaller one moves the places where it goes wrong, and a larger one makes them larger.",
      "The core meshes the field: it asks for signs, not for pieces that fit, so its mesh is closed wherever the drill is. For solids that are meshes and nothing else, the command has a boolean that decides every sign exactly. The textbook method here was written for this page, as it is in many small programs (binary space partition; Naylor, Amanatides and Thibault, 1990): corners closer than the tolerance are merged, and corners on a side of a neighbour are put into it.",
    ],
    attempts: [
      "Move the tip step by step past the lower face: which heights crack the textbook’s mesh?",
      "Tilt the drill more or less: where do the cracks go? Then take the field.",
    ],
  },
  zh: {
    hint: `在方块上拖动钻头。${FRAME.zh.turn}`,
    figure: "从方块里减去二十四棱的钻头；没有配对的边为红色",
    handle: "钻头",
    at: (x, y) => `x ${x}，y ${y}`,
    way: "方块减钻头",
    ways: { textbook: "教科书的网格", field: "场" },
    rule: { textbook: "平面切多边形", field: "max(a, −b)" },
    tip: "钻头的尖端",
    above: (height) => `高出底面 ${height}`,
    below: (depth) => `低于底面 ${depth}`,
    level: "与底面齐平",
    tilt: "钻头的倾斜",
    slope: (n) => `1 比 ${n}`,
    upright: "竖直",
    drill: "显示钻头",
    label: "没有配对的边",
    closed: (triangles) => `封闭：${triangles} 个三角形围出了内部。`,
    open: (n) => `${n} 条边没有恰好两个方向相反的三角形：它漏了，分不出内外。`,
    textbook: "教科书：没有配对的边",
    field: "场：没有配对的边",
    volume: "体积",
    story: [
      "对场来说，方块减钻头就是 *max(a, −b)*，每一点一个数，没有什么要拼合。对网格来说，一方的每个面都要沿另一方的面切开，切出的碎片还得重新对上。*教科书*的做法是在浮点数里用平面切多边形，并且要问一个顶点是不是*在*平面上：相差 0.00001 以内都算。位置一般时，这样行得通。",
      "碰到特殊位置就不行了。钻头稍微歪一点，又*差一点点*与底面齐平时，一个顶点算在平面上，旁边的顶点却算在平面外；有的碎片留了两次，有的一次也没留，网格就*裂开*了。换容差也没有用：小一些，出错的地方只是挪个位置；大一些，出错的范围更大。",
      "核心直接把场变成网格：它只问符号，不必拼合碎片，所以钻头在哪里，网格都是封闭的。如果只有网格，命令行也有布尔运算，对每个符号都精确判定。这里的教科书做法是为本页写的，许多小程序都这样写（二叉空间划分；Naylor、Amanatides、Thibault，1990）：相距小于容差的顶点合而为一，落在邻边上的顶点插进那条边。",
    ],
    attempts: ["让尖端一步步越过底面：哪些高度会让教科书的网格裂开？", "让钻头多歪或少歪一点：裂缝到哪里去了？再换成场。"],
  },
};

type Page = PageOf<State, Answer, Texts>;

function pictureOf({ state, answer, isStill }: Page): Picture {
  const layers: Layer[] = [
    { kind: "mesh", id: "solid", ...answer.mesh, paint: PAINT.front, back: PAINT.back, shading: "flat", sides: isStill ? "front" : "both" },
  ];
  if (!isStill) layers.push({ kind: "lines", id: "wire", positions: answer.edges, paint: "#24446b", width: 0.8 });
  if (state.drill) layers.push({ kind: "mesh", id: "drill", ...answer.drill, paint: PAINT.mark, shading: "flat", sides: "front", opacity: 0.35 });
  if (answer.open.length) layers.push({ kind: "lines", id: "open", positions: answer.open, paint: "--gap", width: 4, isOnTop: true });
  return { layers };
}

/** The top of the block, where the handle is. */
const TOP = 0.5;

function Figure({ page }: { page: Page }) {
  const { state, texts, say, set, isStill } = page;
  const [x, y] = state.place;
  return (
    <Scene
      name={texts.figure}
      help="hint"
      picture={pictureOf(page)}
      view={state.view}
      home={HOME}
      look={(view) => set({ view })}
      isStill={isStill}
      over={(at) => (
        <Knob
          name={texts.handle}
          spoken={`${texts.at(say.fixed(x), say.fixed(y))}${say.marks.stop}${liveNumber(page).meaning}`}
          place={[x, y, TOP]}
          at={at}
          isStill={isStill}
          within={2}
          move={(change) => set(({ place }) => ({ place: onTop(at.eye, change([...place, TOP])) }))}
        />
      )}
    />
  );
}

/** Where the ray from the eye through a point meets the top of the block. */
function onTop(eye: Vec3, to: Vec3): State["place"] {
  const share = (eye[2] - TOP) / (eye[2] - to[2]);
  const within = (value: number, most: number) => Math.round(Math.min(Math.max(value, -most), most) * 100) / 100;
  // If the eye is level with the top, or below it, the point itself.
  const [x, y] = share > 0 && share < 4 ? [0, 1].map((k) => eye[k]! + share * (to[k]! - eye[k]!)) : to;
  return [within(x!, 1.8), within(y!, 1.5)];
}

function liveNumber({ answer, say, texts }: Page): LiveNumber {
  return {
    value: answer.open_edges,
    shown: say.whole(answer.open_edges),
    label: texts.label,
    meaning: answer.open_edges ? texts.open(say.whole(answer.open_edges)) : texts.closed(say.whole(answer.triangles)),
    tone: answer.open_edges ? "bad" : "good",
  };
}

function Panel({ page }: { page: Page }) {
  const { state, answer, texts, say, set } = page;
  const height = TIPS[state.tip]!;
  const plain = (value: number) => value.toFixed(value < 0.001 ? 6 : 3).replace(/0+$/, "");
  const shown = height > 0 ? texts.above(plain(height)) : height < 0 ? texts.below(plain(-height)) : texts.level;
  const tilt = state.tilt ? texts.slope(say.whole(1 / TILTS[state.tilt]!)) : texts.upright;
  return (
    <>
      <Choice
        name="way"
        legend={texts.way}
        value={state.way}
        options={(["textbook", "field"] as const).map((value) => ({
          value,
          label: texts.ways[value],
          extra: <small> {texts.rule[value]}</small>,
        }))}
        choose={(way) => set({ way })}
      />
      <Slider
        id="tip"
        label={texts.tip}
        shown={shown}
        low={0}
        high={TIPS.length - 1}
        value={state.tip}
        choose={(tip) => set({ tip })}
      />
      <Slider
        id="tilt"
        label={texts.tilt}
        shown={tilt}
        low={0}
        high={TILTS.length - 1}
        value={state.tilt}
        choose={(tilt) => set({ tilt })}
      />
      <p class="check">
        <label>
          <input type="checkbox" name="drill" checked={state.drill} onChange={() => set(({ drill }) => ({ drill: !drill }))} /> {texts.drill}
        </label>
      </p>
      <dl>
        {(["textbook", "field"] as const).map((name) => (
          <Row key={name} name={name} label={texts[name]} value={answer[name]}>
            {answer[name] === null ? "—" : say.whole(answer[name])}
          </Row>
        ))}
        <Row name="volume" label={texts.volume} value={answer.volume}>
          {say.fixed(answer.volume, 3)}
        </Row>
      </dl>
    </>
  );
}

export default exhibit<State, Answer, Texts>({
  defaults,
  parts: {
    way: ["s", word("textbook", "field")],
    place: ["p", point([-1.8, 1.8], [-1.5, 1.5])],
    tip: ["n", number(0, TIPS.length - 1)],
    tilt: ["t", number(0, TILTS.length - 1)],
    drill: ["b", flag],
    view: ["o", view],
  },
  question: ({ way, place, tip, tilt }) => ({ way, place, tip: -0.5 + TIPS[tip]!, tilt: TILTS[tilt] }),
  texts,
  number: liveNumber,
  Figure,
  Panel,
});
