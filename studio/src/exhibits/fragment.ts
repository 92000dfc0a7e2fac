// An exhibit's state in the address: `#v=1&h=0.4&view=…`, only what differs from the start. An address comes from anywhere:
// whatever is wrong with a part of it, that part is as if it were not there, and the reader is told once.
import type { View } from "../viewer";

const VERSION = "1";
/** An address that we wrote is a tenth as long. */
const LONGEST = 2000;

export interface Part<V> {
  write(value: V): string;
  /** Nothing, when the text is no such value. */
  read(text: string): V | undefined;
}
/** How each value of a state is spelled; a value that is not listed is not in the address. */
export type Parts<S> = { [K in keyof S]?: readonly [key: string, part: Part<S[K]>] };

export function write<S extends object>(state: S, defaults: S, parts: Parts<S>): string {
  const pairs = (Object.keys(parts) as (keyof S)[]).flatMap((name) => {
    const [key, part] = parts[name]!;
    const text = part.write(state[name]);
    return text === part.write(defaults[name]) ? [] : [`${key}=${text}`];
  });
  return pairs.length ? `v=${VERSION}&${pairs.join("&")}` : "";
}

/** The state of a fragment, with or without `#`. It never throws. */
export function read<S extends object>(fragment: string, defaults: S, parts: Parts<S>): { state: S; isDamaged: boolean } {
  const text = fragment.replace(/^#/, "");
  if (text === "") return { state: defaults, isDamaged: false };
  const given = new Map(text.slice(0, LONGEST).split("&").map(pair));
  // A fragment of another version is not guessed at.
  if (text.length > LONGEST || given.get("v") !== VERSION) return { state: defaults, isDamaged: true };
  let isDamaged = false;
  const state = { ...defaults };
  const take = <K extends keyof S>(name: K) => {
    const [key, part] = parts[name]!;
    const said = given.get(key);
    if (said === undefined) return;
    const value = part.read(said);
    if (value === undefined) isDamaged = true;
    else state[name] = value;
  };
  for (const name of Object.keys(parts) as (keyof S)[]) take(name);
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

/** One of a few words. */
export function word<V extends string>(...words: readonly V[]): Part<V> {
  return { write: (value) => value, read: (text) => words.find((word) => word === text) };
}

/** Several of a few words, in an order. */
export function words<V extends string>(all: readonly V[], most: number): Part<readonly V[]> {
  return {
    write: (values) => values.join(","),
    read: (text) => {
      const said = text === "" ? [] : text.split(",");
      const found = said.map((one) => all.find((word) => word === one));
      return said.length > most || found.includes(undefined) ? undefined : (found as V[]);
    },
  };
}

export const flag: Part<boolean> = { write: (value) => (value ? "1" : "0"), read: (text) => ({ "0": false, "1": true })[text] };

/** A number in plain decimals, on a grid of one over `steps`. */
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
export function numbers(least: number, most: number, one: Part<number>): Part<readonly number[]> {
  return {
    write: (values) => values.map((value) => one.write(value)).join(","),
    read: (text) => {
      const found = text === "" ? [] : text.split(",").map((word) => one.read(word));
      return found.length < least || found.length > most || found.includes(undefined) ? undefined : (found as number[]);
    },
  };
}

/** A point of the plane, in hundredths. */
export function point(xs: readonly [number, number], ys: readonly [number, number]): Part<readonly [number, number]> {
  const both = [number(...xs, 100), number(...ys, 100)] as const;
  return {
    write: (value) => value.map((x, k) => both[k]!.write(x)).join(","),
    read: (text) => {
      const said = text.split(",");
      const [x, y] = both.map((one, k) => one.read(said[k] ?? ""));
      return said.length !== 2 || x === undefined || y === undefined ? undefined : [x, y];
    },
  };
}

/** From where one looks. */
export const view: Part<View> = {
  write: ({ azimuth, elevation, distance, target }) =>
    [azimuth, elevation, distance, ...target].map((x) => tidy.write(x)).join(","),
  read: (text) => {
    const found = six.read(text);
    if (!found) return undefined;
    const [azimuth, elevation, distance, x, y, z] = found as [number, number, number, number, number, number];
    return Math.abs(elevation) > 89 || distance <= 0 ? undefined : { azimuth, elevation, distance, target: [x, y, z] };
  },
};
const tidy = number(-1000, 1000, 100);
const six = numbers(6, 6, tidy);
