// The lesson's structure is the same in each language, its handles fit its figures, and its code runs.
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import * as three from "three";
import { beforeAll, describe, expect, test } from "vitest";
import { Core } from "../../src/core/module";
import type { AnyExhibit } from "../../src/exhibits/exhibit";
import { EXHIBITS } from "../../src/exhibits/index";
import { read, write } from "../../src/exhibits/fragment";
import { TO_PLANE } from "../../src/exhibits/spout";
import { factsOf } from "../../src/lesson/facts";
import { hasPage, loaded } from "../../src/lesson/figures";
import { LESSONS } from "../../src/lesson/languages";
import { BLOCKS, blocksOf, QUESTIONS, SECTIONS, STATIONS, TERMS } from "../../src/lesson/outline";
import { COMPONENTS } from "../../src/lesson/own/stations";
import { OWN_TEXTS } from "../../src/lesson/own/texts";
import { lessons } from "../../src/lesson/prerender";
import { DISTANCES, levelAt } from "../../src/lesson/Hero";
import { levelsOf, ROUNDED, unpacked } from "../../src/lesson/teapot_levels";

const ROOT = join(import.meta.dirname, "../..");
const CODE = join(ROOT, "src/lesson/code");
let written: Awaited<ReturnType<typeof lessons>>;
let core: Core;
const figures = new Map<string, AnyExhibit>();

beforeAll(async () => {
  core = await Core.load(readFileSync(join(ROOT, "wasm/exhibits.wasm")));
  written = await lessons(core);
  for (const { figure } of BLOCKS) if (figure) figures.set(figure, await loaded(figure));
  // All figures at once, by the module of the tests, on a machine that others use.
}, 180_000);

/** Each value of an attribute. */
const values = (html: string, name: string) => [...html.matchAll(new RegExp(`${name}="([^"]*)"`, "g"))].map((match) => match[1]!);
const json = (text: string) => JSON.parse(text.replaceAll("&quot;", '"').replaceAll("&amp;", "&")) as Record<string, unknown>;

test("ids are used once, and blocks with a guess have a figure or a table", () => {
  const ids = BLOCKS.map(({ id }) => id);
  expect(new Set(ids).size).toBe(ids.length);
  expect(BLOCKS.filter(({ guess }) => guess).length).toBeGreaterThanOrEqual(6);
  for (const block of BLOCKS) if (block.guess) expect(block.figure, block.id).toBeDefined();
});

test("the tour has the exhibits of the lesson in its order and its parts, and then the questions, which it asks itself", () => {
  const shown = SECTIONS.flatMap((section, part) => blocksOf(section).map(({ figure }) => [figure, part] as const)).filter(([figure]) => figure && hasPage(figure));
  expect(EXHIBITS.map(({ id, part }) => [id, part])).toEqual([...shown, ["questions", 5]]);
});

describe.each(Object.keys(LESSONS))("%s", (language) => {
  const page = () => written.pages.find(({ file }) => file === (language === "en" ? "lesson.html" : `lesson.${language}.html`))!.body;

  test("has every section, block, figure, guess, term and question", () => {
    const html = page();
    for (const { id } of SECTIONS) expect(html, id).toContain(`<section id="${id}"`);
    expect(values(html, "id").filter((id) => id.startsWith("block-"))).toEqual(BLOCKS.map(({ id }) => `block-${id}`));
    expect(values(html, "data-figure-of")).toEqual([...figures.keys()]);
    expect(values(html, "data-guess")).toEqual(BLOCKS.filter(({ guess }) => guess).map(({ id }) => id));
    expect(values(html, "data-card")).toEqual([...QUESTIONS]);
    expect(values(html, "id").filter((id) => id.startsWith("term-"))).toEqual(TERMS.map((id) => `term-${id}`));
  });

  test("has every station of a shape of the reader's own, empty, below its block", () => {
    const html = page();
    expect(values(html, "data-own")).toEqual(STATIONS.map(({ id }) => id));
    for (const { id, at } of STATIONS) {
      const block = html.indexOf(at === "ending" ? '<section id="ending"' : `id="block-${at}"`);
      const place = html.indexOf(`<section class="own" id="own-${id}"`);
      expect(html.slice(place)).toMatch(/^<section [^>]*hidden[^>]*><\/section>/);
      expect(block, id).toBeGreaterThan(0);
      expect(block, id).toBeLessThan(place);
      expect(html.slice(block, place), id).not.toContain(' id="block-');
    }
    const { stations } = OWN_TEXTS[language as keyof typeof OWN_TEXTS];
    expect(Object.keys(stations)).toEqual(Object.keys(COMPONENTS));
    expect(Object.keys(stations)).toEqual(STATIONS.map(({ id }) => id));
  });

  test("explains each term where it is first used, in the order of the list", () => {
    const used = values(page(), "id").filter((id) => id.startsWith("use-"));
    expect(used).toEqual(TERMS.map((id) => `use-${id}`));
  });

  test("has no id twice, no link to nowhere in the page, and no empty number", () => {
    const html = page();
    const ids = values(html, "id");
    expect(ids.filter((id, i) => ids.indexOf(id) !== i)).toEqual([]);
    const links = values(html, "href").filter((link) => link.startsWith("#"));
    expect(links.length).toBeGreaterThan(TERMS.length);
    for (const link of links) expect(ids, link).toContain(link.slice(1));
    expect(html).not.toMatch(/undefined|NaN|\[object/);
  });

  test("has handles and settings that its figures know", () => {
    const html = page();
    const handles = [...html.matchAll(/data-handle="(\w+)" data-field="(\w+)" data-value="([^"]+)"/g)];
    expect(handles.length).toBeGreaterThanOrEqual(8);
    for (const [, figure, field, value] of handles) {
      const { state } = BLOCKS.find((block) => block.figure === figure)!;
      const first = { ...(figures.get(figure!)!.defaults as Record<string, unknown>), ...state }[field!];
      expect(Number(value), `${figure}.${field}`).toBe(first);
    }
    const settings = [...html.matchAll(/data-set="(\w+)" data-to="([^"]+)"/g)];
    expect(settings.length).toBeGreaterThan(3);
    for (const [, figure, to] of settings)
      expect(Object.keys(figures.get(figure!)!.defaults), `${figure}`).toEqual(expect.arrayContaining(Object.keys(json(to!))));
    for (const block of BLOCKS)
      if (block.figure && block.state)
        expect(Object.keys(figures.get(block.figure)!.defaults), block.id).toEqual(expect.arrayContaining(Object.keys(block.state)));
  });
});

describe("the teapot that is carried through", () => {
  /** The half of the spout as the example's file has it. */
  const lines = readFileSync(join(ROOT, "../examples/teapot.bpt"), "utf8").trim().split("\n");
  const start = 1 + 17 * 16;
  const spout = lines.slice(start + 1, start + 17).map((line) => line.split(" ").map(Number));
  const side = [3, 7, 11, 15].map((row) => spout[row]!);
  const stateOf = (id: string) => {
    const { figure, state } = BLOCKS.find((block) => block.id === id)!;
    return { ...figures.get(figure!)!.defaults, ...state } as Record<string, unknown>;
  };
  /** Whether points are others, all enlarged by one number and moved by one vector. */
  const isPlaced = (points: readonly (readonly number[])[], from: readonly (readonly number[])[]) => {
    const size = (list: typeof from) => Math.hypot(...list[0]!.map((x, k) => x - list.at(-1)![k]!));
    const scale = size(points) / size(from);
    const off = points.flatMap((point, i) => point.map((x, k) => x - points[0]![k]! - scale * (from[i]![k]! - from[0]![k]!)));
    return points.length === from.length && off.every((x) => Math.abs(x) < 1e-9);
  };

  test("is placed by a map that other points are not", () => {
    expect(lines[start]).toBe("3 3");
    expect(isPlaced(spout, spout)).toBe(true);
    expect(isPlaced(spout.map((point, i) => (i === 5 ? [point[0]! + 0.01, ...point.slice(1)] : point)), spout)).toBe(false);
    expect(isPlaced(figures.get("patch")!.defaults.control, spout)).toBe(false);
  });

  test("lends its sixteen points to the patch, and a side of that to both curves, exactly", () => {
    expect(isPlaced(stateOf("patch")["control"] as number[][], spout)).toBe(true);
    const flat = side.map(([x, , z]) => [x!, z!]);
    const curves = ["bernstein", "segments"].map((id) => (figures.get(id)!.question(stateOf(id)) as { control: number[][] }).control);
    for (const curve of curves) expect(isPlaced(curve, flat)).toBe(true);
    // The core's own curve of the patch at that side is the same one.
    const { rails } = core.ask("exhibit", { exhibit: "patch", ...figures.get("patch")!.question(stateOf("patch")) } as never) as unknown as { rails: Float32Array[] };
    const ends = (rail: Float32Array) => [[...rail.slice(0, 3)], [...rail.slice(-3)]];
    const control = stateOf("patch")["control"] as number[][];
    expect(ends(rails[3]!)).toEqual([control[3]!, control[15]!].map((point) => point.map(Math.fround)));
  });

  test("cracks along the same curve, at the vertices that both halves have", () => {
    const { seams } = core.ask("exhibit", { exhibit: "cracks", ...figures.get("cracks")!.question(stateOf("cracks")) } as never) as unknown as { seams: Float32Array[] };
    const on = (t: number) => [0, 1, 2].map((k) => [(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t ** 3].reduce((sum, w, i) => sum + w * side[i]![k]!, 0));
    for (const seam of seams) {
      const count = seam.length / 3 - 1;
      expect(count).toBeGreaterThan(2);
      // Turned by a quarter, since the shared side of the figure is at x = 0; from the tip to the belly.
      const wanted = Array.from({ length: count + 1 }, (_, i) => on(1 - i / count)).map(([x, y, z]) => [y!, -x!, z!]);
      const found = Array.from({ length: count + 1 }, (_, i) => [...seam.subarray(3 * i, 3 * i + 3)]);
      const scale = (found[0]![2]! - found[count]![2]!) / (wanted[0]![2]! - wanted[count]![2]!);
      for (const [i, point] of found.entries()) for (const [k, x] of point.entries()) expect(x - found[0]![k]!, `${i} of ${count}`).toBeCloseTo(scale * (wanted[i]![k]! - wanted[0]![k]!), 5);
    }
  });

  test("is kept by an address: no point of it has more digits than that stores", () => {
    for (const id of ["patch", "bernstein"] as const) {
      const { defaults, parts } = figures.get(id)!;
      const { state, isDamaged } = read(write(stateOf(id), defaults, parts), defaults, parts);
      expect([state, isDamaged]).toEqual([stateOf(id), false]);
    }
  });

  test("is the curve in the code, too, in the file's own numbers", () => {
    const wanted = side.map(([x, , z]) => `${x}, ${z}`);
    for (const [name, pair] of [["segments.py", /\((\d[^()]*)\)/g], ["segments.js", /\[(\d[^[\]]*)\]/g]] as const)
      expect([...readFileSync(join(CODE, name), "utf8").matchAll(pair)].map((match) => match[1]).filter((found) => found!.includes(".")), name).toEqual(wanted);
    // What the code prints are the figure's pixels: a unit of the file has so many of them.
    const scale = Number(/(\d+) \* chain/.exec(readFileSync(join(CODE, "segments.py"), "utf8"))![1]);
    expect(scale).toBeCloseTo(TO_PLANE.scale * 60);
    expect(readFileSync(join(CODE, "patch.py"), "utf8")).toContain(`skiprows=${start + 1},`);
  });
});

test("words that are numbers are the core's", async () => {
  const facts = await factsOf((question) => core.ask("exhibit", question as never));
  // Eleven points; three triangles and holes; the option that is right.
  expect([facts.runge.points, facts.culling.holes]).toEqual([11, 3]);
  const { guess } = BLOCKS.find(({ id }) => id === "normals")!;
  expect(guess).toMatchObject({ right: String(facts.cube.hard) });
  expect(facts.levels.pixel.mountain / facts.levels.pixel.teapot).toBeGreaterThan(1000);
  // Near the square root of two on a curve, and two on a surface.
  const [least, most] = facts.budget.surfaces;
  expect(Math.abs(facts.budget.curve - Math.SQRT2)).toBeLessThan(0.1);
  expect([least > 1.7, most < 2.1, least <= most]).toEqual([true, true, true]);
});

test("takes a quarter of an hour to read, and half an hour with its figures", () => {
  const text = written.pages[0]!.body
    .slice(0, written.pages[0]!.body.indexOf('<section id="terms"'))
    // A figure may contain another one.
    .replace(/<figure class="placed".*?<\/figure>(?=<div class="code"|<\/article>)|<pre.*?<\/pre>|<svg.*?<\/svg>/gs, " ")
    .replace(/<[^>]+>/g, " ");
  const words = text.split(/\s+/).filter((word) => /\w/.test(word)).length;
  // Guesses, answers and cards included, at 238 words a minute (M. Brysbaert, 2019).
  expect(words / 238).toBeGreaterThan(10);
  expect(words / 238).toBeLessThan(15);
});

test("the teapot of the first picture is the core's, rounded by less than is added to its error", () => {
  const { bytes } = written.teapot;
  const levels = unpacked(bytes.buffer as ArrayBuffer);
  expect(levels[0]!.triangles).toBeGreaterThan(5000);
  const exact = levelsOf((question) => core.ask("exhibit", question) as never);
  for (const [i, { triangles, error, indices, positions }] of levels.entries()) {
    expect(indices).toEqual(exact[i]!.indices);
    const off = (k: number) => Math.hypot(...[0, 1, 2].map((axis) => positions[3 * k + axis]! - exact[i]!.positions[3 * k + axis]!));
    const far = Math.max(...Array.from({ length: positions.length / 3 }, (_, k) => off(k)));
    expect(far).toBeGreaterThan(0);
    expect(far).toBeLessThanOrEqual(ROUNDED * 1.0001);
    expect(indices.length).toBe(3 * triangles);
    if (i) {
      expect(triangles).toBeLessThan(levels[i - 1]!.triangles);
      expect(error).toBeGreaterThan(levels[i - 1]!.error);
    }
  }
});

test("the teapot of the first picture is off by at most half a pixel wherever it is", () => {
  const { bytes } = written.teapot;
  const levels = unpacked(bytes.buffer as ArrayBuffer);
  for (const distance of DISTANCES) expect(levelAt(levels, distance).from / distance, `from ${distance} m`).toBeLessThanOrEqual(0.5);
});

describe("code", () => {
  const names = [...new Set(readdirSync(CODE).map((name) => name.replace(/\.\w+$/, "")))];

  test("stands in both languages, in some six lines each, and each is in the lesson", () => {
    expect(BLOCKS.flatMap(({ code }) => code ?? []).sort()).toEqual(names.sort());
    for (const name of names)
      for (const ending of ["py", "js"]) {
        const lines = readFileSync(join(CODE, `${name}.${ending}`), "utf8").split("\n").filter(Boolean);
        expect(lines.length, `${name}.${ending}`).toBeLessThanOrEqual(8);
        for (const line of lines) expect(line.length, `${name}.${ending}: ${line}`).toBeLessThanOrEqual(82);
      }
  });

  /** Runs an example, and returns one of its functions or values. */
  function run<T>(name: string, wanted: string): T {
    const source = readFileSync(join(CODE, `${name}.js`), "utf8").replace(/import (\{[^}]*\}) from "three";/, "const $1 = three;");
    return new Function("three", "console", `${source}\nreturn ${wanted};`)(three, { log: () => undefined }) as T;
  }
  type P = number[];

  test("in JavaScript does what the text says", () => {
    const inside = run<(a: P, b: P, c: P, p: P) => boolean>("inside", "inside");
    expect([inside([0, 0], [1, 0], [0, 1], [0.2, 0.2]), inside([0, 0], [0, 1], [1, 0], [0.2, 0.2]), inside([0, 0], [1, 0], [0, 1], [1, 1])]).toEqual([true, true, false]);
    const corner = (x: number, y: number) => new three.Vector3(x, y, 0);
    const blend = run<(corners: three.Vector3[], values: P, p: three.Vector3) => [P, number]>("blend", "blend");
    const [weights, value] = blend([corner(0, 0), corner(1, 0), corner(0, 1)], [0, 4, 8], corner(0.25, 0.25));
    expect(weights.reduce((sum, w) => sum + w)).toBeCloseTo(1);
    expect(value).toBeCloseTo(3);
    expect(run("buffers", "bytes")).toBe(60);
    expect(run<(...v: three.Vector3[]) => three.Vector3>("normal", "normal")(corner(0, 0), corner(2, 0), corner(0, 2)).toArray()).toEqual([0, 0, 1]);
    const hasInside = run<(faces: P[]) => boolean>("check", "hasInside");
    const tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    expect([hasInside(tetrahedron), hasInside(tetrahedron.slice(1)), hasInside([[0, 1, 2], ...tetrahedron.slice(1)])]).toEqual([true, false, false]);
    expect(run<(points: P[], t: number) => P>("casteljau", "casteljau")([[0, 0], [0, 4], [4, 4], [4, 0]], 0.5)).toEqual([2, 3]);
    const corners = (faces: P[]) => [...new Set(faces.flat())].sort();
    const fan = run<(n: number) => P[]>("fan", "fan");
    expect([fan(3), fan(6).length, corners(fan(6))]).toEqual([[[0, 1, 2]], 4, [0, 1, 2, 3, 4, 5]]);
    // The corner that points inwards, the last one, is on both triangles.
    const ears = run<P[]>("fan", "faces");
    expect([ears.length, corners(ears), ears.every((face) => face.includes(3))]).toEqual([2, [0, 1, 2, 3], true]);
    const cube = new three.BufferGeometry().setAttribute("position", new three.Float32BufferAttribute([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1], 3));
    cube.setIndex([0, 3, 2, 0, 2, 1, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7]);
    const normalsOf = (way: string) => run<(of: three.BufferGeometry) => three.BufferGeometry>("normals", way)(cube).attributes["normal"]!;
    expect(normalsOf("smooth").count).toBe(8);
    // Out of the corner at the origin, whose faces all have a side there.
    expect([0, 1, 2].every((k) => normalsOf("smooth").getComponent(0, k) < 0)).toBe(true);
    expect([normalsOf("flat").count, ...normalsOf("flat").array.slice(0, 3)]).toEqual([36, 0, 0, -1]);
    const patch = run<(rows: P[][], u: number, v: number) => P>("patch", "patch");
    // Points in equal steps, so that u and v are places.
    const net = [0, 1, 2, 3].map((i) => [0, 1, 2, 3].map((j) => [j, i, i * j]));
    for (const [k, x] of patch(net, 0.5, 1 / 3).entries()) expect(x).toBeCloseTo([1.5, 1, 1.5][k]!);
    const bake = run<(f: (p: P) => number, n: number) => unknown>("baking", "bake");
    const read = run<(samples: unknown, p: P) => number>("baking", "read");
    const far = ([x, y, z]: P) => Math.hypot(x! - 8, y! - 8, z! - 8) - 5;
    expect(read(bake(far, 17), [16, 4, 0])).toBeCloseTo(far([16, 4, 0]));
    expect(Math.abs(read(bake(far, 17), [12.3, 9.6, 10.1]) - far([12.3, 9.6, 10.1]))).toBeLessThan(0.1);
    // Exact for what is linear along each axis, in whichever order the axes come.
    expect(read(bake(([x, y, z]) => x! + 10 * y! + 100 * z!, 4), [0.5, 1.25, 2.75])).toBeCloseTo(288);
    const gap = run<(n: number) => number>("segments", "gap");
    expect(gap(16) / gap(32)).toBeGreaterThan(3.5);
    const [ball, normal] = [run<(p: P) => number>("field", "ball"), run<(f: (p: P) => number, p: P) => P>("field", "normal")];
    expect(ball([2, 0, 0])).toBe(1);
    expect(normal(ball, [0, 3, 0])[1]).toBeCloseTo(1);
    expect(run<(f: (p: P) => number, eye: P, way: P) => { t: number }>("trace", "trace")(ball, [-3, 0.5, 0], [1, 0, 0]).t).toBeCloseTo(3 - Math.sqrt(0.75), 2);
    const part = run<(p: P) => number>("csg", "part");
    expect([part([0, 0, 0]) > 0, part([0.8, 0.8, 0]) < 0]).toEqual([true, true]);
    const triangles = run<(tolerance: number) => number>("budget", "triangles");
    expect(triangles(0.001) / triangles(0.002)).toBeCloseTo(2, 0);
    const levelAt = run<(levels: { error: number }[], distance: number) => { error: number }>("levels", "levelAt");
    expect([levelAt([{ error: 0.001 }, { error: 0.1 }], 1), levelAt([{ error: 0.001 }, { error: 0.1 }], 200)]).toEqual([{ error: 0.001 }, { error: 0.1 }]);
  });
});
