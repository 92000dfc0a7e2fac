// The real module behind its typed function: refusals are typed, a trap is final, and calls do not affect later ones.
import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { beforeAll, expect, test } from "vitest";
import { Broken, Core, HOST, Refused } from "../../src/core/module";
import type { SeamQuestion, StudyQuestion } from "../../src/core/types";
import { DEFAULTS } from "../../src/state/state";
import { firstOf, secondOf } from "../../src/view/Seam";
import { verdict } from "../../src/view/Verdicts";

const bytes = readFileSync(fileURLToPath(new URL("../../wasm/chordal.wasm", import.meta.url)));
const QUESTION: StudyQuestion = { control: DEFAULTS.control, segments: 8, other: 16, pixels_per_unit: 70, pixels: 0.5, t: 0.25, near: 0.2 };
const SEAM: SeamQuestion = { first: firstOf(DEFAULTS.seam), second: secondOf(DEFAULTS.seam), smoothness: "C0", leader: "first", scale: 1 };
let core: Core;
beforeAll(async () => {
  core = await Core.load(bytes);
});

test("the chain has the requested number of segments, and the gap is within the bound", () => {
  for (const segments of [1, 2, 3, 8, 64, 128]) {
    const { even, fewest } = core.ask("study", { ...QUESTION, segments });
    expect(even.points.length).toBe(segments + 1);
    expect(fewest.segments).toBeLessThanOrEqual(segments);
    for (const chain of [even, fewest]) {
      expect(chain.bound.evidence).toBe("proved");
      expect(chain.bound.at_least).toBeLessThanOrEqual(chain.bound.at_most!);
      expect(chain.gap!.distance).toBeLessThanOrEqual(chain.bound.at_most!);
      expect(chain.gap!.pixels).toBe(chain.gap!.distance * 70);
    }
    expect(fewest.bound.at_most!).toBeLessThanOrEqual(even.bound.at_most!);
  }
});

test("the number of segments that is called needed is enough, and one less is not", () => {
  for (const pixels of [1, 0.5, 0.25]) {
    const { needed } = core.ask("study", { ...QUESTION, pixels });
    for (const spacing of ["even", "fewest"] as const) {
      const n = needed[spacing]!;
      expect(verdict(core.ask("study", { ...QUESTION, segments: n })[spacing], pixels)).toBe("smooth");
      expect(verdict(core.ask("study", { ...QUESTION, segments: n - 1 })[spacing], pixels)).toBe("seen");
    }
  }
});

test("twice the segments, a quarter of the error", () => {
  const { even } = core.ask("ladder", { control: DEFAULTS.control, counts: [64, 128], pixels_per_unit: 70 });
  const ratio = even[0]!.gap / even[1]!.gap;
  expect(ratio).toBeGreaterThan(3.8);
  expect(ratio).toBeLessThan(4.2);
});

test("a doubling gives both gaps and their ratio", () => {
  const question = { ...QUESTION, segments: 12, other: 6 };
  const { even, other } = core.ask("study", question);
  const turned = core.ask("study", { ...question, segments: 6, other: 12 });
  expect(other.segments).toBe(6);
  expect(other.even).toEqual(turned.even);
  expect(other.times.even).toBe(other.even.gap!.pixels / even.gap!.pixels);
  expect(other.times.even!).toBeGreaterThan(3.9);
  expect(other.times.even!).toBeLessThan(4.2);
});

test("in equal steps a larger number may be too small, but none is from a certain number on", () => {
  // A hairpin: one vertex more moves all of them away from its tip.
  const control = [[8.4, 5.6], [0.2, 3], [2.6, 3.5], [6.5, 4.3]] as const;
  const question = { ...QUESTION, control, pixels_per_unit: 720 / 10.8 };
  const { needed, formula } = core.ask("study", question);
  const judged = (segments: number) => verdict(core.ask("study", { ...question, segments }).even, 0.5);
  expect(judged(needed.even!)).toBe("smooth");
  expect(needed.even_fails!.segments).toBeGreaterThan(needed.even!);
  expect(judged(needed.even_fails!.segments)).toBe("seen");
  expect(needed.even_fails!.pixels).toBe(core.ask("study", { ...question, segments: needed.even_fails!.segments }).even.gap!.pixels);
  expect(needed.even_from).toBe(needed.even_fails!.segments + 1);
  for (let n = needed.even_from!; n <= 128; n++) expect(judged(n), `${n}`).toBe("smooth");
  expect(formula.segments).toBeGreaterThanOrEqual(needed.even_from!);
});

test("a straight curve that turns back beyond its chain has a gap", () => {
  const control = [[5, 3], [9, 3], [1, 3], [5, 3]] as const;
  const { even } = core.ask("study", { ...QUESTION, control, segments: 5 });
  // It turns where 1 − 6 t + 6 t² is 0, close to the vertex at a fifth of the way.
  const x = (t: number) => 5 * (1 - t) ** 3 + 27 * t * (1 - t) ** 2 + 3 * t * t * (1 - t) + 5 * t ** 3;
  expect(even.gap!.distance).toBeCloseTo(x((3 - Math.sqrt(3)) / 6) - x(0.2), 12);
  expect(even.gap!.distance).toBeGreaterThan(2.5e-3);
});

test("curvatures at a joint have the sign of the turn", () => {
  const s = { first: [[0, 0], [1, 0], [2, 1], [2, 2]], second: [[2, 2], [2, 3], [3, 4], [4, 4]] } as const;
  const { join } = core.ask("seam", { ...SEAM, ...s, smoothness: "none" });
  expect(join.curvatures[0]).toBeCloseTo(2 / 3, 12);
  expect(join.curvatures[1]).toBeCloseTo(-2 / 3, 12);
});

test("a joint has the chosen smoothness, with either curve leading", () => {
  const levels = { none: null, C0: 0, C1: 1, C2: 2 } as const;
  for (const leader of ["first", "second"] as const) {
    for (const smoothness of ["none", "C0", "C1", "C2"] as const) {
      const second = secondOf(DEFAULTS.seam).map(([x, y]) => [x + 0.25, y + 0.5] as const) as never;
      const { first: a, second: b, join } = core.ask("seam", { ...SEAM, second, smoothness, leader });
      expect(join.parametric, `${leader} ${smoothness}`).toBe(levels[smoothness]);
      expect(join.position_gap === 0).toBe(smoothness !== "none");
      if (leader === "first") expect(a).toEqual(SEAM.first);
      else expect(b).toEqual(second);
    }
  }
});

test("degenerate curves are answered: all points equal, all on a line, turning back, a cusp", () => {
  const p = [3, 3] as const;
  for (const control of [
    [p, p, p, p],
    [p, [4, 3], [5, 3], [6, 3]],
    [p, [9, 3], [1, 3], [5, 3]],
    [[0, 0], [6, 6], [0, 6], [6, 0]],
    [p, p, p, [5, 5]],
  ] as const) {
    const { even, fewest, needed } = core.ask("study", { ...QUESTION, control });
    for (const chain of [even, fewest]) expect(chain.bound.at_most).toBeGreaterThanOrEqual(chain.gap?.distance ?? 0);
    expect(needed.fewest).not.toBeNull();
    core.ask("ladder", { control, counts: [1, 2, 4], pixels_per_unit: 70 });
  }
});

test("an invalid question is refused with a message, and the module still works", () => {
  const before = JSON.stringify(core.ask("study", QUESTION));
  for (const wrong of [
    { segments: 0 }, { segments: 1e9 }, { segments: 2.5 }, { segments: "8" }, { t: 2 }, { pixels: 0 }, { pixels: -1 },
    { pixels_per_unit: NaN }, { control: [] }, { control: [[0, 0], [1, 1], [2, 2], [Infinity, 0]] },
    { control: [[0, 0], [1, 1], [2, 2], [1e300, 0]] }, { control: null }, { colour: "red" }, { near: -1 },
  ]) {
    expect(() => core.ask("study", { ...QUESTION, ...wrong } as never), JSON.stringify(wrong)).toThrow(Refused);
  }
  for (const wrong of [null, [], 1, "text", {}]) expect(() => core.ask("study", wrong as never)).toThrow(Refused);
  expect(JSON.stringify(core.ask("study", QUESTION))).toBe(before);
});

test("many calls grow and detach the memory, and every answer stays the same", () => {
  const before = JSON.stringify(core.ask("study", QUESTION));
  for (let i = 0; i < 40; i++) core.ask("study", { ...QUESTION, segments: 1 + ((i * 367) % 1024) });
  expect(JSON.stringify(core.ask("study", QUESTION))).toBe(before);
});

test("after a trap the module is never called again", async () => {
  const broken = await Core.load(trapping());
  expect(() => broken.ask("study", QUESTION)).toThrow(Broken);
  expect(() => broken.ask("study", QUESTION)).toThrow(/trapped before/);
});

test("more memory than a module can have is a trap, and never a wrong address", async () => {
  const { instance } = await WebAssembly.instantiate(bytes, HOST);
  const { _initialize, chordal_alloc, memory } = instance.exports as { _initialize?(): void; chordal_alloc(n: number): number; memory: WebAssembly.Memory };
  _initialize?.();
  const before = memory.buffer.byteLength;
  for (const size of [2 ** 32 - 1, 2 ** 31]) expect(() => chordal_alloc(size)).toThrow(WebAssembly.RuntimeError);
  expect(memory.buffer.byteLength).toBe(before);
});

test("bytes that are no module give a typed error", async () => {
  await expect(Core.load(new Uint8Array([1, 2, 3]))).rejects.toThrow(Broken);
  await expect(Core.load(bytes.subarray(0, 1000))).rejects.toThrow(Broken);
});

/** A module with a memory and a `chordal_alloc` that traps. */
function trapping(): Uint8Array<ArrayBuffer> {
  return new Uint8Array([
    0, 0x61, 0x73, 0x6d, 1, 0, 0, 0, 1, 6, 1, 0x60, 1, 0x7f, 1, 0x7f, 3, 2, 1, 0, 5, 3, 1, 0, 1, 7, 26, 2, 6,
    ...new TextEncoder().encode("memory"), 2, 0, 13, ...new TextEncoder().encode("chordal_alloc"), 0, 0, 10, 5, 1, 3, 0, 0, 0x0b,
  ]);
}
