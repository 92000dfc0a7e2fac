// A file that carries its script: what is opened in its place, and what is said about its proof.
import { expect, test } from "vitest";
import { Controller } from "../../src/workbench/controller";
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
