// An exhibit's state in the address: `#v=1&h=0.4&view=…`, only the values that differ from the defaults. An address may come
// from anywhere: an invalid part is ignored, and the reader is warned once.
import type { View } from "../viewer";

const VERSION = "1";
/** Chosen: ten times the length of an address that the page writes. */
const LONGEST = 2000;

export interface Part<V> {
  write(value: V): string;
  /** `undefined` if the text is not such a value. */
  read(text: string): V | undefined;
}
/** How each value of a state is written. Values that are not listed are not in the address. */
export type Parts<S> = { [K in keyof S]?: readonly [key: string, part: Part<S[K]>] };

export function write<S extends object>(state: S, defaults: S, parts: Parts<S>): string {
  const pairs = (Object.keys(parts) as (keyof S)[]).flatMap((name) => {
    const [key, part] = parts[name]!;
    const text = part.write(state[name]);
    return text === part.write(defaults[name]) ? [] : [`${key}=${text}`];
  });
  return pairs.length ? `v=${VERSION}&${pairs.join("&")}` : "";
}

/** The state of a fragment, with or without `#`. Never throws. */
export function read<S extends object>(fragment: string, defaults: S, parts: Parts<S>): { state: S; isDamaged: boolean } {
  const text = fragment.replace(/^#/, "");
  if (text === "") return { state: defaults, isDamaged: false };
  const values = new Map(text.slice(0, LONGEST).split("&").map(pair));
  // A fragment of another version may use the same keys for other values.
  if (text.length > LONGEST || values.get("v") !== VERSION) return { state: defaults, isDamaged: true };
  let isDamaged = false;
  const state = { ...defaults };
  const readPart = <K extends keyof S>(name: K) => {
    const [key, part] = parts[name]!;
    const written = values.get(key);
    if (written === undefined) return;
    const value = part.read(written);
    if (value === undefined) isDamaged = true;
    else state[name] = value;
  };
  for (const name of Object.keys(parts) as (keyof S)[]) readPart(name);
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

/** One of several words. */
export function word<V extends string>(...words: readonly V[]): Part<V> {
  return { write: (value) => value, read: (text) => words.find((word) => word === text) };
}

/** A list of at most `most` of these words. */
export function words<V extends string>(choices: readonly V[], most: number): Part<readonly V[]> {
  return {
    write: (values) => values.join(","),
    read: (text) => {
      const parts = text === "" ? [] : text.split(",");
      const chosen = parts.map((part) => choices.find((word) => word === part));
      return parts.length > most || chosen.includes(undefined) ? undefined : (chosen as V[]);
    },
  };
}

export const flag: Part<boolean> = { write: (value) => (value ? "1" : "0"), read: (text) => ({ "0": false, "1": true })[text] };

/** A decimal number on a grid of 1 / `steps`. */
export function number(low: number, high: number, steps = 1): Part<number> {
  return {
    write: (value) => String(Math.round(value * steps) / steps),
    read: (text) => {
      if (!/^-?\d{1,6}(\.\d{1,6})?$/.test(text)) return undefined;
      const value = Number(text);
      return value >= low && value <= high ? Math.round(value * steps) / steps : undefined;
    },
  };
}

/** From `least` to `most` numbers. */
export function numbers(least: number, most: number, item: Part<number>): Part<readonly number[]> {
  return {
    write: (values) => values.map((value) => item.write(value)).join(","),
    read: (text) => {
      const values = text === "" ? [] : text.split(",").map((word) => item.read(word));
      return values.length < least || values.length > most || values.includes(undefined) ? undefined : (values as number[]);
    },
  };
}

/** A point of the plane, in hundredths. */
export function point(xs: readonly [number, number], ys: readonly [number, number]): Part<readonly [number, number]> {
  const axes = [number(...xs, 100), number(...ys, 100)] as const;
  return {
    write: (value) => value.map((x, k) => axes[k]!.write(x)).join(","),
    read: (text) => {
      const parts = text.split(",");
      const [x, y] = axes.map((axis, k) => axis.read(parts[k] ?? ""));
      return parts.length !== 2 || x === undefined || y === undefined ? undefined : [x, y];
    },
  };
}

/** Points of D coordinates within these ranges, in hundredths; from `least` to `most` of them. */
export function points<P extends readonly number[]>(
  least: number,
  most: number,
  ranges: readonly (readonly [number, number])[],
): Part<readonly P[]> {
  const axes = ranges.map((range) => number(...range, 100));
  const width = axes.length;
  return {
    write: (places) => places.map((place) => place.map((x, k) => axes[k]!.write(x)).join(",")).join(","),
    read: (text) => {
      const values = text.split(",").map((word, i) => axes[i % width]!.read(word));
      const count = values.length / width;
      if (values.includes(undefined) || !Number.isInteger(count) || count < least || count > most) return undefined;
      return Array.from({ length: count }, (_, i) => values.slice(i * width, (i + 1) * width)) as unknown as P[];
    },
  };
}

/** A view, as six numbers. */
export const view: Part<View> = {
  write: ({ azimuth, elevation, distance, target }) =>
    [azimuth, elevation, distance, ...target].map((x) => component.write(x)).join(","),
  read: (text) => {
    const values = sixComponents.read(text);
    if (!values) return undefined;
    const [azimuth, elevation, distance, x, y, z] = values as [number, number, number, number, number, number];
    return Math.abs(elevation) > 89 || distance <= 0 ? undefined : { azimuth, elevation, distance, target: [x, y, z] };
  },
};
const component = number(-1000, 1000, 100);
const sixComponents = numbers(6, 6, component);
