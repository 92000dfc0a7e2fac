// The exhibits without a browser: their addresses, their texts, and the core's answers.
import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { beforeAll, describe, expect, test } from "vitest";
import { Core } from "../../src/core/module";
import type { AnyExhibit } from "../../src/exhibits/exhibit";
import { flag, number, numbers, point, points, read, view, word, words, write } from "../../src/exhibits/fragment";
import { FRAME } from "../../src/exhibits/frame_texts";
import { EXHIBITS } from "../../src/exhibits/index";
import { Say } from "../../src/exhibits/say";

const bytes = readFileSync(fileURLToPath(new URL("../../wasm/exhibits.wasm", import.meta.url)));
let core: Core;
const loaded = new Map<string, AnyExhibit>();
beforeAll(async () => {
  core = await Core.load(bytes);
  for (const entry of EXHIBITS) loaded.set(entry.id, (await entry.load()).default);
});

describe.each(EXHIBITS.map((entry) => [entry.id, entry] as const))("%s", (id, entry) => {
  const loadedExhibit = () => loaded.get(id)!;

  test("the initial state has an empty fragment, and every written state is read back", () => {
    const { defaults, parts } = loadedExhibit();
    expect(write(defaults, defaults, parts)).toBe("");
    for (const [name, [, part]] of Object.entries(parts) as [
      string,
      [string, { write(v: unknown): string; read(t: string): unknown }],
    ][]) {
      expect(part.read(part.write(defaults[name])), name).toEqual(defaults[name]);
    }
  });

  test("an invalid part of an address is ignored and reported", () => {
    const { defaults, parts } = loadedExhibit();
    for (const bad of ["x", "v=2", "v=1&p=a,b&o=NaN,0,1,0,0,0&n=1e9&c=%&h=99&f=3,x&a=-1&b=cow", `v=1&${"o".repeat(3000)}`]) {
      expect(read(bad, defaults, parts), bad).toEqual({ state: defaults, isDamaged: true });
    }
  });

  test("the core answers, with a number that both languages can show", () => {
    const { defaults, texts, question } = loadedExhibit();
    const answer = core.ask("exhibit", { exhibit: id, ...question(defaults) });
    for (const language of ["en", "zh"] as const) {
      const page = {
        state: defaults,
        answer,
        say: new Say(language),
        texts: texts[language],
        set: () => undefined,
        isStill: true,
        isSmall: false,
      };
      const { value, shown, label, meaning } = loadedExhibit().number(page);
      expect(Number.isFinite(value)).toBe(true);
      for (const text of [shown, label, meaning]) expect(text).not.toMatch(/undefined|NaN|\{/);
    }
  });

  test("all texts exist in both languages, each in its own", () => {
    const { texts } = loadedExhibit();
    const han = /\p{Script=Han}/u;
    const all = (language: "en" | "zh") => {
      const { story, attempts, hint } = texts[language];
      return [...story, ...attempts, hint, entry.title[language], entry.claim[language]] as string[];
    };
    expect(all("en").length).toBe(all("zh").length);
    for (const text of all("en")) expect(text).not.toMatch(han);
    for (const text of all("zh")) expect(text).toMatch(han);
    // Every emphasis is closed.
    for (const text of [...all("en"), ...all("zh")]) expect(text.split("*").length % 2, text).toBe(1);
  });
});

test("both languages have the same frame texts", () => {
  expect(Object.keys(FRAME.zh)).toEqual(Object.keys(FRAME.en));
});

test("every part reads the texts that it writes and refuses all others", () => {
  expect(number(0, 1, 100).read("0.505")).toBe(0.51);
  for (const bad of ["", "1e3", "Infinity", "--1", "2", " 1"]) expect(number(0, 1, 100).read(bad), bad).toBeUndefined();
  expect(word("a", "b").read("c")).toBeUndefined();
  expect(flag.read("2")).toBeUndefined();
  expect(words(["a", "b"], 3).read("a,b,a")).toEqual(["a", "b", "a"]);
  expect(words(["a", "b"], 2).read("a,b,a")).toBeUndefined();
  expect(words(["a"], 2).read("")).toEqual([]);
  expect(numbers(0, 3, number(0, 9)).read("")).toEqual([]);
  expect(numbers(0, 3, number(0, 9)).read("1,,2")).toBeUndefined();
  expect(point([0, 12], [0, 8]).read("3,9")).toBeUndefined();
  expect(point([0, 12], [0, 8]).read("3,7.5")).toEqual([3, 7.5]);
  const some = points(1, 2, [[0, 12], [0, 8]]);
  expect(some.read("3,7.5,1,1")).toEqual([[3, 7.5], [1, 1]]);
  expect(some.write([[3, 7.504]])).toBe("3,7.5");
  for (const bad of ["", "3", "3,9", "1,1,1", "1,1,1,1,1,1"]) expect(some.read(bad), bad).toBeUndefined();
  expect(view.read("1,95,3,0,0,0")).toBeUndefined();
  expect(view.read("1,45,0,0,0,0")).toBeUndefined();
  const looked = { azimuth: -12.5, elevation: 30, distance: 4.25, target: [0, 0, 1.5] as const };
  expect(view.read(view.write(looked))).toEqual(looked);
});

test("large arrays of an answer are typed arrays of their exact length", () => {
  const { mesh, face_normals } = core.ask("exhibit", { exhibit: "normals", shape: "cube", crease_deg: 30 }) as {
    mesh: { positions: Float32Array; indices: Uint32Array };
    face_normals: Float32Array;
  };
  expect(mesh.positions).toBeInstanceOf(Float32Array);
  expect([mesh.positions.length, mesh.indices.length, face_normals.length]).toEqual([72, 36, 36]);
  expect(Math.max(...mesh.indices)).toBe(23);
});

test("numbers are formatted as specified", () => {
  const say = new Say("en");
  expect(say.fixed(-0.001)).toBe("0.00");
  expect(say.fixed(-1.5)).toBe("−1.50");
  expect(say.number(-12345)).toBe("−12300");
  expect(say.bytes(9_999)).toBe("9,999 bytes");
  expect(say.bytes(12_340)).toBe("12.3 kB");
  expect(new Say("zh").bytes(900)).toBe("900 字节");
});
