// The lesson in a browser: it answers its own question, a guess unlocks, figures live only when they are seen, cards turn after an
// answer, and it reads without script and on paper.
import type axe from "axe-core";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, test } from "vitest";
import { LESSONS } from "../../src/lesson/languages";
import { BLOCKS, QUESTIONS } from "../../src/lesson/outline";
import { patient } from "./exhibit_page";
import { digits, DIST, ROOT, Site, type Visit } from "./site";

const FILE = "lesson.html";
const FIGURES = BLOCKS.flatMap(({ figure }) => figure ?? []);
const GUESSED = BLOCKS.filter(({ guess }) => guess);
let site: Site;
beforeAll(async () => {
  site = await Site.open(patient);
});
afterAll(() => site.close());

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
/** All findings of axe, also small ones, one line each. */
async function findings(page: Page): Promise<string[]> {
  await page.evaluate(AXE);
  return page.evaluate(async () => {
    const { violations } = await (window as unknown as { axe: typeof axe }).axe.run({ resultTypes: ["violations"] });
    return violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.target.join(" ")).join(", ")}`);
  });
}

/** Opens the lesson without the play of its first picture. */
async function calm(options: Parameters<Site["ready"]>[1] = {}): Promise<Visit> {
  const visit = await site.visit(FILE, { reducedMotion: "reduce", ...options });
  await visit.page.waitForSelector("html[data-ready]", { state: "attached" });
  return visit;
}
const figure = (page: Page, id: string) => page.locator(`[data-figure-of="${id}"]`);
async function reach(page: Page, id: string): Promise<void> {
  await page.locator(`#block-${id}`).evaluate((block) => block.scrollIntoView({ behavior: "instant" }));
}
const awake = (page: Page, id: string) => page.waitForSelector(`[data-figure-of="${id}"][data-live="awake"]`, { timeout: 50_000 });
/** The first block with that figure. */
const blockOf = (id: string) => BLOCKS.find((block) => block.figure === id)!;

describe("the first picture", () => {
  test("answers the question by itself: the triangles fall away, and it comes to rest", async () => {
    const { page, errors } = await site.visit(FILE);
    const triangles = () => digits(page, "hero-triangles");
    await page.waitForSelector("[data-hero][data-playing]");
    await page.waitForSelector("[data-hero]:not([data-playing])", { timeout: 30_000 });
    // From 5,064 where it begins.
    expect(await triangles()).toBeLessThan(500);
    expect(await page.locator(".hero .live").textContent()).toMatch(/proved/);
    expect(errors).toEqual([]);
    await page.context().close();
  });

  test("stops when the reader takes the handle, and compares with all triangles", async () => {
    const { page } = await site.visit(FILE);
    await page.waitForSelector("[data-hero][data-playing]");
    const handle = page.locator("#hero-distance");
    await handle.focus();
    await page.keyboard.press("End");
    await page.waitForSelector("[data-hero]:not([data-playing])");
    await expect.poll(() => digits(page, "hero-triangles")).toBeLessThan(100);
    expect(await handle.getAttribute("aria-valuetext")).toMatch(/m, \d+ triangles/);
    await page.getByRole("button", { name: /compare with/ }).click();
    await page.waitForSelector('[data-hero] [aria-pressed="true"]');
    await page.context().close();
  });

  test("stands still for those who want no motion", async () => {
    const { page } = await calm();
    await page.waitForSelector("[data-hero][data-live]");
    expect(await page.locator("[data-hero][data-playing]").count()).toBe(0);
    await page.context().close();
  });

  test("is seen after 150 kB and moves after 400, without the core", async () => {
    const asked: string[] = [];
    const { page } = await site.visit(FILE, { prepare: async (page) => void page.on("request", (request) => asked.push(request.url())) });
    await page.waitForSelector('[data-hero][data-live] .scene[data-viewer="webgl"]');
    const size = (urls: readonly string[]) =>
      urls.reduce((sum, url) => sum + gzipSync(readFileSync(join(DIST, new URL(url).pathname.replace("/some/where/", "")))).length, 0);
    const live = asked.filter((url) => url.startsWith(site.base));
    const seen = live.filter((url) => /\.(html|css)$|theme\.js$/.test(url));
    expect(live.some((url) => url.endsWith(".wasm"))).toBe(false);
    expect(size(seen)).toBeLessThan(150_000);
    expect(size(live)).toBeLessThan(400_000);
    await page.context().close();
  });
});

test("a guess comes first: it says how near it was, and unlocks answer and figure", async () => {
  const { page, errors } = await calm();
  expect(GUESSED.length).toBeGreaterThanOrEqual(6);
  const guess = page.locator('[data-guess="plane"]');
  await reach(page, "plane");
  expect(await figure(page, "quad").locator(".live").isVisible()).toBe(false);
  expect(await page.locator("#block-plane .after").isVisible()).toBe(false);
  await guess.getByRole("button", { name: "Up" }).click();
  expect(await guess.locator(".verdict").textContent()).toContain("Up");
  expect(await guess.locator("details p").isVisible()).toBe(true);
  await awake(page, "quad");
  expect(await figure(page, "quad").locator(".live").isVisible()).toBe(true);

  const number = page.locator('[data-guess="segments"]');
  await reach(page, "segments");
  await number.locator("input").fill("300");
  await page.keyboard.press("Enter");
  expect(await number.locator(".verdict").textContent()).toContain("300");
  await awake(page, "segments");
  // Or without a guess.
  await reach(page, "overshade");
  await page.locator('[data-guess="overshade"] summary').click();
  await awake(page, "overshade");
  expect(errors).toEqual([]);
  await page.context().close();
});

test("figures live when they are seen and only then, on one worker, and give their contexts back", async () => {
  const { page, errors } = await calm({
    prepare: (page) =>
      page.addInitScript(() => {
        const contexts: WebGLRenderingContext[] = [];
        const get = HTMLCanvasElement.prototype.getContext;
        HTMLCanvasElement.prototype.getContext = function (this: HTMLCanvasElement, ...kind: Parameters<typeof get>) {
          const context = get.apply(this, kind);
          if (String(kind[0]).startsWith("webgl") && context) contexts.push(context as unknown as WebGLRenderingContext);
          return context;
        } as typeof get;
        Object.assign(window, { alive: () => contexts.filter((context) => !context.isContextLost()).length });
      }),
  });
  const alive = () => page.evaluate(() => (window as unknown as { alive(): number }).alive());
  expect(page.workers().length, "nothing is asked before a figure is seen").toBe(0);
  await page.locator(".guess details").evaluateAll((all) => all.forEach((one) => ((one as HTMLDetailsElement).open = true)));
  expect(await page.locator('[data-figure-of][data-live="awake"]').count()).toBe(0);
  let most = 0;
  for (const id of FIGURES) {
    await reach(page, blockOf(id).id);
    await awake(page, id);
    most = Math.max(most, await alive());
    expect(page.workers().length).toBe(1);
  }
  expect(most).toBeLessThanOrEqual(6);
  await page.evaluate(() => scrollTo({ top: document.body.scrollHeight, behavior: "instant" }));
  await expect.poll(alive).toBe(0);
  expect(await page.locator('[data-figure-of][data-live="awake"]').count()).toBe(0);
  // What is out of sight still shows its last picture.
  expect(await page.locator('.scene[data-viewer="asleep"] canvas').count()).toBeGreaterThan(5);
  await reach(page, "cage");
  await awake(page, "cage");
  await page.waitForSelector('[data-figure-of="cage"] .scene[data-viewer="webgl"]');
  expect(await figure(page, "cage").locator("canvas").count()).toBe(1);
  expect(errors).toEqual([]);
  await page.context().close();
}, 240_000);

test("numbers of the text are handles, and follow their figures", async () => {
  const { page, errors } = await calm();
  await reach(page, "bernstein");
  await awake(page, "bernstein");
  const handle = page.locator('[data-handle="bernstein"]');
  expect(await handle.getAttribute("aria-valuenow")).toBe("0.35");
  await handle.focus();
  await page.keyboard.press("ArrowRight");
  await expect.poll(() => page.locator("#bernstein-t").inputValue()).toBe("0.4");
  await page.locator("#bernstein-t").fill("0.7");
  await expect.poll(() => handle.textContent()).toBe("0.7");
  const box = (await handle.boundingBox())!;
  await page.mouse.move(box.x + 5, box.y + 5);
  await page.mouse.down();
  await page.mouse.move(box.x + 5 - 24, box.y + 5, { steps: 4 });
  await page.mouse.up();
  await expect.poll(() => page.locator("#bernstein-t").inputValue()).toBe("0.5");
  await page.locator('[data-figure-of="joins"]').scrollIntoViewIfNeeded();
  await page.locator("#block-joins button.set-of").last().click();
  await expect.poll(() => figure(page, "joins").locator('input[value="C2"]').isChecked()).toBe(true);
  expect(errors).toEqual([]);
  await page.context().close();
});

test("curve and patch are the teapot’s spout, point by point, and come back to it", async () => {
  const { page, errors } = await calm();
  const words = readFileSync(join(ROOT, "../examples/teapot.bpt"), "utf8").trim().split(/\s+/).map(Number);
  // The seventeenth patch: a count, sixteen patches of two degrees and sixteen points, and two degrees stand before.
  const points = Array.from({ length: 16 }, (_, row) => words.slice(803 + 3 * row, 806 + 3 * row));
  const spoken = (id: string, name: string) => figure(page, id).getByRole("slider", { name, exact: true }).getAttribute("aria-valuetext");
  const coordinates = async (id: string, name: string) => ((await spoken(id, name))!.replaceAll("−", "-").match(/-?[\d.]+/g) ?? []).map(Number);
  const digit = (i: number) => "₀₁₂₃"[i]!;
  /** Enlarged by one number and moved by one vector, to the hundredth that is spoken. */
  const expectPlaced = (placed: number[][], from: number[][]) => {
    const [a, b] = [from[0]!, from.at(-1)!];
    const axis = b.length - 1;
    const scale = (placed.at(-1)![axis]! - placed[0]![axis]!) / (b[axis]! - a[axis]!);
    for (const [i, place] of placed.entries()) for (const [k, x] of place.entries()) expect(x, `point ${i}`).toBeCloseTo(placed[0]![k]! + scale * (from[i]![k]! - a[k]!), 1);
  };
  await reach(page, "bernstein");
  await awake(page, "bernstein");
  const side = [3, 7, 11, 15].map((row) => [points[row]![0]!, points[row]![2]!]);
  expectPlaced(await Promise.all([0, 1, 2, 3].map((i) => coordinates("bernstein", `Control point P${digit(i)}`))), side);
  expect(await figure(page, "bernstein").locator("input[value=spout]").isChecked()).toBe(true);
  await reach(page, "patch");
  await awake(page, "patch");
  const net = () => Promise.all(points.map((_, row) => coordinates("patch", `Control point P${digit(row >> 2)}${digit(row % 4)}`)));
  const first = await net();
  expectPlaced(first, points);
  await figure(page, "patch").getByRole("button", { name: "a hill" }).click();
  await expect.poll(net).not.toEqual(first);
  await figure(page, "patch").getByRole("button", { name: "spout" }).click();
  await expect.poll(net).toEqual(first);
  expect(errors).toEqual([]);
  await page.context().close();
});

test("on a wide screen the figure stays beside its number, controls and code", async () => {
  const { page, errors } = await calm({ viewport: { width: 1366, height: 768 } });
  for (const id of ["inside", "weights", "bernstein"]) {
    await reach(page, id);
    await awake(page, id);
    const block = page.locator(`#block-${id}`);
    const boxOf = async (what: string) => (await block.locator(what).first().boundingBox())!;
    for (const what of [".placed .panel", ".code"]) {
      // By its last line.
      await block.locator(what).first().evaluate((part) => part.scrollIntoView({ behavior: "instant", block: "end" }));
      const [part, stage] = [await boxOf(what), await boxOf(".stage")];
      expect(part.x + part.width, `${id}: ${what}`).toBeLessThan(stage.x);
      expect(stage.y, `${id}: ${what}`).toBeGreaterThanOrEqual(0);
      expect(stage.y + stage.height, `${id}: ${what}`).toBeLessThanOrEqual(768);
    }
    // What lies over the text lets the hand through.
    const link = block.locator("a.term").first();
    await link.click();
    expect(await page.locator("#gloss").isVisible()).toBe(true);
    await page.keyboard.press("Escape");
  }
  // 64 times the size of the text: from there on it is wide, and not narrow as well.
  await page.setViewportSize({ width: 1024, height: 768 });
  const [words, stage] = [(await page.locator("#block-inside .words").boundingBox())!, (await figure(page, "inside").locator(".stage").boundingBox())!];
  expect(words.x + words.width).toBeLessThan(stage.x);
  expect(stage.width).toBeGreaterThan(400);
  expect(errors).toEqual([]);
  await page.context().close();
});

test("the curve's segments can follow its bend: fewer are proved to be as near", async () => {
  const { page, errors } = await calm();
  await page.locator('[data-guess="segments"] summary').evaluate((summary) => (summary as HTMLElement).click());
  await reach(page, "segments");
  await awake(page, "segments");
  const [evenly, fewest] = [await digits(page, "evenly"), await digits(page, "fewest")];
  expect(fewest).toBeLessThan(evenly);
  await page.locator("#block-segments button.set-of").click();
  await expect.poll(() => digits(page, "segments-live")).toBe(fewest);
  expect(await figure(page, "segments").locator(".joint-of").count()).toBe(fewest + 1);
  await page.locator("#segments-count").fill("12");
  await expect.poll(() => figure(page, "segments").locator(".joint-of").count()).toBe(13);
  expect(errors).toEqual([]);
  await page.context().close();
});

test("cards turn only after an answer", async () => {
  const { page } = await calm();
  expect(await page.locator("[data-card]").count()).toBe(QUESTIONS.length);
  const card = page.locator('[data-card="triangles"]');
  expect(await card.locator("details").isVisible()).toBe(false);
  await card.locator("textarea").fill("  ");
  expect(await card.getByRole("button").isDisabled()).toBe(true);
  await card.locator("textarea").fill("They are always flat.");
  await card.getByRole("button").click();
  expect(await card.locator("details p").first().isVisible()).toBe(true);
  expect(await card.locator("textarea").inputValue()).toBe("They are always flat.");
  await page.context().close();
});

test("a term opens in place by keyboard, and closes", async () => {
  const { page } = await calm();
  const term = page.locator('a.term[href="#term-barycentric"]');
  await term.focus();
  await page.keyboard.press("Enter");
  const gloss = page.locator("#gloss");
  expect(await gloss.isVisible()).toBe(true);
  expect(await gloss.textContent()).toContain("w₀ + w₁ + w₂ = 1");
  await page.keyboard.press("Escape");
  expect(await gloss.isVisible()).toBe(false);
  expect(await term.evaluate((link) => link === document.activeElement)).toBe(true);
  await page.context().close();
});

test("code is shown in one language, remembered, and copied", async () => {
  const { page } = await calm({ permissions: ["clipboard-read", "clipboard-write"] });
  const block = page.locator("#block-field .code");
  await block.getByRole("button", { name: "JavaScript" }).click();
  expect(await page.locator('.code [data-code="py"]:visible').count()).toBe(0);
  await block.locator(".copy").click();
  await expect.poll(() => page.evaluate(() => navigator.clipboard.readText())).toContain("const ball");
  await page.reload();
  await page.waitForSelector("html[data-ready]", { state: "attached" });
  expect(await block.locator('[data-code="js"]').isVisible()).toBe(true);
  await page.context().close();
});

test("without script everything can be read: text, pictures, answers, both languages of code", async () => {
  const { page } = await site.visit(FILE, { javaScriptEnabled: false });
  expect(await page.locator("[style]").count(), "a strict policy forbids styles in the text").toBe(0);
  expect(await page.locator(".hero svg path").count()).toBeGreaterThan(100);
  for (const id of FIGURES) {
    expect(await figure(page, id).locator(".stage :is(svg, img.still)").first().isVisible(), id).toBe(true);
    expect(await figure(page, id).locator(".live").isVisible(), id).toBe(true);
  }
  expect(await page.locator("form:visible, textarea:visible, .handle-of[role]").count()).toBe(0);
  await page.locator('[data-guess="plane"] summary').click();
  expect(await page.locator('[data-guess="plane"] details p').isVisible()).toBe(true);
  await page.locator('[data-card="cost"] summary').click();
  expect(await page.locator('[data-card="cost"] details p').first().isVisible()).toBe(true);
  await page.locator("#block-csg .code summary").last().click();
  expect(await page.locator('#block-csg [data-code="js"] pre').isVisible()).toBe(true);
  await page.locator('a.term[href="#term-csg"]').click();
  expect(new URL(page.url()).hash).toBe("#term-csg");
  await page.context().close();
});

test("on paper it is text with its figures and answers, on white, without controls", async () => {
  const { page } = await calm({ colorScheme: "dark" });
  await page.waitForSelector("[data-hero][data-live]");
  const sheets = (await page.pdf({ format: "A4" })).toString("latin1");
  expect(sheets.match(/\/Type\s*\/Page\b/g)!.length).toBeLessThan(40);
  await page.emulateMedia({ media: "print" });
  expect(await page.evaluate(() => getComputedStyle(document.body).backgroundColor)).toBe("rgb(255, 255, 255)");
  expect(await page.locator("button:not(.set-of):visible, input:visible, textarea:visible, canvas:visible, select:visible").count()).toBe(0);
  for (const id of FIGURES) expect(await figure(page, id).locator(".stage :is(svg, img.still)").first().isVisible(), id).toBe(true);
  for (const { id } of GUESSED) expect(await page.locator(`[data-guess="${id}"] details p`).isVisible(), id).toBe(true);
  await expect.poll(() => page.locator(".hero svg path").count()).toBeGreaterThan(100);
  await page.context().close();
});

test("the keyboard reaches the first figure in ten stops", async () => {
  const { page } = await calm();
  await page.waitForSelector("[data-hero][data-live]");
  let stops = 0;
  for (; stops < 20; stops++) {
    await page.keyboard.press("Tab");
    if (await page.evaluate(() => document.activeElement?.closest(".hero .scene, #hero-distance") !== null)) break;
  }
  expect(stops + 1).toBeLessThanOrEqual(10);
  // Or in two, by the first link.
  await page.evaluate(() => (document.activeElement as HTMLElement).blur());
  await page.reload();
  await page.waitForSelector("[data-hero][data-live]");
  await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  await page.keyboard.press("Tab");
  expect(await page.evaluate(() => document.activeElement?.closest(".hero .scene") !== null)).toBe(true);
  await page.context().close();
});

describe.each(Object.keys(LESSONS))("%s", (language) => {
  test("axe finds nothing, and nothing sticks out, wide and narrow, light and dark", async () => {
    const { page } = await site.visit(language === "en" ? FILE : `lesson.${language}.html`, { reducedMotion: "reduce", locale: language });
    await page.waitForSelector("[data-hero][data-live]");
    for (const [colorScheme, width] of [["light", 1366], ["dark", 390], ["light", 360]] as const) {
      await page.emulateMedia({ colorScheme, reducedMotion: "reduce" });
      await page.setViewportSize({ width, height: 800 });
      expect(await page.evaluate(() => document.documentElement.scrollWidth), `${width} wide`).toBeLessThanOrEqual(width);
      expect(await findings(page), `${colorScheme}, ${width}`).toEqual([]);
    }
    await page.context().close();
  });
});
