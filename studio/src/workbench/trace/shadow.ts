// Which call of a script made a face. The script is run once more with every call of a primitive in a colour of its own: the
// core carries materials through all operations, so the colours of that mesh name the calls.
import { type Token, tokens } from "../editor/tokens";

/** A call in a script: the function, and its place in the text. */
export interface CallSite {
  name: string;
  /** Counted from 1. */
  line: number;
  from: number;
  to: number;
}

/** Before the text: what gives a call its colour, and what takes the place of the colours that the script gives. */
const HEAD = `def chordal_plain(shape, name=0, color=0, metallic=0, roughness=0):
    return shape
def chordal_site(number, shape):
    return color(shape, [(number // 65536) / 255.0, (number // 256 % 256) / 255.0, (number % 256) / 255.0])
`;
/** The functions that make shapes of numbers or files; all others change or combine shapes, and keep their materials. */
export const PRIMITIVES: ReadonlySet<string> = new Set(
  (
    "sphere box rounded_box cylinder cone capsule torus ellipsoid prism octahedron tetrahedron plane triangle hull sweep thread gyroid " +
    "schwarz_p diamond circle rectangle rounded_rectangle segment polygon regular_polygon planar_hull field mesh svg text heightmap"
  ).split(" "),
);
const PAINTS = new Set(["color", "material"]);

/** The script with a colour for each call of a primitive, and the calls by their colours' numbers, from 1. */
export function shadowOf(text: string): { text: string; sites: readonly CallSite[] } {
  const all = tokens(text).filter(({ kind }) => kind !== "comment");
  const word = (token: Token | undefined) => (token ? text.slice(token.from, token.to) : "");
  const isDefined = new Set(all.filter((_, k) => word(all[k - 1]) === "def").map(word));
  const sites: CallSite[] = [];
  const edits: { at: number; until: number; text: string }[] = [];
  all.forEach((token, k) => {
    const name = word(token);
    const [before, after] = [word(all[k - 1]), all[k + 1]];
    if (token.kind !== "name" || before === "." || before === "def" || word(after) !== "(" || isDefined.has(name)) return;
    if (PAINTS.has(name)) {
      edits.push({ at: token.from, until: token.to, text: "chordal_plain" });
    } else if (PRIMITIVES.has(name)) {
      const close = all.slice(k + 2).find((other) => word(other) === ")" && other.depth === after!.depth);
      if (!close) return;
      sites.push({ name, line: text.slice(0, token.from).split("\n").length, from: token.from, to: close.to });
      edits.push({ at: token.from, until: token.from, text: `chordal_site(${sites.length}, ` }, { at: close.to, until: close.to, text: ")" });
    }
  });
  let [shadow, last] = ["", 0];
  for (const { at, until, text: instead } of edits.sort((a, b) => a.at - b.at)) {
    shadow += text.slice(last, at) + instead;
    last = until;
  }
  return { text: HEAD + shadow + text.slice(last), sites };
}

/** The number of a site from the paint of its triangles; 0 if it has none. */
export function siteOfPaint(paint: string | undefined): number {
  const [, r, g, b] = /^rgb\((\d+), (\d+), (\d+)\)$/.exec(paint ?? "") ?? [];
  return b === undefined ? 0 : Number(r) * 65536 + Number(g) * 256 + Number(b);
}
