// A file that carries its script: what is opened in its place, and what is said about its proof.
import { expect, test } from "vitest";
import { Controller } from "../../src/workbench/controller";
import { Cupboard, MOST_KEPT } from "../../src/workbench/cupboard";
import { bench, textOf } from "../../src/workbench/document";
import type { Jobs } from "../../src/core/jobs";
import type { LaneName } from "../../src/workbench/state";

const text = (of: string) => new TextEncoder().encode(of);
const source = {
  name: "plate.star",
  sha256: "0",
  text: "load('lib.star', 'peg')\nbox(1, 2, 3) | peg(2)\n",
  parameters: { r: 0.5 },
  files: [
    { path: "lib.star", sha256: "1", text: "def peg(h):\n    return cylinder(1, h)\n" },
    { path: "font.ttf", sha256: "2" },
  ],
};

/** A controller whose command reports this certificate of a file, and this verdict. */
function opened(certificate: object | null, verdict: object) {
  const lines: string[][] = [];
  const run = async (_: LaneName, words: string[]) => {
    lines.push(words);
    const report = words[0] === "inspect" ? { inspection: { findings: null, found: certificate && { certificate } } } : words[0] === "verify" ? verdict : {};
    return { exit: 0, stdout: JSON.stringify(report), stderr: "", outputs: {} };
  };
  const jobs = { run, isRunning: () => false, cancel: () => undefined } as unknown as Jobs<LaneName>;
  const control = new Controller(jobs, bench("first.star", { "first.star": text("sphere(1)") }), () => undefined);
  return { control, lines };
}
const file = (name: string) => new File([text("glTF")], name);

test("it is opened as that script, with its parameters, its budget and what was opened with it", async () => {
  const { control, lines } = opened({ sources: [source], budget: { length: 0.02, pixels: null, triangles: null } }, { verdict: "re-proved", claims: [] });
  await control.open([file("plate.glb"), file("font.ttf")]);
  const { bench: now } = control.state;
  expect([now.name, textOf(now), now.set]).toEqual(["plate.star", source.text, { r: "0.5" }]);
  expect(now.budget).toMatchObject({ by: "tol", tol: "0.02" });
  expect(Object.keys(now.files).sort()).toEqual(["font.ttf", "lib.star", "plate.star"]);
  await control.until(({ carried }) => carried?.isRunning === false);
  expect(lines).toContainEqual(["verify", "plate.glb", "--json"]);
  expect(control.state.carried).toMatchObject({ verdict: "re-proved", reason: "" });
  // The file itself, with what was opened beside it, is one click away.
  expect(Object.keys(control.state.carried!.file.files)).toEqual(["plate.glb", "font.ttf"]);
});

test("a font that its script reads is taken from this browser by its contents, and what is given later proves it again", async () => {
  const font = { ...source, text: 'text("A", "font.ttf", 0.1)', files: [{ path: "font.ttf", sha256: "41" }] };
  const { control } = opened({ sources: [font] }, { verdict: "re-proved", claims: [] });
  control.cupboard = cupboard();
  await control.cupboard.keep(bench("other.star", {}), { "another.ttf": text("A") });
  await control.open([file("plate.glb")]);
  expect(control.state.bench.files["font.ttf"]).toEqual(text("A"));
  await control.until(({ carried }) => carried?.isRunning === false);
  // Without it the file is proved once the font is chosen.
  const later = opened({ sources: [font] }, {});
  await later.control.open([file("plate.glb")]);
  await later.control.until(({ carried }) => carried?.isRunning === false);
  expect(later.control.state.carried?.verdict).toBeNull();
  const first = later.lines.filter(([verb]) => verb === "verify").length;
  later.control.supply({ name: "font.ttf", isFont: true, line: 1 }, { "mine.ttf": text("A") });
  await later.control.until(({ carried }) => carried?.isRunning === false);
  expect(later.lines.filter(([verb]) => verb === "verify").length).toBe(first + 1);
  expect(Object.keys(later.control.state.carried!.script.files).sort()).toEqual(["font.ttf", "plate.star"]);
});

/** A cupboard in memory, whose digest of a text is its first byte in hexadecimal and its length beyond one. */
function cupboard(values = new Map<string, unknown>()) {
  const drawer = {
    get: async (key: string) => values.get(key),
    set: async (key: string, value: unknown) => void values.set(key, value),
    drop: async (key: string) => void values.delete(key),
  };
  return new Cupboard(drawer, async (bytes) => `${(bytes[0] ?? 0).toString(16).padStart(2, "0")}${bytes.length > 1 ? bytes.length : ""}`);
}

test("the cupboard has fonts by their name for every script, other files for the script on the shelf that they were given to", async () => {
  const values = new Map<string, unknown>();
  const kept = { ...bench("a.star", {}), kept: "id1" };
  const other = bench("b.star", {});
  await cupboard(values).keep(kept, { "a.star": text("script"), "font.ttf": text("F"), "part.stl": text("P") });
  const again = cupboard(values);
  expect(await again.find(kept, "part.stl")).toEqual(text("P"));
  expect(await again.find(other, "font.ttf")).toEqual(text("F"));
  expect([await again.find(other, "part.stl"), await again.find(kept, "a.star"), await again.withDigest("58")]).toEqual([null, null, null]);
  // What is not what it was is not used.
  values.set("file 50", text("Q"));
  expect(await again.find(kept, "part.stl")).toBeNull();
  // The oldest files go first.
  for (const letter of ["a", "b", "c"]) await again.keep(kept, { [`${letter}.stl`]: new Uint8Array(0.4 * MOST_KEPT).fill(letter.charCodeAt(0)) });
  const left = await Promise.all(["font.ttf", "a.stl", "b.stl", "c.stl"].map((path) => again.find(kept, path)));
  expect(left.map((one) => one !== null)).toEqual([false, false, true, true]);
  // A browser that keeps nothing is no error.
  const refusing = new Cupboard({ get: () => Promise.reject(new Error()), set: () => Promise.reject(new Error()), drop: () => Promise.reject(new Error()) });
  await refusing.keep(kept, { "font.ttf": text("F") });
  expect(await refusing.find(kept, "font.ttf")).toBeNull();
});

test("a claim that fails is named", async () => {
  const claims = [{ claim: "seal", verdict: "refuted", reason: "the certificate was edited" }];
  const { control } = opened({ sources: [source] }, { verdict: "refuted", claims });
  await control.open([file("plate.3mf")]);
  await control.until(({ carried }) => carried?.isRunning === false);
  expect(control.state.carried).toMatchObject({ verdict: "refuted", reason: "seal: the certificate was edited" });
});

test("a file without a script, or with a name that leads elsewhere, is opened as it is", async () => {
  for (const certificate of [null, {}, { sources: [] }, { sources: [{ ...source, name: "../plate.star" }] }, { sources: [{ ...source, name: "plate.sh" }] }]) {
    const { control } = opened(certificate, {});
    await control.open([file("plate.glb")]);
    expect([control.state.bench.name, control.state.carried], JSON.stringify(certificate)).toEqual(["plate.glb", null]);
  }
  // Other formats carry none: what is open stays until the file replaces it at once.
  const { control } = opened({ sources: [source] }, {});
  await control.open([file("plate.stl")]);
  expect([control.state.bench.name, control.state.carried]).toEqual(["plate.stl", null]);
});
