// The state in the address: written states are read back, and any other text does no harm.
import { expect, test } from "vitest";
import { VERSION, read, write } from "../../src/state/fragment";
import { DEFAULTS, type State } from "../../src/state/state";

const OTHER: State = {
  view: "seam",
  control: [
    [0, 0],
    [10, 6],
    [0.01, 5.99],
    [3.33, 2.22],
  ],
  segments: 128,
  before: 64,
  spacing: "fewest",
  look: "chain",
  goal: 0.25,
  t: 0.123,
  density: 3,
  seam: [
    [0, 0],
    [1, 1],
    [2, 2],
    [3, 3],
    [3, 3],
    [-4.5, -17.25],
    [6, 6],
    [7, 1],
  ],
  smoothness: "C2",
  comb: 3.1,
  language: "zh",
  theme: "dark",
};

/** Random numbers from a seed, which is printed if a test fails. */
function random(seed: number): () => number {
  return () => (seed = (seed * 48271) % 2147483647) / 2147483647;
}

test("the defaults are an empty fragment", () => {
  expect(write(DEFAULTS)).toBe("");
  expect(read("")).toEqual({ state: DEFAULTS, isDamaged: false });
  expect(read("#")).toEqual({ state: DEFAULTS, isDamaged: false });
});

test("written states are read back exactly", () => {
  expect(read(write(OTHER))).toEqual({ state: OTHER, isDamaged: false });
  expect(read(`#${write(OTHER)}`).state).toEqual(OTHER);
  expect(write(OTHER).length).toBeLessThan(200);
  for (const key of Object.keys(OTHER) as (keyof State)[]) {
    const one = { ...DEFAULTS, [key]: OTHER[key] };
    expect(read(write(one)), key).toEqual({ state: one, isDamaged: false });
  }
});

test("random states are read back exactly", () => {
  const seed = 1 + Math.floor(Math.random() * 1e9);
  const next = random(seed);
  const point = () => [Math.round(next() * 1000) / 100, Math.round(next() * 600) / 100] as const;
  for (let i = 0; i < 500; i++) {
    const state: State = {
      ...OTHER,
      control: [point(), point(), point(), point()],
      seam: [point(), point(), point(), point(), point(), point(), point(), point()],
      segments: 1 + Math.floor(next() * 128),
      t: Math.round(next() * 1000) / 1000,
    };
    expect(read(write(state)), `seed ${seed}`).toEqual({ state, isDamaged: false });
  }
});

test("escaped commas are understood", () => {
  const escaped = write(OTHER).replaceAll(",", "%2C");
  expect(read(escaped)).toEqual({ state: OTHER, isDamaged: false });
});

test("an invalid part is ignored, and the others are kept", () => {
  for (const bad of [
    "n=0", "n=129", "n=1e3", "n=-5", "n=NaN", "n=", "n=5.5", "n=99999999999999999999",
    "c=1,2,3", "c=1,2,3,4,5,6,7,x", "c=1,2,3,4,5,6,7,601", "c=NaN,0,0,0,0,0,0,0", "c=,,,,,,,", "c=1e999,0,0,0,0,0,0,0",
    "j=1", "k=C9", "k=__proto__", "s=constructor", "w=toString", "t=1001", "d=4", "g=0", "l=de", "h=%", "m=-1", "c=%E0%A4%A",
  ]) {
    const { state, isDamaged } = read(`v=1&t=250&${bad}`.replace("t=250&t=", "t="));
    expect(isDamaged, bad).toBe(true);
    expect(state, bad).toEqual(bad.startsWith("t=") ? DEFAULTS : { ...DEFAULTS, t: 0.25 });
  }
});

test("any text is read without an exception", () => {
  const seed = 1 + Math.floor(Math.random() * 1e9);
  const next = random(seed);
  const good = `v=${VERSION}&${write(OTHER)}`;
  for (let i = 0; i < 5000; i++) {
    const letters = [...good];
    for (let k = 0; k < 4; k++) letters[Math.floor(next() * letters.length)] = String.fromCharCode(Math.floor(next() * 0x300));
    const { state } = read(letters.slice(0, Math.floor(next() * letters.length)).join(""));
    expect(state.segments >= 1 && state.segments <= 128, `seed ${seed}`).toBe(true);
    expect(state.control.flat().every((x) => x >= 0 && x <= 10), `seed ${seed}`).toBe(true);
  }
});

test("another version and a very long address give the defaults, and are reported", () => {
  for (const text of ["v=2&n=5", "n=5", "rubbish", "v=1&c=" + "1,".repeat(100000), "=", "&&&", "v=1=1"]) {
    expect(read(text), text.slice(0, 20)).toEqual({ state: DEFAULTS, isDamaged: true });
  }
});
