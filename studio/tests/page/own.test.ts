// A shape of the reader's own in the lesson: it is brought as a script or a file, travels along, and each number at each station
// is the command's. What cannot be read is said in a sentence, and the teapot stays.
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, test, vi } from "vitest";
import { type Files, run } from "../../src/core/command";
import { STATIONS, type StationId } from "../../src/lesson/outline";
import { OWN_TEXTS } from "../../src/lesson/own/texts";
import { split } from "../../src/workbench/document";
import type { Report } from "../../src/workbench/report";
import { BenchSay } from "../../src/workbench/words";
import { DIST, type Opening, Site, type Visit, axeFindings } from "./site";
import { PATIENCE, commandModule, text } from "./workbench_page";

vi.setConfig(PATIENCE);

const STEP_MS = PATIENCE.testTimeout / 2;
const SCRIPT = "box(2, 2, 2) - cylinder(0.5, 3)";
let site: Site;
let module: WebAssembly.Module;
beforeAll(async () => {
  site = await Site.open(async (page) => page.setDefaultTimeout(STEP_MS));
  module = await commandModule();
});
afterAll(() => site.close());

async function lesson(file = "lesson.html", options: Opening = {}): Promise<Visit> {
  const visit = await site.visit(file, { reducedMotion: "reduce", ...options });
  await visit.page.waitForSelector("html[data-ready]", { state: "attached" });
  return visit;
}
const dialog = (page: Page) => page.locator(".own-dialog");
const line = (page: Page) => page.locator("[data-own-line] [role=status]").textContent();
const station = (page: Page, id: StationId) => page.locator(`#own-${id}`);
const bring = (page: Page) => page.locator("[data-own-begin] > button");

/** Opens the dialogue. */
async function ask(page: Page): Promise<void> {
  await bring(page).click();
  await page.waitForSelector(".own-dialog[open]");
}
/** Waits until what was brought travels along. */
async function travels(page: Page, name: string): Promise<void> {
  await page.waitForSelector(".own-dialog:not([open])", { state: "attached" });
  await page.locator("[data-own-line] [role=status]", { hasText: name }).waitFor();
}
/** Guesses cover the numbers of some stations. */
const guessAll = (page: Page) =>
  page.locator(".guess details").evaluateAll((all) => all.forEach((one) => ((one as HTMLDetailsElement).open = true)));
async function reach(page: Page, id: StationId): Promise<void> {
  await station(page, id).evaluate((element) => element.scrollIntoView({ behavior: "instant" }));
  await page.waitForSelector(`#own-${id} [data-state="done"]`);
}
/** All numbers of a station, with all their digits, and as they are shown. */
const numbers = (page: Page, id: StationId) =>
  station(page, id)
    .locator("data")
    .evaluateAll((all) => all.map((one) => [one.getAttribute("data-name")!.replace(/^own-/, ""), (one as HTMLDataElement).value, one.textContent] as const));

/** The command in Node, which runs the lines that the page shows. */
class Shell {
  private readonly reports = new Map<string, Report>();
  constructor(readonly files: Files) {}

  /** The reports of the lines of a station. */
  async of(page: Page, id: StationId): Promise<Report[]> {
    const lines = (await station(page, id).locator(".own-line code").textContent())!.split("\n");
    const reports: Report[] = [];
    for (const one of lines) {
      if (!this.reports.has(one)) {
        const words = split(one).slice(1);
        // As in a folder that has no output of an earlier line with another budget.
        delete this.files[words[words.indexOf("-o") + 1]!];
        const outcome = await run(module, [...words, "--json"], this.files);
        expect(outcome.exit, `${one}: ${outcome.stderr}`).toBe(0);
        Object.assign(this.files, outcome.outputs);
        this.reports.set(one, JSON.parse(outcome.stdout) as Report);
      }
      reports.push(this.reports.get(one)!);
    }
    return reports;
  }
}

const say = new BenchSay("en");
/** What a station has to show: the numbers of the command, by their names; texts as they are. */
type Expected = Record<string, number | string | null | undefined>;
async function expectNumbers(page: Page, id: StationId, expected: Expected): Promise<void> {
  const wanted = Object.entries(expected).filter(([, value]) => value !== undefined && value !== null);
  await expect
    .poll(async () => Object.fromEntries((await numbers(page, id)).map(([name, value, shown]) => [name, value || shown])), { message: id })
    .toEqual(Object.fromEntries(wanted.map(([name, value]) => [name, String(value)])));
  for (const [name, value, shown] of await numbers(page, id)) {
    if (value === "" || name === "closed" || name === "manifold") continue;
    const of = Number(value);
    // A bound is in a sentence.
    const words = name.endsWith("off") ? /at most (\S+), /.exec(shown!)?.[1] ?? shown : shown;
    expect([say.whole(of), say.number(of), say.bytes(of)], `${id}: ${name}`).toContain(words);
  }
}

const WALK: Record<StationId, (reports: readonly Report[]) => Expected> = {
  triangles: ([mesh]) => ({
    triangles: mesh!.certificate!.output!.triangles,
    "in-file": mesh!.run!.input_triangles,
    off: mesh!.certificate!.bound!.at_most,
  }),
  buffers: (reports) => {
    const { certificate, inspection } = reports.at(-1)!;
    return {
      indexed: inspection!.sizes!.indexed_bytes,
      unindexed: inspection!.sizes!.unindexed_bytes,
      vertices: certificate!.output!.vertices,
      // Only where a file doubles vertices.
      ...(certificate!.output!.positions === certificate!.output!.vertices ? {} : { positions: certificate!.output!.positions }),
      "inspected-triangles": certificate!.output!.triangles,
      "per-vertex": certificate!.valid!.triangles_per_vertex,
    };
  },
  normals: (reports) => {
    const [flat, smooth, creased] = reports.slice(1).map(({ certificate }) => certificate!.output!.vertices);
    return { "normal-vertices": creased, "normal-vertices-flat": flat, "normal-vertices-smooth": smooth, "normal-vertices-crease=30deg": creased };
  },
  sound: (reports) => {
    const { certificate, inspection } = reports.at(-1)!;
    const { closed, manifold, components, genus } = certificate!.valid!;
    const found = inspection!.findings!.map(({ of, count }) => [`found-${of}`, count]);
    return { closed: Number(closed), manifold: Number(manifold), components, genus, ...Object.fromEntries(found) };
  },
  field: ([facts, field, back, mesh]) => {
    const rule = facts!.inspection!.field;
    const baked = field!.certificate!.baked!;
    const { output, history } = back!.certificate!;
    return {
      "back-triangles": output!.triangles,
      "back-off": history?.total?.at_most,
      samples: baked.size.join(" × "),
      spacing: baked.spacing,
      "samples-off": baked.off_at_most,
      ...(rule && { terms: rule.terms, outside: OWN_TEXTS.en.worth[rule.outside], "rule-off": mesh!.certificate!.bound!.at_most }),
    };
  },
  levels: (reports) => {
    const { levels, shown } = reports.at(-1)!.certificate!.levels!;
    const stops = [...shown].sort((a, b) => a.distance - b.distance);
    const seen = stops[Math.floor(stops.length / 2)]!;
    const rows = levels.flatMap(({ triangles, at_most, distance }, k) => [[`level-${k}-triangles`, triangles], [`level-${k}-off`, at_most], [`level-${k}-from`, distance]]);
    return { "shown-triangles": seen.triangles, "shown-level": seen.level, covers: seen.covers_px, "shown-off": seen.pixels, ...Object.fromEntries(rows) };
  },
  bound: ([mesh]) => {
    const { budget, bound, output } = mesh!.certificate!;
    return { length: budget!.length, left: output!.triangles, bound: bound!.at_most };
  },
};

/** A ball of a grid of quads, each cut in two, without one of its triangles. */
function ball(rows = 24, columns = 48): string {
  const lines: string[] = [];
  for (let i = 1; i < rows; i++)
    for (let k = 0; k < columns; k++) {
      const [a, b] = [(Math.PI * i) / rows, (2 * Math.PI * k) / columns];
      lines.push(`v ${Math.sin(a) * Math.cos(b)} ${Math.sin(a) * Math.sin(b)} ${Math.cos(a)}`);
    }
  lines.push("v 0 0 1", "v 0 0 -1");
  const at = (i: number, k: number) => (i - 1) * columns + (k % columns) + 1;
  const [top, bottom] = [(rows - 1) * columns + 1, (rows - 1) * columns + 2];
  const faces: number[][] = [];
  for (let k = 0; k < columns; k++) {
    faces.push([top, at(1, k), at(1, k + 1)], [bottom, at(rows - 1, k + 1), at(rows - 1, k)]);
    for (let i = 1; i < rows - 1; i++) faces.push([at(i, k), at(i + 1, k), at(i + 1, k + 1)], [at(i, k), at(i + 1, k + 1), at(i, k + 1)]);
  }
  return [...lines, ...faces.slice(1).map((face) => `f ${face.join(" ")}`), ""].join("\n");
}

test("nothing of it is loaded before it is asked for", async () => {
  const asked: string[] = [];
  const { page, errors } = await lesson("lesson.html", { prepare: async (page) => void page.on("request", (request) => asked.push(request.url())) });
  await page.waitForSelector("[data-hero][data-live]");
  expect(asked.filter((url) => /guide|command/.test(url))).toEqual([]);
  await ask(page);
  expect(asked.filter((url) => /guide/.test(url)).length).toBeGreaterThan(0);
  // The command only computes: it comes with a shape.
  expect(asked.filter((url) => /command/.test(url))).toEqual([]);
  expect(await axeFindings(page)).toEqual([]);
  await page.keyboard.press("Escape");
  await page.waitForSelector(".own-dialog:not([open])", { state: "attached" });
  expect(await bring(page).evaluate((button) => button === document.activeElement)).toBe(true);
  expect(errors).toEqual([]);
  await page.context().close();
});

describe("a script", () => {
  let visit: Visit;
  let shell: Shell;
  beforeAll(async () => {
    visit = await lesson();
    shell = new Shell({ "shape.star": text(SCRIPT) });
    const { page } = visit;
    await guessAll(page);
    // By keys alone.
    await bring(page).focus();
    await page.keyboard.press("Enter");
    await page.waitForSelector(".own-dialog[open]");
    await page.getByLabel("Or write it").fill(SCRIPT);
    await page.keyboard.press("Tab");
    await page.keyboard.press("Enter");
    await travels(page, "shape.star");
  }, PATIENCE.testTimeout);
  afterAll(() => visit.page.context().close());

  test.each(STATIONS.map(({ id }) => id))("is at the station %s with the numbers of the command", async (id) => {
    const { page, errors } = visit;
    await reach(page, id);
    await page.waitForSelector(`#own-${id} .scene[data-viewer="webgl"]`);
    await expectNumbers(page, id, WALK[id](await shell.of(page, id)));
    expect(await station(page, id).locator(".fault").count()).toBe(0);
    expect(errors).toEqual([]);
  });

  test("has another bound for another budget, at all stations", async () => {
    const { page } = visit;
    await reach(page, "triangles");
    await station(page, "triangles").locator('input[value="0.1%"]').check({ force: true });
    await expect.poll(() => station(page, "triangles").locator(".own-line code").textContent()).toContain("--tol 0.1%");
    for (const id of ["triangles", "bound"] as const) {
      await reach(page, id);
      await expectNumbers(page, id, WALK[id](await shell.of(page, id)));
    }
    expect(await station(page, "bound").locator(".own-bound").textContent()).toContain("0.1%");
  });

  test("shows the level that a pixel allows, wherever it is dragged to", async () => {
    const { page } = visit;
    await reach(page, "levels");
    const { levels } = (await shell.of(page, "levels")).at(-1)!.certificate!;
    const stops = [...levels!.shown].sort((a, b) => a.distance - b.distance);
    const slider = station(page, "levels").locator("input[type=range]");
    for (const step of [0, Math.floor(stops.length / 3), stops.length - 1]) {
      await slider.fill(String(step));
      const { triangles, level, covers_px, pixels } = stops[step]!;
      const shown = async () => Object.fromEntries((await numbers(page, "levels")).map(([name, value]) => [name, value]));
      await expect.poll(async () => (await shown())["shown-triangles"]).toBe(String(triangles));
      expect(await shown()).toMatchObject({ "shown-level": String(level), covers: String(covers_px), ...(pixels === null ? {} : { "shown-off": String(pixels) }) });
      expect(await station(page, "levels").locator("[aria-current] th").textContent()).toBe(String(level));
    }
  });

  test("opens in the workbench with its budget", async () => {
    const { page } = visit;
    await reach(page, "bound");
    const address = await station(page, "bound").locator("a.begin").getAttribute("href");
    expect(address).toMatch(/^workbench\.html#s=/);
    const bench = await visit.page.context().newPage();
    await bench.goto(site.base + address);
    await bench.waitForSelector("html[data-ready]");
    await expect.poll(() => bench.locator(".cm-content").textContent()).toBe(SCRIPT);
    await expect.poll(() => bench.locator(".line code").textContent()).toContain("--tol 0.1%");
    await bench.close();
  });

  test("is not printed: paper has the teapot", async () => {
    const { page } = visit;
    await page.emulateMedia({ media: "print" });
    expect(await page.locator(".own:visible, .begins:visible, .own-dialog:visible").count()).toBe(0);
    await page.emulateMedia({ media: null });
  });
});

describe("a file", () => {
  let visit: Visit;
  let shell: Shell;
  beforeAll(async () => {
    visit = await lesson();
    const { page } = visit;
    shell = new Shell({ "ball.obj": text(ball()) });
    await guessAll(page);
    await ask(page);
    await page.locator(".own-dialog input[type=file]").setInputFiles({ name: "ball.obj", mimeType: "text/plain", buffer: Buffer.from(ball()) });
    await travels(page, "ball.obj");
  }, PATIENCE.testTimeout);
  afterAll(() => visit.page.context().close());

  test.each(STATIONS.map(({ id }) => id))("is at the station %s with the numbers of the command", async (id) => {
    const { page, errors } = visit;
    await reach(page, id);
    await expectNumbers(page, id, WALK[id](await shell.of(page, id)));
    expect(errors).toEqual([]);
  });

  test("is told that it has a hole, and where", async () => {
    const { page } = visit;
    await reach(page, "sound");
    const said = (await station(page, "sound").textContent())!;
    expect(said).toContain("3 boundary edges");
    expect(said).toContain("marked in the picture: 3");
  });

  test("is there again after a reload, without loading the command before a station is reached; and leaves", async () => {
    const { page } = visit;
    await page.evaluate(() => scrollTo({ top: 0, behavior: "instant" }));
    const asked: string[] = [];
    page.on("request", (request) => asked.push(request.url()));
    await page.reload();
    await expect.poll(() => line(page)).toContain("ball.obj");
    expect(asked.filter((url) => /guide/.test(url)).length).toBeGreaterThan(0);
    expect(asked.filter((url) => /command-/.test(url))).toEqual([]);
    await reach(page, "triangles");
    await expectNumbers(page, "triangles", WALK.triangles(await shell.of(page, "triangles")));
    await page.evaluate(() => scrollTo({ top: 0, behavior: "instant" }));
    await page.locator("[data-own-back]").click();
    await expect.poll(() => page.locator(".own:visible").count()).toBe(0);
    expect(await line(page)).toBe("");
    await page.reload();
    await page.waitForSelector("html[data-ready]", { state: "attached" });
    expect(await page.evaluate(() => localStorage.getItem("chordal.own"))).toBe(null);
    expect(await page.locator(".own:visible").count()).toBe(0);
  });
});

test("a file that is too large for a link opens in the workbench from where the browser keeps it", async () => {
  const { page } = await lesson();
  const large = ball(120, 240);
  await ask(page);
  await page.locator(".own-dialog input[type=file]").setInputFiles({ name: "large.obj", mimeType: "text/plain", buffer: Buffer.from(large) });
  await travels(page, "large.obj");
  await reach(page, "bound");
  const link = station(page, "bound").locator("a.begin");
  expect(await link.getAttribute("href")).toBe("workbench.html?own");
  await link.click();
  await page.waitForSelector("html[data-ready]");
  await expect.poll(() => page.locator(".named").textContent()).toContain("large.obj");
  await page.context().close();
});

describe("what cannot travel along", () => {
  test.each([
    ["lesson.html", "en", "broken.glb", "glTF not really", /./],
    ["lesson.zh.html", "zh", "broken.star", "box(1, 2, 3", /语法错误/],
  ])("in %s is said in a sentence, and the teapot stays", async (file, locale, name, content, said) => {
    const { page, errors } = await lesson(file, { locale });
    await ask(page);
    const picker = page.locator(".own-dialog input[type=file]");
    await picker.setInputFiles({ name, mimeType: "text/plain", buffer: Buffer.from(content) });
    const fault = dialog(page).locator(".fault");
    await fault.waitFor();
    const outcome = await run(module, ["mesh", name, "--tol", "0.5%", "-o", "out.glb", "--json"], { [name]: text(content) });
    const { error } = JSON.parse(outcome.stdout) as Report;
    // The command's own sentence, and in Chinese what it means.
    const words = (await fault.textContent())!.trim();
    if (locale === "en") expect(error!.messages[0]).toContain(words);
    expect(await fault.locator("[lang=en]").count()).toBe(0);
    expect(words).toMatch(said);
    expect(await axeFindings(page)).toEqual([]);
    expect(await page.locator(".own:visible").count()).toBe(0);
    expect(await page.evaluate(() => localStorage.getItem("chordal.own"))).toBe(null);
    // And then one that can.
    await dialog(page).locator("textarea").fill("sphere(1)");
    await dialog(page).locator("button[type=submit]").click();
    await travels(page, "shape.star");
    expect(await fault.count()).toBe(0);
    expect(errors).toEqual([]);
    await page.context().close();
  });

  test("is a drawing, which has no triangles; and a shape that travels already goes on", async () => {
    const { page } = await lesson();
    await ask(page);
    await dialog(page).locator("textarea").fill("sphere(1)");
    await dialog(page).locator("button[type=submit]").click();
    await travels(page, "shape.star");
    await ask(page);
    const drawing = '<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0C1 2 3 4 5 6" fill="none" stroke="black"/></svg>';
    await page.locator(".own-dialog input[type=file]").setInputFiles({ name: "line.svg", mimeType: "image/svg+xml", buffer: Buffer.from(drawing) });
    await dialog(page).locator(".fault").waitFor();
    await page.keyboard.press("Escape");
    await expect.poll(() => line(page)).toContain("shape.star");
    await page.context().close();
  });

  test("is a page whose rest the host does not have, which is said in place", async () => {
    const { page } = await lesson("lesson.zh.html", { locale: "zh", prepare: async (page) => void (await page.route(/guide-.*\.js/, (route) => route.abort())) });
    await bring(page).click();
    await expect.poll(() => page.locator("[data-own-line]").textContent()).toContain("未能加载");
    await page.context().close();
  });

  test("is a module that the host does not have, which is said, too", async () => {
    const { page } = await lesson("lesson.html", { prepare: async (page) => void (await page.route(/command-.*\.wasm/, (route) => route.abort())) });
    await ask(page);
    await dialog(page).locator("button[type=submit]").click();
    await expect.poll(() => dialog(page).locator(".fault").textContent()).toContain("could not be loaded");
    await page.context().close();
  });
});

test("it pushes nothing down, and gives no answer away before the guess", async () => {
  const { page } = await lesson("lesson.html", { viewport: { width: 1366, height: 768 } });
  const top = () => page.locator("#question").evaluate((element) => element.getBoundingClientRect().top + scrollY);
  await page.waitForSelector("[data-hero][data-live]");
  const before = await top();
  expect(await bring(page).isVisible()).toBe(true);
  expect((await bring(page).boundingBox())!.y).toBeLessThan(768);
  await ask(page);
  await dialog(page).locator("textarea").fill("sphere(1)");
  await dialog(page).locator("button[type=submit]").click();
  await travels(page, "shape.star");
  expect(await top()).toBe(before);
  const buffers = station(page, "buffers");
  await buffers.evaluate((element) => element.scrollIntoView({ behavior: "instant" }));
  await buffers.locator('[data-state="done"]').waitFor();
  expect(await buffers.locator(".panel").isVisible()).toBe(false);
  expect(await buffers.locator(".own-covered").isVisible()).toBe(true);
  await page.locator('[data-guess="indexed"] summary').click();
  await buffers.locator(".panel").waitFor();
  expect(await buffers.locator(".own-covered").isVisible()).toBe(false);
  await page.context().close();
});

test("a browser that keeps nothing says so, and the shape travels along all the same", async () => {
  const { page, errors } = await lesson("lesson.html", {
    prepare: (page) =>
      page.addInitScript(() => {
        IDBFactory.prototype.open = () => {
          throw new DOMException("refused", "SecurityError");
        };
      }),
  });
  await ask(page);
  await dialog(page).locator("textarea").fill("sphere(1)");
  await dialog(page).locator("button[type=submit]").click();
  await travels(page, "shape.star");
  await expect.poll(() => page.locator("[data-own-line]").textContent()).toContain("does not keep it");
  await reach(page, "triangles");
  expect(errors).toEqual([]);
  await page.context().close();
});

test("a file that is dropped on the page travels along, by touch an example does", async () => {
  const { page } = await lesson("lesson.html", { hasTouch: true, isMobile: true, viewport: { width: 390, height: 844 } });
  await page.evaluate((content) => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([content], "dropped.star"));
    document.querySelector("main")!.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
  }, "sphere(2)");
  await travels(page, "dropped.star");
  await bring(page).tap();
  await page.waitForSelector(".own-dialog[open]");
  await page.locator('[data-example="bracket"]').tap();
  await travels(page, "bracket.star");
  await page.context().close();
});

test("without script nothing of it is shown", async () => {
  const { page } = await site.visit("lesson.html", { javaScriptEnabled: false });
  expect(await page.locator(".own").count()).toBe(STATIONS.length);
  expect(await page.locator("[data-own-begin]").count()).toBeGreaterThan(0);
  expect(await page.locator(".own:visible, [data-own-begin]:visible").count()).toBe(0);
  await page.context().close();
});

test("all of it is in files of its own", () => {
  const html = readFileSync(join(DIST, "lesson.html"), "utf8");
  const files = readdirSync(join(DIST, "assets"));
  for (const name of [/^command-.*\.wasm$/, /^guide-.*\.js$/]) expect(files.filter((file) => name.test(file)).length).toBe(1);
  expect(html).not.toMatch(/command-|guide-/);
});

describe.each([["lesson.html", "en"], ["lesson.zh.html", "zh"]])("%s", (file, locale) => {
  test("axe finds nothing at any station, and nothing sticks out, wide and narrow, light and dark", async () => {
    const { page } = await lesson(file, { locale });
    await guessAll(page);
    await ask(page);
    await dialog(page).locator("textarea").fill(SCRIPT);
    await dialog(page).locator("button[type=submit]").click();
    await travels(page, "shape.star");
    for (const { id } of STATIONS) await reach(page, id);
    for (const [colorScheme, width] of [["light", 1366], ["dark", 390], ["light", 360]] as const) {
      await page.emulateMedia({ colorScheme, reducedMotion: "reduce" });
      await page.setViewportSize({ width, height: 800 });
      expect(await page.evaluate(() => document.documentElement.scrollWidth), `${width} wide`).toBeLessThanOrEqual(width);
      expect(await axeFindings(page), `${colorScheme}, ${width}`).toEqual([]);
    }
    await page.context().close();
  });
});
