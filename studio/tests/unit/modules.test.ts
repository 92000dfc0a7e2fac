// The table of the exhibits' modules: every exhibit has one, which answers it, and no module has an exhibit of another.
import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { expect, test } from "vitest";
import { EXHIBITS } from "../../src/exhibits/index";
import { ExhibitCores, moduleOf } from "../../src/exhibits/modules";
import { OWN_FIGURES } from "../../src/lesson/outline";
import table from "../../src/exhibits/modules.json";

const read = (file: string) => readFileSync(fileURLToPath(new URL(`../../wasm/${file}.wasm`, import.meta.url)));
const whole = read("exhibits");

test("every exhibit, and every figure of the lesson alone, is in one module", () => {
  const listed = Object.values(table).flat();
  expect(listed.toSorted()).toEqual([...EXHIBITS.map(({ id }) => id), ...OWN_FIGURES].toSorted());
});

test("a module exports its exhibits", async () => {
  for (const [module, ids] of Object.entries(table)) {
    const exported = WebAssembly.Module.exports(await WebAssembly.compile(read(`exhibits/${module}`))).map(({ name }) => name);
    for (const id of ids) expect(exported, module).toContain(`chordal_exhibit_${id}`);
  }
});

// `make test` compiles one module and copies it to each name; those of the pages are linked one by one.
const isWhole = (id: string) => read(`exhibits/${moduleOf(id)}`).equals(whole);
test.skipIf(EXHIBITS.every(({ id }) => isWhole(id)))("the module of an exhibit gives the answer of the one that has all", async () => {
  const all = new ExhibitCores(async () => whole);
  const own = new ExhibitCores(async (module) => read(`exhibits/${module}`));
  for (const { id, load } of EXHIBITS) {
    expect(isWhole(id), id).toBe(false);
    const { question, defaults } = (await load()).default;
    const asked = { exhibit: id, ...question(defaults) };
    expect(await own.ask(asked), id).toEqual(await all.ask(asked));
  }
}, 120_000);
