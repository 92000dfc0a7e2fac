// The six lines of code beside the figure run, and give the core's result.
import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { expect, test } from "vitest";
import { Core } from "../../src/core/module";
import { DEFAULTS } from "../../src/state/state";
import { CODE } from "../../src/view/Recipe";

const wasm = readFileSync(fileURLToPath(new URL("../../wasm/chordal.wasm", import.meta.url)));

test("the six lines give the formula's number of points, on the curve", async () => {
  expect(CODE.split("\n").length).toBe(6);
  const core = await Core.load(wasm);
  for (const goal of [1, 0.5, 0.25]) {
    const question = { control: DEFAULTS.control, segments: 1, other: 1, pixels_per_unit: 720 / 10.8, pixels: goal, t: 0, near: 1 };
    const { formula } = core.ask("study", question);
    const { even } = core.ask("study", { ...question, segments: formula.segments });
    const points = DEFAULTS.control.map(([x, y]) => `complex(${x}, ${y})`).join(", ");
    const program = `${CODE}\nimport json\nprint(json.dumps([[z.real, z.imag] for z in polyline([${points}], ${formula.length})]))`;
    const run = spawnSync("python3", ["-c", program], { encoding: "utf8" });
    expect(run.stderr).toBe("");
    const result = JSON.parse(run.stdout) as [number, number][];
    expect(result.length).toBe(formula.segments + 1);
    result.forEach(([x, y], i) => {
      expect(x).toBeCloseTo(even.points[i]![0], 12);
      expect(y).toBeCloseTo(even.points[i]![1], 12);
    });
    expect(even.gap!.pixels).toBeLessThanOrEqual(goal);
  }
});
