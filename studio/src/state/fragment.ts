// The state in the address: `#v=1&n=12&c=60,80,…`, only the values that differ from the defaults. An address may come from
// anywhere: an invalid part is ignored, and the reader is warned once.
import type { Cubic, Point, Smoothness, Spacing } from "../core/types";
import { DEFAULTS, GOALS, GRID, MOST_SEGMENTS, WORLD } from "./state";
import type { Density, Eight, Goal, Language, Look, State, Theme, View } from "./state";

export const VERSION = "1";
/** The second curve's points follow from the first one's and may leave the drawing, at most by this much. */
const FARTHEST = 100;
/** Chosen: ten times the length of an address that the page writes. */
const LONGEST = 2000;

export interface Read {
  state: State;
  /** Whether a part was invalid. */
  isDamaged: boolean;
}

interface Part<V> {
  write(value: V): string;
  /** `undefined` if the text is not such a value. */
  read(text: string): V | undefined;
}

const PARTS: { [K in keyof State]: [key: string, part: Part<State[K]>] } = {
  view: ["w", oneOf<View>({ c: "curve", s: "seam" })],
  control: ["c", points<Cubic>(4, [0, WORLD.width], [0, WORLD.height])],
  segments: ["n", wholeNumber(1, MOST_SEGMENTS)],
  before: ["b", wholeNumber(1, MOST_SEGMENTS)],
  spacing: ["s", oneOf<Spacing>({ e: "even", f: "fewest" })],
  look: ["e", oneOf<Look>({ b: "both", s: "chain", c: "curve" })],
  goal: ["g", oneOf<Goal>({ "1": GOALS[0], "2": GOALS[1], "4": GOALS[2] })],
  t: ["t", share(1000)],
  density: ["d", oneOf<Density>({ "0": 0, "1": 1, "2": 2, "3": 3 })],
  seam: ["j", points<Eight>(8, [-FARTHEST, FARTHEST], [-FARTHEST, FARTHEST])],
  smoothness: ["k", oneOf<Smoothness>({ n: "none", "0": "C0", "1": "C1", "2": "C2" })],
  comb: ["m", share(100, 6)],
  language: ["l", oneOf<Language | null>({ en: "en", zh: "zh" })],
  theme: ["h", oneOf<Theme | null>({ a: "auto", l: "light", d: "dark" })],
};

/** The fragment of a state, without `#`; empty for the defaults. */
export function write(state: State): string {
  const pairs = (Object.keys(PARTS) as (keyof State)[]).flatMap((name) => pairOf(name, state));
  return pairs.length ? `v=${VERSION}&${pairs.join("&")}` : "";
}

function pairOf<K extends keyof State>(name: K, state: State): string[] {
  const [key, part] = PARTS[name];
  if (state[name] === null) return [];
  const text = part.write(state[name]);
  // Compared as text: values that differ by less than the grid are the same address.
  return DEFAULTS[name] !== null && text === part.write(DEFAULTS[name]) ? [] : [`${key}=${text}`];
}

/** The state of a fragment, with or without `#`. Never throws. */
export function read(fragment: string): Read {
  const text = fragment.replace(/^#/, "");
  if (text === "") return { state: DEFAULTS, isDamaged: false };
  const values = new Map(text.slice(0, LONGEST).split("&").map(pair));
  // A fragment of another version may use the same keys for other values.
  if (text.length > LONGEST || values.get("v") !== VERSION) return { state: DEFAULTS, isDamaged: true };
  let isDamaged = false;
  const state = { ...DEFAULTS };
  const readPart = <K extends keyof State>(name: K) => {
    const [key, part] = PARTS[name];
    const written = values.get(key);
    if (written === undefined) return;
    const value = part.read(written);
    if (value === undefined) isDamaged = true;
    else state[name] = value;
  };
  for (const name of Object.keys(PARTS) as (keyof State)[]) readPart(name);
  return { state, isDamaged };
}

function pair(text: string): [string, string] {
  const at = text.indexOf("=");
  return at < 0 ? [text, ""] : [text.slice(0, at), decoded(text.slice(at + 1))];
}

/** Some programs escape commas when they pass an address on. */
function decoded(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

function oneOf<V>(names: Record<string, V>): Part<V> {
  return {
    write: (value) => Object.keys(names).find((name) => names[name] === value) ?? "",
    // Every object inherits names such as `constructor`, which an address may hold.
    read: (text) => (Object.hasOwn(names, text) ? names[text] : undefined),
  };
}

/** An integer in plain digits; `undefined` for any other text. */
function integer(text: string, low: number, high: number): number | undefined {
  if (!/^-?\d{1,6}$/.test(text)) return undefined;
  const value = Number(text);
  return value >= low && value <= high ? value : undefined;
}

function wholeNumber(low: number, high: number): Part<number> {
  return { write: String, read: (text) => integer(text, low, high) };
}

/** A number from 0 to `most` in steps of 1 / `steps`. */
function share(steps: number, most = 1): Part<number> {
  return {
    write: (value) => String(Math.round(value * steps)),
    read: (text) => {
      const count = integer(text, 0, most * steps);
      return count === undefined ? undefined : count / steps;
    },
  };
}

function points<P extends readonly Point[]>(count: number, xs: [number, number], ys: [number, number]): Part<P> {
  return {
    write: (value) => value.flatMap((point) => point.map((x) => Math.round(x * GRID))).join(","),
    read: (text) => {
      const words = text.split(",");
      if (words.length !== 2 * count) return undefined;
      const numbers = words.map((word, i) => {
        const [low, high] = i % 2 ? ys : xs;
        return integer(word, low * GRID, high * GRID);
      });
      if (numbers.some((number) => number === undefined)) return undefined;
      const result = Array.from({ length: count }, (_, i): Point => [numbers[2 * i]! / GRID, numbers[2 * i + 1]! / GRID]);
      return result as unknown as P;
    },
  };
}
