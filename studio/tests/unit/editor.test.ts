// Numbers and parameters of scripts: which are found, and how steps change them.
import { Text } from "@codemirror/state";
import { readFileSync } from "node:fs";
import { expect, test } from "vitest";
import { SENTENCES, WORTHS, inChinese } from "../../src/workbench/editor/functions_zh";
import { difference } from "../../src/workbench/editor/live";
import { fitting, numberAt, numbersOf, rewritten, stepOf, stepped } from "../../src/workbench/editor/numbers";
import { paramsOf, withParam } from "../../src/workbench/editor/params";
import { problemAt } from "../../src/workbench/editor/problem";
import { callAt, functionAt, parameterName, parametersOf } from "../../src/workbench/editor/table";
import { tokens } from "../../src/workbench/editor/tokens";

const numbers = (text: string) => numbersOf(text).map(({ from, to }) => text.slice(from, to));
const example = (name: string) => readFileSync(new URL(`../../../examples/${name}.star`, import.meta.url), "utf8");

test("numbers are found", () => {
  expect(numbers("box(2, 0.25, 1e-3) # 7\n")).toEqual(["2", "0.25", "1e-3"]);
  expect(numbers("a1 = r2d2 + _3 + 4")).toEqual(["4"]);
  expect(numbers('"5" + \'6\' + """7\n8""" + r"9\\\\" + 10')).toEqual(["10"]);
  expect(numbers("'it\\'s 5' + 6")).toEqual(["6"]);
  expect(numbers("'open 5\n6")).toEqual(["6"]);
  expect(numbers('"""open 5\n6')).toEqual([]);
  expect(numbers("# it's 5\n6")).toEqual(["6"]);
  expect(numbers(".5 + 5. + 1.5E+6 + 1.e5")).toEqual([".5", "5.", "1.5E+6", "1.e5"]);
});

test("text that only looks like a number is ignored", () => {
  expect(numbers("0x1F + 0o7 + 0b1 + 12abc + 1_000 + 5j + 1e + 2.append + 1..2")).toEqual([]);
  expect(numbers("半径2 = 3")).toEqual(["3"]);
});

test("a minus is the sign of a number if there is no operand before it", () => {
  expect(numbers("-1")).toEqual(["-1"]);
  expect(numbers("a = -1")).toEqual(["-1"]);
  expect(numbers("f(-1, -2, [-3], k=-4)")).toEqual(["-1", "-2", "-3", "-4"]);
  expect(numbers("a-1, 2-3, (a)-4, a[0]-5, 'x'-6")).toEqual(["1", "2", "3", "4", "0", "5", "6"]);
  expect(numbers("a*-1 + b--2")).toEqual(["-1", "-2"]);
  expect(numbers("return-1\nnot -2 if -3 else-4")).toEqual(["-1", "-2", "-3", "-4"]);
  expect(numbers("- 1")).toEqual(["1"]);
  // The end of a line ends a statement, but not within brackets, and not after a backslash.
  expect(numbers("a\n-1")).toEqual(["-1"]);
  expect(numbers("(a\n-1)")).toEqual(["1"]);
  expect(numbers("a \\\n-1")).toEqual(["1"]);
  expect(numbers("(a # (\n-1)\n-2")).toEqual(["1", "-2"]);
});

test("the number at a place contains it or ends there", () => {
  const text = "box(2, -13)";
  const result = numbersOf(text);
  const at = (place: number) => (numberAt(result, place) ? text.slice(numberAt(result, place)!.from, numberAt(result, place)!.to) : null);
  expect([3, 4, 5, 6, 7, 9, 10, 11].map(at)).toEqual([null, "2", "2", null, "-13", "-13", "-13", null]);
});

test("a step changes the last digit as written", () => {
  for (const [literal, tenths, after] of [
    ["5", 10, "6"],
    ["5", -10, "4"],
    ["9", 10, "10"],
    ["0", -10, "-1"],
    ["-1", 10, "0"],
    ["0.25", 10, "0.26"],
    ["0.29", 10, "0.30"],
    ["0.30", -300, "0.00"],
    ["0.30", -310, "-0.01"],
    ["-0.01", 20, "0.01"],
    [".5", 10, ".6"],
    [".9", 10, "1.0"],
    [".1", -20, "-.1"],
    ["5.", 10, "6."],
    ["1e-3", 10, "2e-3"],
    ["1.5E6", -10, "1.4E6"],
    ["9e2", 10, "10e2"],
    // With Shift ten times as much, with Alt a tenth.
    ["5", 100, "15"],
    ["5", 1, "5.1"],
    ["5", 11, "6.1"],
    ["0.25", -1, "0.249"],
    ["5.", 1, "5.1"],
    ["123456789012345678901234567890.1", 10, "123456789012345678901234567890.2"],
  ] as const) {
    expect(stepped(literal, tenths), `${literal} by ${tenths}`).toBe(after);
  }
});

test("steps back and forth restore the text", () => {
  for (const literal of ["5", "0.250", "-7.5", "1e-3", "5.", "0"]) {
    for (const tenths of [1, 7, 10, 100, 1230]) expect(stepped(stepped(literal, 10 * tenths), -10 * tenths)).toBe(literal);
  }
});

test("the value of a step is the difference that it makes", () => {
  expect(["5", "0.25", "-3.0", "1e-3", "1.5E6", ".5", "5."].map(stepOf)).toEqual([1, 0.01, 0.1, 1e-3, 1e5, 0.1, 1]);
});

test("a value is written with the previous decimals, and without rounding noise", () => {
  expect(rewritten("0.40", 0.5)).toBe("0.50");
  expect(rewritten("2", 0.1 + 0.2)).toBe("0.3");
  expect(rewritten("2", 3)).toBe("3");
  expect(rewritten("2.", 3)).toBe("3.");
  expect(rewritten("1e-3", 0.002)).toBe("0.002");
  expect(rewritten("0.1", 1e-9)).toBe("1e-9");
  expect(rewritten("0.5", -1.25)).toBe("-1.25");
});

test("removing a sign does not join the number to a word", () => {
  const text = "return-1";
  expect(fitting(text, { from: 6, to: 8 }, "2")).toBe(" 2");
  expect(fitting(text, { from: 6, to: 8 }, "-2")).toBe("-2");
  expect(fitting("f(-1)", { from: 2, to: 4 }, "2")).toBe("2");
});

test("tokens do not overlap, in any text", () => {
  // Random texts of such pieces, chosen by a linear congruence (Numerical Recipes, 2nd ed., section 7.1).
  const pieces = ["'", '"', '"""', "\\", "\n", "#", "-", "1", ".", "e", "x", "(", ")", " ", "é", "=", "param"];
  let seed = 12;
  const next = () => (seed = (seed * 1664525 + 1013904223) % 2 ** 32) / 2 ** 32;
  for (let turn = 0; turn < 2000; turn += 1) {
    const text = Array.from({ length: 12 }, () => pieces[Math.floor(next() * pieces.length)]!).join("");
    const all = tokens(text);
    all.forEach((token, k) => expect(token.from >= (all[k - 1]?.to ?? 0) && token.to > token.from && token.to <= text.length, text).toBe(true));
    for (const { from, to } of numbersOf(text)) expect(Number.isFinite(Number(text.slice(from, to))), text).toBe(true);
    paramsOf(text);
  }
});

test("parameters are found with their variables, labels and defaults", () => {
  const text = 'r = param("radius", 0.40)\nn = int(param(\'n\', 7))\nbox(param("w", -2), 1, 1)\n';
  const result = paramsOf(text);
  expect(result.map(({ name, label, value, step }) => [name, label, value, step])).toEqual([
    ["r", "radius", 0.4, 0.01],
    ["n", "n", 7, 1],
    [null, "w", -2, 1],
  ]);
  expect(result.map(({ from, to }) => text.slice(from, to))).toEqual(["0.40", "7", "-2"]);
});

test("a default in parentheses is a number, an expression is not", () => {
  const labels = (text: string) => paramsOf(text).map(({ name, label, value }) => [name, label, value]);
  expect(labels('a = ((param("a", ((-1.5)))))')).toEqual([["a", "a", -1.5]]);
  expect(labels('a = f(g(param("a", 1,)))')).toEqual([["a", "a", 1]]);
  expect(labels('a = param("半径_1", 2)\nb = param("größe", 1)\nc = param("a-b", 1)')).toEqual([
    ["a", "半径_1", 2],
    ["b", "größe", 1],
  ]);
  expect(labels('a = param("a", 2 * 3)\nb = param("b", w)\nc = param("c", (1) + 2)\nd = param("d", - 1)')).toEqual([]);
  expect(labels('a = 2 * param("a", 1)\nb = param("b", 1) + param("c", 2)')).toEqual([
    [null, "a", 1],
    [null, "b", 1],
    [null, "c", 2],
  ]);
  expect(labels('if wide: a = param("a", 1); b = param("b", 2)')).toEqual([
    ["a", "a", 1],
    ["b", "b", 2],
  ]);
});

test("only calls of param are parameters", () => {
  expect(paramsOf('# r = param("r", 1)\ns = "param(\'q\', 2)"\nparams("a", 1)\nx.param("b", 2)\ndef param(a, b): pass\nparam(name, 1)\nparam("no spaces", 1)')).toEqual([]);
  expect(paramsOf('param("r", 1')).toEqual([]);
  expect(paramsOf('a = param( # the radius\n  "a", # of it\n  3)\n').map(({ name, value }) => [name, value])).toEqual([["a", 3]]);
});

test("setting a parameter changes all of its defaults and nothing else", () => {
  expect(withParam('r = param("r", 0.40)\nbox(param("r", 0.4), 1, 1) # param("r", 0.4)\n', "r", 0.5)).toBe(
    'r = param("r", 0.50)\nbox(param("r", 0.5), 1, 1) # param("r", 0.4)\n',
  );
  expect(withParam('param("r", -1)', "r", 2)).toBe('param("r", 2)');
  expect(withParam('param("r", 1)', "q", 2)).toBe('param("r", 1)');
  expect(withParam('param("r", 1)', "r", Number.NaN)).toBe('param("r", 1)');
});

test("the parameters of the examples are found", () => {
  expect(paramsOf(example("gear")).map(({ name, label, value }) => [name, label, value])).toEqual(
    [...example("gear").matchAll(/^(\w+) = (?:int\()?param\("(\w+)", (-?[\d.]+)\)\)?/gm)].map((m) => [m[1], m[2], Number(m[3])]),
  );
  expect(paramsOf(example("gear")).length).toBeGreaterThan(2);
});

test("every function and every degree of exactness has a Chinese text", () => {
  const source = (path: string) => readFileSync(new URL(`../../../${path}`, import.meta.url), "utf8");
  // A test of chordal-script checks that the page has every function of the table.
  const rows = [...source("docs/shape-scripts.md").matchAll(/^\| `(\w+)\((.*?)\)` \|(.*)\|$/gm)];
  const names = rows.map((row) => row[1]!);
  const builtIns = source("crates/chordal-script/src/words.rs").split("#[cfg(test)]")[0]!;
  names.push(...[...builtIns.matchAll(/(?:plain\(\s*|name: )"(\w+)"/g)].map((match) => match[1]!));
  expect([...new Set(names)].sort()).toEqual(Object.keys(SENTENCES).sort());
  expect(names.length).toBeGreaterThan(90);
  const rust = ["solids", "sweep", "combine", "transforms", "materials", "formula"].map((name) => source(`crates/chordal-script/src/language/${name}.rs`)).join("\n") + builtIns;
  const worths = [...rust.matchAll(/(?:distance: |const \w+: &str = )"([^"]+)"/g)].map((match) => match[1]!);
  expect([...new Set(worths)].sort()).toEqual(Object.keys(WORTHS).sort());
  for (const text of [...Object.values(SENTENCES), ...Object.values(WORTHS)]) expect(text).toMatch(/\p{Script=Han}/u);
  for (const text of Object.values(SENTENCES)) expect(text).toMatch(/。$/);
  const table = [{ name: "sphere", usage: "sphere(radius)", doc: "A ball.", worth: "exact distance" }, { name: "mine", usage: "mine()", doc: "Mine." }];
  expect(inChinese(table)).toEqual([{ ...table[0], doc: SENTENCES["sphere"], worth: "精确" }, table[1]]);
});

const row = (usage: string) => ({ name: usage.split("(")[0]!, usage, doc: "." });
const rows = new Map(["box(x, y, z)", "union(*shapes, fillet=0, chamfer=0)", "polygon(points, tolerance=None)", "pi_of()"].map((usage) => [row(usage).name, row(usage)]));

/** The call at the bar in a text: its function and parameter. */
function called(marked: string): [string, number] | null {
  const place = marked.indexOf("|");
  const text = marked.replace("|", "");
  const result = callAt(text, tokens(text), place, rows);
  return result && [result.row.name, result.parameter];
}

test("the call around the cursor is the innermost known one, with its current parameter", () => {
  expect(called("box(|)")).toEqual(["box", 0]);
  expect(called("box(1, 2|, 3)")).toEqual(["box", 1]);
  expect(called("box(1, 2, |")).toEqual(["box", 2]);
  expect(called("box(1, 2, 3, |")).toEqual(["box", -1]);
  expect(called("box(1, z=|2)")).toEqual(["box", 2]);
  expect(called("box(1, q=|2)")).toEqual(["box", -1]);
  expect(called("union(a, b, |c)")).toEqual(["union", 0]);
  expect(called("union(a, fillet=1, chamfer=|2)")).toEqual(["union", 2]);
  expect(called("union(a, box(1, |2, 3))")).toEqual(["box", 1]);
  expect(called("union(a, box(1, 2, 3)|)")).toEqual(["union", 0]);
  expect(called("polygon([[0, 0], [1, |0]])")).toEqual(["polygon", 0]);
  expect(called("polygon(own(1, 2, |3), 2)")).toEqual(["polygon", 0]);
  expect(called("box(1, # (, \n|2)")).toEqual(["box", 1]);
  expect(called('box("(", |2)')).toEqual(["box", 1]);
  expect(called("box|(1)")).toBeNull();
  expect(called("box(1)|")).toBeNull();
});

test("the function at the cursor is the one whose name it touches", () => {
  const named = (marked: string) => {
    const text = marked.replace("|", "");
    return functionAt(text, tokens(text), marked.indexOf("|"), rows)?.row.name;
  };
  expect(["|box(1)", "b|ox(1)", "box|(1)", "union(|box", "a+box|"].map(named)).toEqual(["box", "box", "box", "box", "box"]);
  expect(["box(|1)", "boxes|", "'box|'", "# box|", "|"].map(named)).toEqual([undefined, undefined, undefined, undefined, undefined]);
});

test("parameters are read from a usage", () => {
  expect(parametersOf(row("union(*shapes, fillet=0, chamfer=0)")).map(parameterName)).toEqual(["shapes", "fillet", "chamfer"]);
  expect(parametersOf(row("pi_of()"))).toEqual([]);
});

test("the difference of two texts is a single range", () => {
  for (const [before, after] of [
    ["", "a"],
    ["a", ""],
    ["aa", "aaa"],
    ["aba", "a"],
    ["box(1, 1)", "box(1, 2)"],
    ["same", "other"],
  ] as const) {
    const { from, to, insert } = difference(before, after)!;
    expect(before.slice(0, from) + insert + before.slice(to)).toBe(after);
  }
  expect(difference("box(1, 1, 1)", "box(1, 25, 1)")).toEqual({ from: 7, to: 8, insert: "25" });
  expect(difference("a", "a")).toBeNull();
});

test("an error is at a word, a sign, the line, or at the start of a line without text", () => {
  const doc = Text.of(["a = 1", "  é𝒳 = box(1, a)  ", ""]);
  const at = (line: number, column?: number) => {
    const { from, to } = problemAt(doc, { line, message: "", ...(column === undefined ? {} : { column }) });
    return from === to ? from : doc.sliceString(from, to);
  };
  // Columns count code points: 𝒳 is one of them, and two units of UTF-16.
  expect([at(2, 8), at(2, 11), at(2, 12), at(2, 4), at(2)]).toEqual(["box", "(", "1", "𝒳", "é𝒳 = box(1, a)"]);
  expect([at(1, 6), at(2, 99), at(3), at(3, 1), at(99, 1), at(0, 1)]).toEqual([0, 6, 26, 26, 26, "a"]);
});
