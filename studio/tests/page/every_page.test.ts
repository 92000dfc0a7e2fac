// What holds for every page, in either language: accessible names and headings, readable labels, hints for the devices that the
// reader has, no sentence twice, links that lead somewhere, and what a link to the page shows elsewhere.
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, test } from "vitest";
import { DIST, Site, axeFindings, isLong } from "./site";

const PAGES = readdirSync(DIST).filter((name) => name.endsWith(".html"));
/** In `make test`, one language of each page in turn. */
const OPENED = PAGES.filter((name, k) => isLong || /^(index|zh)\.html$/.test(name) || name.includes(".zh.") === (k % 4 < 2));
/** No smaller text is easy to read on a phone. Defined: by the field's guides to mobile pages, 11 points of Apple's among them. */
const SMALLEST = 11;

let site: Site;
beforeAll(async () => {
  site = await Site.open();
});
afterAll(() => site?.close());

/** Opens a page as on a phone, with a touch screen, or as on a desk, with a mouse. */
async function open(file: string, isPhone: boolean): Promise<Page> {
  const { page } = await site.visit(file, isPhone ? { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true } : {});
  await page.waitForSelector(/^exhibits/.test(file) ? "main" : "html[data-ready]");
  await page.evaluate(() => document.fonts.ready);
  return page;
}

/** How many texts are drawn, and those that are smaller. */
const smallTexts = (page: Page) =>
  page.evaluate((smallest) => {
    let looked = 0;
    const found = [...document.querySelectorAll<HTMLElement | SVGElement>("body *")].flatMap((element) => {
      const isText = [...element.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.textContent!.trim());
      // Formulas shrink their exponents, as everywhere.
      if (!isText || !element.checkVisibility({ visibilityProperty: true }) || element.closest("math")) return [];
      looked += 1;
      const matrix = element instanceof SVGGraphicsElement ? element.getScreenCTM()! : { a: 1, b: 0 };
      const size = Number.parseFloat(getComputedStyle(element).fontSize) * Math.hypot(matrix.a, matrix.b);
      return size < smallest - 0.05 ? [`${element.textContent!.trim().slice(0, 30)}: ${size.toFixed(1)}`] : [];
    });
    return { looked, small: [...new Set(found)] };
  }, SMALLEST);

/** All text that one reads or hears, with the folds open that say how to move things; and what those hints are. */
const saidOn = (page: Page) =>
  page.evaluate(() => {
    for (const fold of document.querySelectorAll<HTMLDetailsElement>(".numbers, .about")) fold.open = true;
    const hints = [...document.querySelectorAll<HTMLElement>(".hint, .numbers p, .about .with-pointer, #turn-hint")];
    return {
      all: document.body.innerText,
      hints: hints.map((element) => element.innerText.trim()),
      /** Words for one device, seen or not. */
      forKeys: document.querySelectorAll(".for-keys, .for-mouse, .with-pointer").length,
      forFingers: document.querySelectorAll(".for-touch, .with-finger").length,
    };
  });
const KEYS = /\b(keys?|Shift|Ctrl|Home|Page Up|wheel|mouse)\b|键|滚轮/;
const FINGERS = /\b(fingers?|tap|pinch)\b|双指|单指|手指/;

/** What moves by hand: figures and their controls; on the list of exhibits the cards. */
const FIGURE = ".stage *, .panel *, .scene, #hero-distance, [data-figure] *, .cards *";

/** How often one presses Tab until the focus is on a figure, past the link that skips to it; at most 20. */
async function stopsToFigure(page: Page): Promise<number> {
  for (let stops = 1; stops < 20; stops++) {
    await page.keyboard.press("Tab");
    if (await page.evaluate((figure) => document.activeElement!.matches(figure), FIGURE)) return stops;
  }
  return 20;
}

/** How many sentences are on the page, and those that are more than once. */
const repeated = (page: Page) =>
  page.evaluate(() => {
    const leaves = [...document.querySelectorAll("main :is(p, li, h1, h2, h3, figcaption, summary, dt)")];
    const texts = leaves.filter((element) => !element.querySelector("p, li, h1, h2, h3")).map((element) => element.textContent!);
    const sentences = texts.flatMap((text) => text.split(/(?<=[.!?])\s|[。！？：；;:]/)).map((text) => text.trim().replace(/[.!?]$/, ""));
    // A few words are a label, which may well stand twice.
    const long = sentences.filter((text) => (/\p{Script=Han}/u.test(text) ? text.length >= 10 : text.split(/\s+/).length >= 5));
    return { looked: long.length, twice: long.filter((text, k) => long.indexOf(text) < k) };
  });

describe.each(OPENED)("%s", (file) => {
  test("on a phone: axe finds nothing, no label is too small, nothing names a key, and no sentence stands twice", async () => {
    const page = await open(file, true);
    const { looked, small } = await smallTexts(page);
    expect(looked).toBeGreaterThan(10);
    expect(small).toEqual([]);
    const { all, forFingers } = await saidOn(page);
    expect(all).not.toMatch(KEYS);
    // What is for fingers is seen, or the words above are not those of the page.
    if (forFingers > 0) expect(all).toMatch(FINGERS);
    // The lesson has the controls and hints of all figures, which are alike.
    if (!file.startsWith("lesson")) {
      const { looked, twice } = await repeated(page);
      expect(looked).toBeGreaterThan(file.startsWith("workbench") ? 0 : 3);
      expect(twice).toEqual([]);
    }
    expect(await axeFindings(page)).toEqual([]);
    await page.context().close();
  });
  test("on a desk: nothing names a finger, axe finds nothing, and keys reach the first figure in ten stops", async () => {
    const page = await open(file, false);
    expect(await stopsToFigure(page)).toBeLessThanOrEqual(10);
    const { all, hints, forKeys } = await saidOn(page);
    expect(hints.length, "hints").toBeGreaterThanOrEqual(file.startsWith("exhibits") ? 0 : 1);
    expect(hints.length).toBe(hints.filter((hint) => hint.length > 0).length);
    expect(all).not.toMatch(FINGERS);
    if (forKeys > 0) expect(all).toMatch(KEYS);
    expect(await axeFindings(page)).toEqual([]);
    await page.context().close();
  });
});

describe("the head of every page", () => {
  const read = (file: string) => readFileSync(join(DIST, file), "utf8");
  const content = (html: string, name: string) => new RegExp(`<meta (?:name|property)="${name}" content="([^"]*)"`).exec(html)?.[1];

  test("has a title, a description, an icon, and a preview whose picture is there", () => {
    expect(PAGES).toEqual(expect.arrayContaining(["index.html", "zh.html", "lesson.html", "workbench.zh.html", "quad.html"]));
    for (const file of PAGES) {
      const html = read(file);
      const title = /<title>([^<]+)<\/title>/.exec(html)?.[1];
      expect(title, file).toBeTruthy();
      expect(content(html, "description")?.length, file).toBeGreaterThan(7);
      expect([content(html, "og:title"), content(html, "og:description")], file).toEqual([title, content(html, "description")]);
      expect(content(html, "twitter:card"), file).toBe("summary_large_image");
      expect(existsSync(join(DIST, content(html, "og:image")!)), file).toBe(true);
      expect(html, file).toMatch(/<link rel="icon" /);
      expect(html, file).toMatch(/<link rel="apple-touch-icon" href="icon.png" \/>/);
    }
  });
  test("the picture is as large as it says", () => {
    const html = read("index.html");
    const png = readFileSync(join(DIST, "preview.png"));
    expect([png.readUInt32BE(16), png.readUInt32BE(20)].map(String)).toEqual([content(html, "og:image:width"), content(html, "og:image:height")]);
  });
  test("names its other language by a page that exists and names it back, and every link leads to a file", () => {
    for (const file of PAGES) {
      const html = read(file);
      const alternates = [...html.matchAll(/<link rel="alternate" hreflang="([^"]+)" href="([^"]+)"/g)].map(([, tag, href]) => [tag, href] as const);
      expect(alternates.map(([tag]) => tag), file).toEqual(["en", "zh-CN"]);
      expect(alternates.map(([, href]) => href), file).toContain(file);
      for (const [tag, href] of alternates) expect(read(href!), `${file} → ${href}`).toContain(`<html lang="${tag}"`);
      const links = [...html.matchAll(/\shref="([^"#?]+)[^"]*"/g)].map((match) => match[1]!).filter((href) => !/^(data|https?|mailto):/.test(href));
      expect(links.length, file).toBeGreaterThan(5);
      expect(links.filter((href) => !existsSync(join(DIST, href))), file).toEqual([]);
    }
  });
});

test("no style uses a blend mode that PDF lacks", () => {
  // ISO 32000-1, 11.3.5.
  const known = "normal multiply screen overlay darken lighten color-dodge color-burn hard-light soft-light difference exclusion hue saturation color luminosity";
  const styles = readdirSync(join(DIST, "assets")).filter((name) => name.endsWith(".css"));
  const modes = styles.flatMap((name) => [...readFileSync(join(DIST, "assets", name), "utf8").matchAll(/blend-mode:\s*([\w-]+)/g)].map((match) => match[1]!));
  expect(modes.length).toBeGreaterThan(0);
  expect(modes.filter((mode) => !known.split(" ").includes(mode))).toEqual([]);
});
