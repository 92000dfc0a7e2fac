// The texts of the workbench: the same in both languages, and all of them used.
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { expect, test } from "vitest";
import { LAYOUT_TEXTS } from "../../src/workbench/layout/texts";
import { MEASURE_TEXTS } from "../../src/workbench/measure/texts";
import { PANEL_TEXTS } from "../../src/workbench/panel_texts";
import { TEXTS } from "../../src/workbench/texts";

const FOLDER = new URL("../../src/workbench/", import.meta.url).pathname;

/** The source of the workbench, without its texts. */
const source = readdirSync(FOLDER, { recursive: true, encoding: "utf8" })
  .filter((name) => /\.tsx?$/.test(name) && !/^(panel_)?texts\.ts$/.test(name))
  .map((name) => readFileSync(join(FOLDER, name), "utf8"))
  .join("\n");

/** Every text by its path, such as `shows.wire`, and its number of parameters. */
function paths(of: object, prefix = ""): [path: string, values: number][] {
  return Object.entries(of).flatMap(([key, value]): [string, number][] => {
    if (value !== null && typeof value === "object") return paths(value, `${prefix}${key}.`);
    return [[prefix + key, typeof value === "function" ? value.length : 0]];
  });
}

test("are the same in both languages, in the same order, and take the same parameters", () => {
  for (const texts of [TEXTS, LAYOUT_TEXTS, MEASURE_TEXTS, PANEL_TEXTS]) expect(paths(texts.zh)).toEqual(paths(texts.en));
});

test("of panels, tools and measuring are all used", () => {
  const isUsed = (key: string) => new RegExp(`(\\b(texts|measuring|words)|LAYOUT_TEXTS\\[\\w+\\])\\.${key}\\b`).test(source);
  for (const texts of [LAYOUT_TEXTS, MEASURE_TEXTS]) expect(Object.keys(texts.en).filter((key) => !isUsed(key))).toEqual([]);
});

test("are all used", () => {
  // `words.shows[value]`, `words[value]` of a list of names, and `TEXTS[language].title`.
  const isUsed = (key: string) =>
    new RegExp(`(words|TEXTS\\[\\w+\\])\\.${key}\\b|const \\{[^}]*\\b${key}\\b[^}]*\\} = words`).test(source) ||
    (source.includes("words[") && source.includes(`"${key}"`));
  expect([...Object.keys(TEXTS.en), ...Object.keys(PANEL_TEXTS.en)].filter((key) => !isUsed(key))).toEqual([]);
  // A text of a record is chosen by its key, which occurs in quotes somewhere; an example has the name of its file.
  const names = [...paths(TEXTS.en), ...paths(PANEL_TEXTS.en)].filter(([path]) => path.includes(".")).map(([path]) => path.split(".").at(-1)!);
  expect(names.filter((name) => !source.includes(`"${name}"`) && !source.includes(`import ${name} from`))).toEqual([]);
});
