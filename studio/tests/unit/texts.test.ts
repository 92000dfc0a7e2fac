// The catalogues have the same texts, all of them are used, and numbers are formatted as specified.
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { expect, test } from "vitest";
import { en, type Key } from "../../src/i18n/en";
import { CATALOGUES, Speaker, fill, preferred } from "../../src/i18n/speak";
import { zh } from "../../src/i18n/zh";

const places = (text: string) => [...text.matchAll(/\{(\w+)\}/g)].map((match) => match[1]!).sort();

test("every catalogue has the same keys in the same order", () => {
  for (const catalogue of Object.values(CATALOGUES)) expect(Object.keys(catalogue)).toEqual(Object.keys(en));
});

test("every text has the same placeholders, and is not empty", () => {
  for (const key of Object.keys(en) as Key[]) {
    expect(places(zh[key]), key).toEqual(places(en[key]));
    expect(zh[key].trim(), key).not.toBe("");
  }
});

test("nothing is left untranslated", () => {
  const same = (Object.keys(en) as Key[]).filter((key) => zh[key] === en[key]);
  expect(same).toEqual(["density.other", "seam.degrees"]);
  const without = (Object.keys(zh) as Key[]).filter((key) => !/\p{Script=Han}/u.test(zh[key]));
  expect(without).toEqual(["density.other", "seam.degrees"]);
  expect((Object.keys(en) as Key[]).filter((key) => /\p{Script=Han}/u.test(en[key]))).toEqual([]);
});

test("every text is used", () => {
  const root = fileURLToPath(new URL("../../src", import.meta.url));
  const files = readdirSync(root, { recursive: true, encoding: "utf8" }).filter((name) => /\.tsx?$/.test(name) && !/i18n.(en|zh)\.ts$/.test(name));
  const source = files.map((name) => readFileSync(join(root, name), "utf8")).join("\n");
  // A key occurs as a whole, or as the start of a template such as `verdict.${result}`.
  const isUsed = (key: string) => source.includes(`"${key}"`) || source.includes(`\`${key.slice(0, key.lastIndexOf(".") + 1)}\${`);
  const counted = (key: string) => /^(segments|pixels|units)\.(one|other)$/.test(key);
  expect(Object.keys(en).filter((key) => !isUsed(key) && !counted(key))).toEqual([]);
});

test("numbers have three digits, and one is one", () => {
  const english = new Speaker("en");
  expect(english.pixels(17.6630204)).toBe("17.7 pixels");
  expect(english.pixels(1.0004)).toBe("1 pixel");
  expect(english.pixels(0.5)).toBe("0.5 pixels");
  expect(english.segments(1)).toBe("1 segment");
  expect(english.segments(12)).toBe("12 segments");
  expect(english.units(0)).toBe("0 units");
  expect(english.number(12345)).toBe("12300");
  expect(english.number(3.46e-12)).toBe("3.5·10⁻¹²");
  expect(new Speaker("zh").pixels(17.6630204)).toBe("17.7 像素");
});

test("factors have a decimal, and signs are shown except for zero", () => {
  const english = new Speaker("en");
  expect(english.times(4.0004)).toBe("4.0");
  expect(english.times(11.96)).toBe("12.0");
  expect(english.signed(0.51234)).toBe("+0.512");
  expect(english.signed(-0.51234)).toBe("−0.512");
  expect(english.signed(0)).toBe("0");
});

test("the Chinese terms are those of graphics textbooks, and no others are used for the same thing", () => {
  const all = Object.values(zh).join("\n");
  for (const term of ["弦高误差", "已证明的上界", "参数等分", "曲率突变", "德卡斯特里奥算法", "浅色粗线", "像素密度翻倍"]) expect(all).toContain(term);
  for (const other of ["间隙", "宽带", "加密一倍", "等步长", "跳变", "作图法", "偏差 {px}"]) expect(all).not.toContain(other);
});

test("on all pages one Chinese word is used for one thing: none of those that docs/studio.md advises against", () => {
  const project = fileURLToPath(new URL("../../../", import.meta.url));
  const docs = readFileSync(join(project, "docs/studio.md"), "utf8");
  const rows = docs.slice(docs.indexOf("## Terms in 中文")).split("\n").filter((line) => line.startsWith("| "));
  const columns = rows.map((line) => line.split("|").map((cell) => cell.trim()));
  const wrong = columns.flatMap(([, , , not]) => (not === "not" || !not ? [] : not.split(", ")));
  expect(wrong).toEqual(expect.arrayContaining(["内核", "网址", "您"]));
  const studio = join(project, "studio");
  const files = ["src", "public"].flatMap((folder) =>
    readdirSync(join(studio, folder), { recursive: true, encoding: "utf8" }).map((name) => join(folder, name)));
  const texts = [...files.filter((name) => /\.(tsx?|js)$/.test(name)), "index.html", "zh.html", "exhibit.html", "workbench.html"];
  expect(texts.length).toBeGreaterThan(100);
  const found = texts.flatMap((name) => {
    const text = readFileSync(join(studio, name), "utf8");
    return wrong.filter((word) => text.includes(word)).map((word) => `${name}: ${word}`);
  });
  expect(found).toEqual([]);
  // And every word that is advised is used somewhere, or the table is about another text.
  const all = texts.map((name) => readFileSync(join(studio, name), "utf8")).join("\n");
  const advised = columns.flatMap(([, , chinese]) => (/\p{Script=Han}/u.test(chinese ?? "") ? chinese!.split(", ") : []));
  expect(advised.filter((word) => word !== "中文" && !all.includes(word))).toEqual([]);
});

test("a text keeps a placeholder without a value, and inserts values unchanged", () => {
  expect(fill("{a} and {b}", { a: "{b}" })).toBe("{b} and {b}");
  expect(fill("{a}", { a: "$& <b>" })).toBe("$& <b>");
});

test("the reader's own language is chosen, else English", () => {
  expect(preferred(["zh-TW", "en"])).toBe("zh");
  expect(preferred(["de-DE", "zh"])).toBe("zh");
  expect(preferred(["en-GB", "zh"])).toBe("en");
  expect(preferred(["fr"])).toBe("en");
  expect(preferred([])).toBe("en");
});
