// The command's sentences in Chinese: everything that it can say about a mesh has a translation, in the exhibit's words.
import { readFileSync, readdirSync } from "node:fs";
import { beforeAll, describe, expect, test, vi } from "vitest";
import { DOCTOR } from "../../src/exhibits/doctor_texts";
import { run } from "../../src/workbench/command";
import { CURES, CURES_EN, NAMES, STAGES, cureIn, joining, nameIn, sentenceIn, stageIn } from "../../src/workbench/command_zh";
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
    const sentences = [...wordsOf("meaning"), ...wordsOf("advice")];
    expect(sentences.length).toBe(19);
    expect(sentences.filter((words) => !isChinese(sentenceIn("zh", words)))).toEqual([]);
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
    expect(sentenceIn("zh", "it hums")).toEqual({ text: "it hums", lang: "en" });
    expect(sentenceIn("zh", "no triangle has a corner there; it hums")).toMatchObject({ lang: "en" });
    expect(nameIn("zh", { of: "hums", words: "hums" })).toEqual({ text: "hums", lang: "en" });
    expect(stageIn("zh", "hum")).toEqual({ text: "hum", lang: "en" });
    expect(sentenceIn("en", "it hums")).toEqual({ text: "it hums" });
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
      const { means, advice, cures } = finding;
      const said = [nameIn("zh", finding), sentenceIn("zh", means), ...(advice ? [sentenceIn("zh", advice)] : [])];
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
      findings.flatMap(({ means, cures }) => [
        sentenceIn(language, means).text,
        ...[...cures, ...joining(means)].map((option) => cureIn(language, option)),
      ]),
    );
    expect(said.filter((words) => words.includes("--"))).toEqual([]);
  });

  test("contain the command's number, and have its repair", () => {
    const seam = findings.find(({ means }) => means.includes("--weld="))!;
    expect(joining(seam.means)).toEqual(["--weld=1.1e-7"]);
    expect(cureIn("en", "--weld=1.1e-7")).toBe("weld vertices within 1.1e-7");
    expect(sentenceIn("zh", seam.means).text).toBe(
      "曲面到此为止，因此没有内部。其中 4 个边界顶点与别的顶点相距不超过 1.1e-7，焊接可使其相连。",
    );
  });
});
