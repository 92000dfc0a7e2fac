import { readFileSync } from "node:fs";
import { test } from "vitest";
import { EXHIBITS } from "../../src/exhibits/index";
import { Core } from "../../src/core/module";
test("speed", async () => {
  const rows: string[] = [];
  for (const { id, load } of EXHIBITS) {
    const { question, defaults } = (await load()).default;
    const asked = { exhibit: id, ...question(defaults) };
    const core = await Core.load(readFileSync(`${process.env["DIRW"]}/${id}.wasm`));
    const t0 = performance.now(); core.ask("exhibit", asked); const t1 = performance.now();
    let best = Infinity; for (let i = 0; i < 5; i++) { const t = performance.now(); core.ask("exhibit", asked); best = Math.min(best, performance.now() - t); }
    rows.push(`${id} first ${(t1 - t0).toFixed(1)} best ${best.toFixed(2)}`);
  }
  console.log(rows.join("\n"));
}, 300000);
