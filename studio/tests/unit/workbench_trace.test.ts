// Which call of a script made a face, and which mistakes come after the first.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { beforeAll, expect, test } from "vitest";
import { run } from "../../src/core/command";
import { inScript, isMendable, withoutFault } from "../../src/workbench/faults";
import { parts } from "../../src/workbench/glb";
import { type Fault, faultOf } from "../../src/workbench/outcome";
import { withLeft } from "../../src/workbench/progress";
import { facesOf, siteAt } from "../../src/workbench/trace/faces";
import { PRIMITIVES, shadowOf } from "../../src/workbench/trace/shadow";

let module: WebAssembly.Module;
beforeAll(async () => {
  module = await WebAssembly.compile(readFileSync(join(import.meta.dirname, "../../wasm/command.wasm")));
}, 60_000);

const text = (of: string) => new TextEncoder().encode(of);

const SCRIPT = `# A part.
def drill(r):
    return cylinder(r, 9)  # box(1, 1, 1)
a = color(box(4, 3, 1), "#f00")
b = extrude(
    circle(0.5),
    4,
)
move(a | move(b, 1, 0), 1, 0) - move(drill(0.3), 0, 0.5)
`;

test("every call of a primitive has a colour of its own, and no other line moves or changes", () => {
  const { text: shadow, sites } = shadowOf(SCRIPT);
  expect(sites.map(({ name, line }) => [name, line])).toEqual([["cylinder", 3], ["box", 4], ["circle", 6]]);
  expect(sites.map(({ from, to }) => SCRIPT.slice(from, to))).toEqual(["cylinder(r, 9)", "box(4, 3, 1)", "circle(0.5)"]);
  expect(shadow).toContain('a = chordal_plain(chordal_site(2, box(4, 3, 1)), "#f00")');
  expect(shadow).toContain("# box(1, 1, 1)");
  // A function of the script's own may have such a name.
  expect(shadowOf("def box(a):\n    return sphere(a)\nbox(1)").sites.map(({ name }) => name)).toEqual(["sphere"]);
});

test("a point of the mesh leads to its call", async () => {
  const { text: shadow, sites } = shadowOf(SCRIPT);
  const outcome = await run(module, ["mesh", "a.star", "--tol", "0.5%", "--require", "estimated", "-o", "a.glb", "--json"], { "a.star": text(shadow) });
  const { certificate } = JSON.parse(outcome.stdout);
  const trace = { bench: null!, sites, parts: parts(outcome.outputs["a.glb"]!, certificate.frame) };
  expect(siteAt(trace, [-0.5, -1, 0.5], [0, 0, 1])?.name).toBe("box");
  expect(siteAt(trace, [2.5, 0, 1.5], [1, 0, 0])?.name).toBe("circle");
  expect(siteAt(trace, [0.3, 0.5, 0.1], [-1, 0, 0])?.name).toBe("cylinder");
  const layers = facesOf(trace, [sites[0]!], "#fff");
  expect(layers.length).toBeGreaterThan(0);
}, 60_000);

test("all functions that make shapes of numbers are known", async () => {
  const { functions } = JSON.parse((await run(module, ["language", "--json"], {})).stdout) as { functions: { name: string; group: string }[] };
  const groupOf = (name: string) => functions.find((one) => one.name === name)!.group;
  const groups = [groupOf("sphere"), groupOf("circle")];
  expect(functions.filter(({ name, group }) => groups.includes(group) && !PRIMITIVES.has(name))).toEqual([]);
}, 60_000);

test("the mistakes after the first are found, and none that the first one causes", async () => {
  const faults = async (script: string): Promise<Fault[]> => {
    const found: Fault[] = [];
    for (let copy: string | null = script; copy !== null && found.length < 9; ) {
      const outcome = await run(module, ["inspect", "a.star", "--json"], { "a.star": text(copy) });
      if (outcome.exit === 0) break;
      const fault = inScript(faultOf(outcome), copy, script);
      if (!isMendable(fault)) break;
      found.push(fault);
      copy = withoutFault(copy, fault);
    }
    return found;
  };
  const places = async (script: string) => (await faults(script)).map(({ line, column }) => [line, column]);
  expect(await places("a = bx(1, 1, 1) | sphre(1)\ndef f():\n    return undefd\nb = 2 +* 3\na + b\n")).toEqual([[4, 8], [1, 5], [1, 19], [3, 12]]);
  // What stands in a line that is no Starlark stays assigned.
  expect(await places("r = 1 +\nsphere(r)")).toEqual([[1, 8]]);
  expect(await places("sphere(1)")).toEqual([]);
}, 60_000);

test("the time left is told after a while, and begins anew with each stage", () => {
  const first = withLeft({ stage: "prove", percent: 10 }, undefined);
  expect(first.left).toBeNull();
  const began = { ...first, since: { at: first.since.at - 10_000, percent: 10 } };
  expect(withLeft({ stage: "prove", percent: 60 }, began).left).toBeCloseTo(8, 0);
  expect(withLeft({ stage: "cells", percent: 60 }, began).left).toBeNull();
});
