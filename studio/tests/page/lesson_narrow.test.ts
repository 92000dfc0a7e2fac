// The lesson on a phone: it is little more than half as long as with everything open, and what it folds opens by keyboard, is open
// without script and on paper, and is not folded on a wide screen.
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, test } from "vitest";
import { BLOCKS } from "../../src/lesson/outline";
import { patient } from "./exhibit_page";
import { Site, axeFindings } from "./site";

const PHONE = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, reducedMotion: "reduce" } as const;
const FIGURES = BLOCKS.flatMap(({ figure }) => figure ?? []);
/** Heights at 390 pixels with everything open, before a guess and after all. Measured, on the page as it was before it was folded. */
const OPEN = { en: [56_658, 63_915], zh: [52_342, 58_897] } as const;
/** The share of it that is allowed. Defined: a lesson of half an hour is some forty screens of a phone. */
const SHARE = 0.55;
const SMALLEST = 11;

let site: Site;
beforeAll(async () => {
  site = await Site.open(patient);
});
afterAll(() => site.close());

async function lesson(language: string, options: Parameters<Site["visit"]>[1] = PHONE, fragment = ""): Promise<{ page: Page; errors: string[] }> {
  const visit = await site.visit((language === "en" ? "lesson.html" : "lesson.zh.html") + fragment, { locale: language, ...options });
  if (options?.javaScriptEnabled !== false) await visit.page.waitForSelector("html[data-ready]", { state: "attached" });
  return visit;
}
const height = (page: Page) => page.evaluate(() => document.documentElement.scrollHeight);
const guessAll = (page: Page) => page.locator(".guess details").evaluateAll((all) => all.forEach((one) => ((one as HTMLDetailsElement).open = true)));

/** Texts of pictures that are seen smaller than that. */
const smallLabels = (page: Page) =>
  page.locator("main svg text").evaluateAll(
    (all, smallest) =>
      (all as SVGTextElement[])
        .filter((text) => text.textContent!.trim() && text.checkVisibility({ visibilityProperty: true }))
        .map((text) => {
          const { a, b } = text.getScreenCTM()!;
          return [text.textContent!, Number.parseFloat(getComputedStyle(text).fontSize) * Math.hypot(a, b)] as const;
        })
        .filter(([, size]) => size < smallest - 0.05)
        .map(([text, size]) => `${text}: ${size.toFixed(1)}`),
    SMALLEST,
  );

describe.each(["en", "zh"] as const)("%s", (language) => {
  test("is at most 55 % of its height with everything open, before the guesses and after", async () => {
    const { page, errors } = await lesson(language);
    const [before, after] = OPEN[language];
    expect(await height(page)).toBeLessThanOrEqual(SHARE * before);
    await guessAll(page);
    expect(await height(page)).toBeLessThanOrEqual(SHARE * after);
    expect(await smallLabels(page)).toEqual([]);
    expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(390);
    expect(errors).toEqual([]);
    await page.context().close();
  });
});

test("every fold opens and closes by keyboard, in the figures, the code, the table and the terms", async () => {
  const { page, errors } = await lesson("en");
  await guessAll(page);
  for (const id of FIGURES) {
    const figure = page.locator(`[data-figure-of="${id}"]`);
    // Scrolled to again and again: what wakes above it moves it out of sight.
    const isAwake = (id: string) => {
      const figure = document.querySelector<HTMLElement>(`[data-figure-of="${id}"]`)!;
      figure.querySelector(".stage")!.scrollIntoView({ behavior: "instant" });
      return figure.dataset.live === "awake";
    };
    await page.waitForFunction(isAwake, id, { polling: 500, timeout: 50_000 });
    const [fold, rest] = [figure.locator(".fold"), figure.locator(".rest")];
    expect(await rest.isVisible(), id).toBe(false);
    expect(await fold.getAttribute("aria-controls"), id).toBe(await rest.getAttribute("id"));
    await fold.focus();
    await page.keyboard.press("Enter");
    await rest.waitFor();
    expect(await fold.getAttribute("aria-expanded"), id).toBe("true");
    // The link to the figure's own page is folded with them.
    if (id !== "segments") expect(await figure.locator("> figcaption").isVisible(), id).toBe(true);
  }
  // One of them is closed again; the next stop after its button is within.
  const fold = page.locator('[data-figure-of="csg"] .fold');
  await fold.focus();
  await page.keyboard.press("Tab");
  expect(await page.evaluate(() => document.activeElement!.closest(".rest, figcaption")?.closest("[data-figure-of]")?.getAttribute("data-figure-of"))).toBe("csg");
  await fold.focus();
  await page.keyboard.press("Space");
  await page.locator('[data-figure-of="csg"] .rest').waitFor({ state: "hidden" });

  for (const block of await page.locator(".code").all()) {
    expect(await block.locator("pre:visible").count()).toBe(0);
    await block.locator(".fold").focus();
    await page.keyboard.press("Enter");
    expect(await block.locator("pre:visible").count()).toBe(1);
  }
  for (const list of await page.locator("details[data-fold]").all()) {
    expect(await list.evaluate((details) => (details as HTMLDetailsElement).open)).toBe(false);
    await list.locator("summary").focus();
    await page.keyboard.press("Enter");
    expect(await list.locator("dl, table").isVisible()).toBe(true);
  }
  expect(await smallLabels(page)).toEqual([]);
  expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(390);
  expect(await axeFindings(page)).toEqual([]);
  expect(errors).toEqual([]);
  await page.context().close();
}, 240_000);

/** What is folded, by a piece of each. */
const FOLDED = ["#term-bezier dd:last-child", "table.rivals td:last-child", "#block-inside .code pre"];
async function seen(page: Page): Promise<boolean[]> {
  return Promise.all(FOLDED.map((what) => page.locator(what).first().isVisible()));
}

test("on paper, without script and on a wide screen nothing is folded", async () => {
  const { page } = await lesson("en");
  expect(await seen(page)).toEqual([false, false, false]);
  await page.emulateMedia({ media: "print" });
  expect(await seen(page)).toEqual([true, true, true]);
  expect(await page.locator(".fold:visible, details[data-fold] > summary:visible").count()).toBe(0);
  await page.emulateMedia({ media: "screen" });
  await page.setViewportSize({ width: 1366, height: 768 });
  await page.waitForSelector(FOLDED[0]!);
  expect(await seen(page)).toEqual([true, true, true]);
  expect(await page.locator(".fold:visible, details[data-fold] > summary:visible").count()).toBe(0);
  expect(await page.locator('[data-figure-of="inside"] .panel dl').isVisible()).toBe(true);
  // And folded again as it becomes narrow.
  await page.setViewportSize(PHONE.viewport);
  await page.waitForSelector(FOLDED[0]!, { state: "hidden" });
  await page.context().close();

  const plain = await lesson("en", { ...PHONE, javaScriptEnabled: false });
  expect(await seen(plain.page)).toEqual([true, true, true]);
  expect(await plain.page.locator(".fold:visible, details[data-fold] > summary:visible").count()).toBe(0);
  // Numbers too; controls need a script.
  expect(await plain.page.locator('[data-figure-of="inside"] .panel dl').isVisible()).toBe(true);
  await plain.page.context().close();
});

test("an address that leads to a term opens the list", async () => {
  const { page } = await lesson("en", PHONE, "#term-csg");
  expect(await page.locator("#term-csg").isVisible()).toBe(true);
  await page.context().close();
});
