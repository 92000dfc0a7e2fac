// The command's sentences about mistakes have a Chinese form: those that its source makes, as the page shows them.
import { readFileSync, readdirSync, statSync } from "node:fs";
import { beforeAll, describe, expect, test } from "vitest";
import { faultIn, lineIn, loadSentences } from "../../src/workbench/command_zh";
import { KINDS_ZH, SENTENCES_ZH, chineseOf, noteOf } from "../../src/workbench/sentences";
import { NOTES } from "../../src/workbench/sentences/script_zh";
import { translator } from "../../src/workbench/sentences/match";

beforeAll(loadSentences);

const PROJECT = new URL("../../../", import.meta.url).pathname;

/** The texts of a Rust source with several words, without those of comments, tests, panics, and the help on functions. */
function textsOf(source: string): string[] {
  const code = source.split("#[cfg(test)]")[0]!;
  const token = /\/\/[^\n]*|'(?:\\[^']*|[^'\\])'|"((?:\\[^]|[^"\\])*)"/g;
  return [...code.matchAll(token)].flatMap(({ 0: whole, 1: text, index }) => {
    const before = code.slice(0, index).trimEnd();
    const isOther = /(?:expect\(|unreachable!\(|panic!\(|assert[\w!]*\(|contains\(|starts_with\(|about:|distance:|include_str!\(|(?:unary|binary)_function\(\s*"\w+",(?:\s*\[[^\]]*\],)?)$/.test(before);
    if (!whole.startsWith('"') || isOther) return [];
    const plain = text!.replace(/\\\n\s*/g, "").replace(/\\(.)/g, "$1");
    return / \S+ |[a-z]{3} [a-z]/.test(plain) ? [plain] : [];
  });
}

const rustFiles = (path: string): string[] =>
  statSync(PROJECT + path).isFile()
    ? [path]
    : readdirSync(PROJECT + path, { recursive: true, encoding: "utf8" })
        .filter((name) => name.endsWith(".rs") && !/(^|_)tests\.rs$/.test(name))
        .map((name) => `${path}/${name}`);

/** With all places for values alike: `{}` in the source, `{n}` in the tables. */
const alike = (text: string) => text.replace(/\{[\w:.?#]*\}/g, "{}");
const KNOWN = [SENTENCES_ZH, KINDS_ZH, NOTES].flatMap((table) => Object.keys(table).map(alike));

/** Texts that are no whole sentence: what is put into them, or before and after them, is in the tables. */
const PARTS = [
  "there is no '**': {}",
  "there is no pow(): {}",
  "{} is not supported in this form: write it in simpler steps",
  "the script has no parameter '{}'; {}",
  "'{}' is not defined for {} and {}{}",
  "takes {} argument{}, but {} were given",
  "has no argument '{}'{}",
  "got '{}' twice{}",
  "a hull of shapes takes {}, and {}: {}",
  "{} is {}, and must be {}",
  "{}, and must be at most {}",
];
/** Texts that are in no sentence about a mistake: operators and code, help on functions, an assumption of a proof, names. */
const OTHER = [
  "not in",
  "= ({}) {} (",
  "as for the given shape",
  "lower bound",
  "outside as for the given shape, inside a lower bound",
  "a displacement takes off no more than its amplitude, {}",
  "levels/in the file {}",
  // Kinds of shapes, by which a judge is chosen.
  "signed distance",
  "input triangles",
  "bezier patches",
  "nurbs surfaces",
  "trilinear interpolant",
  "limit surface",
];

/** The texts of some files that are in no sentence with a translation. */
function unknownIn(paths: readonly string[]): string[] {
  const texts = paths.flatMap(rustFiles).flatMap((path) => textsOf(readFileSync(PROJECT + path, "utf8")).map(alike));
  expect(texts.length, `texts of ${paths.slice(0, 3).join(", ")}`).toBeGreaterThan(5);
  return texts.filter(isUnknown);
}
const isUnknown = (text: string) => !PARTS.includes(text) && !OTHER.includes(text) && !KNOWN.some((known) => known.includes(text));

describe("every sentence", () => {
  test("about a script has a translation", () => {
    // Help on functions, names of other tools, and remarks that the page does not show.
    const aside = /\/(words|other_tools|warning)\.rs$/;
    const files = rustFiles("crates/chordal-script/src").filter((name) => !aside.test(name));
    expect(files.length).toBeGreaterThan(20);
    expect(unknownIn(files)).toEqual([]);
  });

  test("about a function of another tool has a translation", () => {
    const table = readFileSync(`${PROJECT}crates/chordal-script/src/other_tools.rs`, "utf8").split("const NAMES")[1]!.split("\n];")[0]!;
    const equivalents = [...table.matchAll(/"([^"]*\([^"]*|[^"]* and [^"]*)"\s*,?\s*\)/g)].map(([, call]) => call!);
    expect(equivalents.length).toBeGreaterThan(50);
    // A call alone is the same in every language.
    expect(equivalents.filter((call) => !/^\w+\((?:[^()]|\([^()]*\))*\)$/.test(call) && !(call in KINDS_ZH))).toEqual([]);
  });

  test("about the numbers of a shape has a translation", () => {
    expect(unknownIn(["crates/chordal/src/implicit/shapes", "crates/chordal/src/implicit/combine"])).toEqual([]);
  });

  test("about the numbers of a shape names them in Chinese", () => {
    const files = ["crates/chordal/src/implicit/shapes", "crates/chordal/src/implicit/combine"].flatMap(rustFiles);
    const names = files.flatMap((path) => [...readFileSync(PROJECT + path, "utf8").split("#[cfg(test)]")[0]!.matchAll(/"(an? [a-z' ]+)"/g)].map(([, name]) => name!));
    expect(names.length).toBeGreaterThan(50);
    expect([...new Set(names)].filter((name) => !(name in KINDS_ZH) && !(name in SENTENCES_ZH) && !name.startsWith("a finite number"))).toEqual([]);
  });

  test("about a claim that was not proved again has a translation", () => {
    expect(unknownIn(["crates/chordal-verbs/src/verify"])).toEqual([]);
  });

  test("about a field that has no mesh has a translation", () => {
    expect(unknownIn(["crates/chordal/src/convert/field_to_mesh.rs", "crates/chordal/src/convert/fields/mesher.rs", "crates/chordal/src/convert/fields/draft.rs"])).toEqual([]);
  });

  test("in Chinese ends as one, and has the values of the English one", () => {
    for (const [english, chinese] of Object.entries({ ...SENTENCES_ZH, ...NOTES })) {
      expect(chinese, english).toMatch(/\p{Script=Han}|\{w/u);
      expect(chinese, english).toMatch(/[。？；}）)]$/u);
      const places = (text: string) => [...text.matchAll(/\{(\w+)\}/g)].map(([, place]) => place!);
      const known = places(english);
      expect(places(chinese).filter((place) => !known.includes(place)), english).toEqual([]);
      expect(chinese, english).not.toMatch(/\p{Script=Han}[,;:?!]|[,;]\p{Script=Han}/u);
    }
  });
});

test("every form of a sentence in parts is in the tables", () => {
  // A part that is fixed must be in some of them, or the list above is about another source.
  for (const part of PARTS) {
    const fixed = part.split("{}").filter((text) => text.trim().length > 5);
    expect(KNOWN.some((known) => fixed.every((text) => known.includes(text))), part).toBe(true);
  }
});

const chineseNote = "polygon()：路径化为折线，相距不超过 1e-3（已证明）。";

describe("a sentence", () => {
  const said: [english: string, chinese: string][] = [
    ["Variable `spere` not found, did you mean `sphere`?", "没有名为 `spere` 的变量或函数，是不是 `sphere`？"],
    ["Variable `cube` not found: use box(x, y, z), with full side lengths, centred on the origin", "没有 `cube`，请用 box(x, y, z)（参数是完整的边长，中心在原点）。"],
    ["cylinder() needs 'height': call it as cylinder(radius, height)", "cylinder() 缺少参数 height。写法：cylinder(radius, height)"],
    ["box() needs a number for 'x', not a string", "box() 的参数 x 应为数，而不是文本。"],
    ["sphere(): a sphere's radius is -1, and must be a finite number above 0", "sphere()：球的半径是 -1，须大于 0。"],
    ["spline() cannot make a path: the spline needs at least 2 points", "spline() 得不到路径：样条至少要 2 个点。"],
    ["bad.star, line 2, column 12: box() needs 'z': call it as box(x, y, z)", "bad.star 第 2 行第 12 列：box() 缺少参数 z。写法：box(x, y, z)"],
    ["the script's value must be a shape, but it is None: a loop has no value: collect its shapes in a list, and end the script with union(…) of the list",
      "脚本的值必须是形状，现在是 None：循环没有值。请把形状收进一个列表，最后一行写 union(…)，参数是这个列表。"],
    ["hull() needs points of 2 or 3 numbers for 'points', not a list with other values", "hull() 的参数 points 应为每点两个或三个数，而不是含有其他值的列表。"],
    ["sphere() needs 3 numbers for 'center', not 2", "sphere() 的参数 center 应为 3 个数，而不是 2。"],
    ["Parse error: unexpected symbol ':', expected expression", "语法错误：这里应为表达式，而不是符号“:”。"],
    ["invalid value 'abc' for '--tol <LENGTH>': a length must be finite and greater than 0 (see --help)", "长度的值“abc”不能用：长度须有限且大于 0。"],
    ["invalid value 'q' for '--up <AXIS>': the axis that is up is y or z (see --help)", "--up <AXIS> 的值“q”不能用：朝上的轴是 y 或 z。"],
    ["Parse error: invalid input `（`", "语法错误：“（”是全角符号，请改用半角的 ( 。"],
    ["part 1: the script's value must be a shape, but it is a number", "part 1：脚本的值必须是形状，现在是数。"],
  ];
  test.each(said)("%s", (english, chinese) => expect(chineseOf(english)).toBe(chinese));

  test("without a translation, or with a part that has none, stays English after what its code says", () => {
    expect(chineseOf("it hums")).toBeUndefined();
    expect(chineseOf("spline() cannot make a path: it hums")).toBeUndefined();
    expect(faultIn("zh", { text: "it hums", code: "not-stl" })).toEqual({ lead: "这不是 STL 文件。", text: "it hums", lang: "en" });
    expect(faultIn("zh", { text: "it hums" })).toEqual({ text: "it hums", lang: "en" });
    expect(faultIn("zh", { text: "太薄", code: "script-error" })).toEqual({ lead: "脚本运行出错。", text: "太薄" });
    expect(faultIn("zh", { text: "cancelled", code: "cancelled" })).toEqual({ text: "已取消。" });
    expect(faultIn("en", { text: "it hums", code: "not-stl" })).toEqual({ text: "it hums" });
  });

  test("of a function among the lines of a script is known, and others are not", () => {
    expect(noteOf("fit(): the path is within 1.000e-2 of every point (proved)")).toBe("fit()：路径与每个点相距不超过 1.000e-2（已证明）。");
    expect(noteOf("width 3")).toBeUndefined();
    const note = "polygon(): its path is replaced by straight lines within 1e-3 (proved)";
    expect([lineIn("zh", note), lineIn("zh", "width 3"), lineIn("en", note)]).toEqual([chineseNote, "width 3", note]);
  });

  test("is found by its most specific form", () => {
    const say = translator({ "{text}": "别的。", "{f}() needs {n}": "{f} 要 {n}。", "{f}() needs {text}": "{f} 要什么。" }, {});
    expect([say("a() needs 3"), say("a() needs b"), say("a b")]).toEqual(["a 要 3。", "a 要什么。", "别的。"]);
  });
});
