// The command's sentences in Chinese: everything that it can say about a mesh has a translation, in the exhibit's words.
import { readFileSync, readdirSync } from "node:fs";
import { beforeAll, describe, expect, test, vi } from "vitest";
import { DOCTOR } from "../../src/exhibits/doctor_texts";
import { run } from "../../src/core/command";
import {
  ADVICE,
  CURES,
  CURES_EN,
  MEANINGS,
  NAMES,
  STAGES,
  adviceIn,
  assumptionIn,
  cureIn,
  faultIn,
  joining,
  loadSentences,
  meaningIn,
  nameIn,
  stageIn,
} from "../../src/workbench/command_zh";
import { ERRORS } from "../../src/workbench/errors_zh";
import { faultOf } from "../../src/workbench/outcome";
import type { FindingFacts, Report } from "../../src/workbench/report";

// The tests' module is half as fast as that of the pages.
vi.setConfig({ testTimeout: 120_000, hookTimeout: 60_000 });

const PROJECT = new URL("../../../", import.meta.url).pathname;
const source = (path: string) => readFileSync(PROJECT + path, "utf8");
const isChinese = ({ text, lang }: { text: string; lang?: string }) => lang === undefined && /\p{Script=Han}/u.test(text);

describe("every sentence of the command", () => {
  /** The texts of a function of `Defect`, whose source is one table. */
  const wordsOf = (name: string) => {
    const one = new RegExp(`pub fn ${name}\\(self\\)[^{]*\\{([^]*?)\\n    \\}`);
    const [, body] = one.exec(source("crates/chordal/src/check/defect.rs"))!;
    return [...body!.matchAll(/"([^"]+)"/g)].map((match) => match[1]!);
  };

  test("about a defect has a translation", () => {
    const names = wordsOf("name");
    expect(names.length).toBe(13);
    expect(Object.keys(NAMES).sort()).toEqual(names.sort());
    // Besides the meaning of each defect, what the report adds by a code of its own.
    const facts = source("crates/chordal-verbs/src/report/findings.rs");
    const codes = [...facts.matchAll(/(?:code: |plain\(|Some\(\()"([^"]+)"/g)].map((match) => match[1]!);
    expect(codes.sort()).toEqual(["filling-may-cross", "nearly-joined", "open-sheet", "split-and-keep-apart"]);
    expect(Object.keys(MEANINGS).sort()).toEqual([...names, "filling-may-cross", "nearly-joined"].sort());
    const advised = Object.keys(ADVICE).filter((code) => !names.includes(code));
    expect(advised.sort()).toEqual(["open-sheet", "split-and-keep-apart"]);
    for (const of of names) {
      expect(isChinese(meaningIn("zh", { means: "x", sentences: [{ code: of }] })), of).toBe(true);
      expect(isChinese(adviceIn("zh", { of, advice: "x", advice_code: of })!), of).toBe(true);
    }
  });

  test("about an error has a translation by its code", () => {
    const crates = ["chordal-io", "chordal-verbs", "chordal-script", "chordal-cli"];
    const codes = new Set<string>();
    for (const crate of crates) {
      const folder = `${PROJECT}crates/${crate}/src/`;
      for (const name of readdirSync(folder, { recursive: true, encoding: "utf8" }).filter((name) => name.endsWith(".rs"))) {
        const text = readFileSync(folder + name, "utf8").split("#[cfg(test)]")[0]!;
        const made = /(?:ReadError::new|\.error|error_at|Fault::\w+|ScriptError::new|translate_error|\berror)\(\s*(?:Exit::\w+,\s*)?"([a-z0-9]+(?:-[a-z0-9]+)*)"/g;
        for (const match of text.matchAll(made)) codes.add(match[1]!);
      }
    }
    const refusals = /fn as_str\(self\)[^]*?\n    \}/.exec(source("crates/chordal/src/budget/bounded.rs"))![0];
    const failures = /pub fn code\(&self\)[^]*?\n    \}/.exec(source("crates/chordal-verbs/src/failure.rs"))![0];
    for (const match of (refusals + failures).matchAll(/=> "([^"]+)"/g)) codes.add(match[1]!);
    expect(codes.size).toBeGreaterThan(150);
    expect([...codes].filter((code) => !(code in ERRORS)).sort()).toEqual([]);
    expect(Object.entries(ERRORS).filter(([, text]) => !/\p{Script=Han}.*。$/u.test(text))).toEqual([]);
    const stdout = JSON.stringify({ error: { code: "script-value", exit: 3, messages: ["a.star: line 3, column 2: it hums"] } });
    expect(faultOf({ exit: 3, stdout, stderr: "", outputs: {} })).toEqual({ text: "it hums", line: 3, column: 2, code: "script-value" });
  });

  test("about an assumption of a proof has a translation", () => {
    const made = [
      "values of the interpolant between samples are taken as rounded to f64",
      "no part of the outlines and no gap in them appears or vanishes in the polygons that replace them",
      "the mesh is not closed, and points whose winding number is above a half count as inside",
      "what is farther from a shape than the bound of its triangles is on the same side of both",
      "no region on the wrong side was missed by the 12 points whose winding numbers were compared",
      "a shape whose distance was computed anew is replaced by triangles, which are up to 1e-2 away from it",
      "the computed signs of the field are right at 12 samples where rounding could change them",
      "along the triangles of a mesh that is open or crosses itself, nothing is thinner than 1.0e-2: no film, gap or bump lies between the samples (3 places could have one)",
      "the field has no interior points outside the box from [-1.0, 0.0, 0.0] to [1.0, 2.0, 3.0]",
      "the sign expression has the sign of the field's value everywhere",
      "a displacement takes off no more than its amplitude, 0.5",
      "an outline that crosses itself is cut at its crossings, which moves it by at most 1.2e-9",
    ];
    for (const sentence of made) expect(isChinese(assumptionIn("zh", sentence)), sentence).toBe(true);
    expect(assumptionIn("zh", made[4]!).text).toContain("12");
    // Sentences of the crates, up to their first value, and as many as the crates make.
    const isMade = /ProvedIf\(vec!|\.promise\((?!sentence\))|\.standing_for\(/;
    const all = ["chordal", "chordal-verbs"].flatMap((crate) => {
      const folder = `${PROJECT}crates/${crate}/src/`;
      const names = readdirSync(folder, { recursive: true, encoding: "utf8" }).filter((name) => name.endsWith(".rs"));
      return names.map((name) => readFileSync(folder + name, "utf8").split("#[cfg(test)]")[0]!).filter((text) => isMade.test(text));
    });
    const text = all.join("\n").replace(/\\\n\s*/g, "");
    for (const sentence of made) expect(text, sentence).toContain(sentence.split(/ [[\d]/)[0]!);
    expect(text.match(new RegExp(isMade, "g"))!.length, "another assumption is made, which wants its Chinese here").toBe(made.length);
  });

  test("about a repair has a translation", () => {
    const { $defs } = JSON.parse(source("docs/schema/report.schema.json"));
    expect(Object.keys(CURES).sort()).toEqual([...$defs.finding.properties.cures.items.enum].sort());
  });

  test("about a stage of its progress has a translation", () => {
    const folder = `${PROJECT}crates/chordal/src/`;
    const files = readdirSync(folder, { recursive: true, encoding: "utf8" }).filter((name) => name.endsWith(".rs"));
    const stages = files.flatMap((name) => [...readFileSync(folder + name, "utf8").matchAll(/(?:stage: |\breport\()"([^"]+)"/g)]);
    expect(Object.keys(STAGES)).toEqual([...new Set(stages.map((match) => match[1]!))].sort());
  });

  test("uses the words of the exhibit about defective meshes", () => {
    const { defects, cures } = DOCTOR.zh;
    expect(NAMES).toEqual(Object.fromEntries(Object.entries(defects).map(([of, [name]]) => [of, name])));
    expect(CURES).toEqual(Object.fromEntries(Object.entries(cures).map(([cure, words]) => [`--${cure}`, words])));
  });

  test("without a translation stays as it is, marked as English", () => {
    expect(meaningIn("zh", { means: "it hums", sentences: [{ code: "hums" }] })).toEqual({ text: "it hums", lang: "en" });
    expect(meaningIn("zh", { means: "it hums", sentences: [{ code: "unused_vertices" }, { code: "hums" }] })).toMatchObject({ lang: "en" });
    expect(adviceIn("zh", { of: "x", advice: "hum", advice_code: "y" })).toEqual({ text: "hum", lang: "en" });
    expect(assumptionIn("zh", "it hums")).toEqual({ text: "it hums", lang: "en" });
    expect(nameIn("zh", { of: "hums", words: "hums" })).toEqual({ text: "hums", lang: "en" });
    expect(stageIn("zh", "hum")).toEqual({ text: "hum", lang: "en" });
    expect(meaningIn("en", { means: "it hums", sentences: [] })).toEqual({ text: "it hums" });
    expect(cureIn("zh", "--hum")).toBe("--hum");
    expect(isChinese(stageIn("zh", Object.keys(STAGES)[0]!))).toBe(true);
  });
});

/** Files with all kinds of defects, and with remarks. */
const SICK: Record<string, string> = {
  "hole.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 5 5 5\nf 1 3 2\nf 1 2 4\nf 2 3 4\n",
  "seam.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1.0000001 0 0\nv 1 1 0\nv 0 1.0000001 0\nf 1 2 3\nf 4 5 6\n",
  "fans.obj":
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv .3 -.5 -1\nv .3 -.5 1\nv .3 .5 0\n" +
    "f 1 2 3\nf 2 1 4\nf 1 2 5\nf 6 7 8\nf 1 2 3\nf 1 1 3\n",
  "inside_out.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n",
  "crack.obj": "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 1 0 0\nv 1 -1 0\nf 1 2 3\nf 1 5 4\nf 4 5 2\n",
  "soup.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 4 5 6\n",
  "flat.obj": "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1e-3 0\nf 1 2 3\nf 1 3 4\n",
  "branch.stl": facets("0 0 0 1 0 0 0 1 0", "1 0 0 0 0 0 0 -1 0", "0 0 0 1 0 0 0 0 1"),
};

function facets(...rows: string[]): string {
  const vertices = (row: string) => row.match(/\S+ \S+ \S+/g)!.map((at) => `vertex ${at}`).join("\n");
  const all = rows.map((row) => `facet normal 0 0 0\nouter loop\n${vertices(row)}\nendloop\nendfacet\n`);
  return `solid x\n${all.join("")}endsolid x\n`;
}

/** Scripts with the mistakes that beginners make. */
const WRONG = [
  "sphere(", "sphere(1))", "a = [1, 2\nsphere(1)", "if True:\nsphere(1)", "  sphere(1)", "for i in range(3)\n    sphere(1)", "sphere(1) sphere(2)", 'sphere("1)', "import math",
  "while True:\n    pass", "sphere（1）", "a = 1\n\tb = 2", "1/0", "spere(1)", "cube(1)", "sphere()", "box(1)", "box(1, 2, 3, 4)", "box(1, 2, 3, w=3)", 'box("a", 2, 3)', "sphere(-1)",
  "polygon([[0, 0], [1, 1]])", "extrude(circle(1), -1)", 'color(sphere(1), "grün")', "union()", "sphere(1) + box(1, 1, 1)", "sphere(1) * 2", 'mesh("none.stl")', "a = 1", "x + y", "3",
  "def f():\n    sphere(1)\nf()", "for i in range(3):\n    sphere(i)", "def f(a):\n    return a\nf()", "[1, 2][5]", "sphere(2 ** 3)", "sphere(1).x", "y = y + 1",
];

test("faults of scripts are completely in Chinese", async () => {
  await loadSentences();
  const module = await WebAssembly.compile(readFileSync(new URL("../../wasm/command.wasm", import.meta.url)));
  const english: string[] = [];
  for (const script of WRONG) {
    const outcome = await run(module, ["inspect", "a.star", "--json"], { "a.star": new TextEncoder().encode(script) });
    expect(outcome.exit, script).not.toBe(0);
    const said = faultIn("zh", faultOf(outcome));
    // Two words of English in a row are no name of the language and no call.
    if (!isChinese(said) || / [a-z]{2,} [a-z]{2,} /.test(said.text)) english.push(`${script}: ${said.text}`);
  }
  expect(english).toEqual([]);
});

describe("findings of files", () => {
  let findings: FindingFacts[];
  beforeAll(async () => {
    const module = await WebAssembly.compile(readFileSync(new URL("../../wasm/command.wasm", import.meta.url)));
    findings = [];
    for (const [name, text] of Object.entries(SICK)) {
      const file = { [name]: new TextEncoder().encode(text) };
      const outcome = await run(module, ["inspect", name, "--self-intersections", "--json"], file);
      findings.push(...((JSON.parse(outcome.stdout) as Report).inspection?.findings ?? []));
    }
  });

  test("are completely in Chinese", () => {
    const english = findings.flatMap((finding) => {
      const { cures } = finding;
      const advice = adviceIn("zh", finding);
      const said = [nameIn("zh", finding), meaningIn("zh", finding), ...(advice ? [advice] : [])];
      const unsaid = said.filter((words) => !isChinese(words)).map(({ text }) => text);
      return [...unsaid, ...cures.filter((cure) => cureIn("zh", cure) === cure)];
    });
    expect(english).toEqual([]);
    const kinds = new Set(findings.map(({ of }) => of));
    expect(Object.keys(NAMES).filter((of) => !kinds.has(of))).toEqual([]);
    // The files must lead to remarks after a meaning, too.
    const said = findings.flatMap(({ means, advice }) => [means, advice ?? ""]).join("\n");
    const besides = ["the filling may cross", "which `mend --weld=", "an open sheet", "ties equal positions"];
    expect(besides.filter((words) => !said.includes(words))).toEqual([]);
  });

  test("contain no options of the command, except where the reader types them", () => {
    expect(Object.keys(CURES_EN)).toEqual(Object.keys(CURES));
    const said = (["en", "zh"] as const).flatMap((language) =>
      findings.flatMap((finding) => [
        meaningIn(language, finding).text,
        ...[...finding.cures, ...joining(finding.sentences)].map((option) => cureIn(language, option)),
      ]),
    );
    expect(said.filter((words) => words.includes("--"))).toEqual([]);
  });

  test("contain the command's number, and have its repair", () => {
    const seam = findings.find(({ means }) => means.includes("--weld="))!;
    expect(joining(seam.sentences)).toEqual(["--weld=1.1e-7"]);
    expect(cureIn("en", "--weld=1.1e-7")).toBe("weld vertices within 1.1e-7");
    expect(meaningIn("zh", seam).text).toBe(
      "曲面到此为止，因此没有内部。其中 4 个边界顶点与别的顶点相距不超过 1.1e-7，焊接可使其相连。",
    );
  });
});
