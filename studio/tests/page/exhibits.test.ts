// Checks of every exhibit's page and of their surroundings: text and figure before any script, the core's numbers, axe, widths,
// frames, damaged addresses, the list of exhibits, the viewer.
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, test } from "vitest";
import { EXHIBITS, PARTS, STOPS, fileOf, fileOfStop } from "../../src/exhibits/index";
import { LANGUAGES, type Language, TAGS } from "../../src/exhibits/say";
import { ExhibitPages, live } from "./exhibit_page";
import { DIST, digits, isLong, axeFindings, settled } from "./site";

let pages: ExhibitPages;
/** A browser without scripts. */
let stillPage: Page;
beforeAll(async () => {
  pages = await ExhibitPages.open();
  stillPage = (await pages.site.visit("exhibits.html", { javaScriptEnabled: false })).page;
});
afterAll(() => pages.close());

/**
 * `make test` opens every third exhibit in one of the two languages, the next ones in the other, and others in a frame. Each
 * exhibit has another test, in the file of its part of the lesson.
 */
const numberOf = (id: string) => EXHIBITS.findIndex((entry) => entry.id === id);
const isSeen = (id: string) => isLong || numberOf(id) % 3 === 0;
const isFramed = (id: string) => isLong || numberOf(id) % 4 === 2;
const languagesOf = (id: string): readonly Language[] => (isLong ? LANGUAGES : [LANGUAGES[numberOf(id) % LANGUAGES.length]!]);

/** Each theme and language, once wide and once narrow; half of them only in `make test-long`. */
const LOOKS = {
  en: [["light", 1200], ["dark", 360]],
  zh: [["dark", 360], ["light", 1200]],
} as const;
const looksOf = (language: Language) => LOOKS[language].slice(0, isLong ? 2 : 1);

describe.each(EXHIBITS.map((entry) => [entry.id, entry] as const))("%s", (id, entry) => {
  const inEach = test.runIf(isSeen(id)).each(languagesOf(id));
  inEach("says its number as the core does, before and after it is brought to life, and leads on (%s)", async (language) => {
    await stillPage.goto(pages.site.base + fileOf(id, language));
    expect(await stillPage.locator("h1").textContent()).toBe(entry.claim[language]);
    expect(await stillPage.locator("html").getAttribute("lang")).toBe(TAGS[language]);
    const before = await digits(stillPage, "live");
    expect(await stillPage.locator(".stage svg path, .stage svg circle").count()).toBeGreaterThan(5);
    expect(await stillPage.locator("[style]").count(), "a strict policy forbids styles in the text").toBe(0);

    const page = await pages.at(fileOf(id, language));
    expect(await pages.number(id)).toBe(before);
    const n = STOPS.indexOf(entry);
    const [last, next] = [STOPS[n - 1], STOPS[n + 1]];
    const onward = page.locator(".onward a:not(.to-bench)");
    expect(await onward.last().getAttribute("href")).toBe(next ? fileOfStop(next, language) : fileOf("exhibits", language));
    expect(await page.locator(".onward .to-bench").getAttribute("href")).toBe(language === "en" ? "workbench.html" : "workbench.zh.html");
    expect(await onward.first().getAttribute("href")).toBe(last ? fileOfStop(last, language) : fileOf("exhibits", language));
    expect(await page.locator(".path [aria-current=page]").textContent()).toBe(entry.title[language]);
    expect(await page.locator(".path [aria-current=true]").textContent()).toBe(PARTS[entry.part][language]);
    expect(await page.locator(".path .stops a").count()).toBe(STOPS.filter(({ part }) => part === entry.part).length);

    for (const [colorScheme, width] of looksOf(language)) {
      await page.emulateMedia({ colorScheme, reducedMotion: "reduce" });
      await page.setViewportSize({ width, height: 800 });
      await settled(page);
      expect(await axeFindings(page), `axe, ${colorScheme}, ${width} wide`).toEqual([]);
      expect(await page.evaluate(() => document.documentElement.scrollWidth), "nothing sticks out").toBeLessThanOrEqual(width);
    }
    // In print, dark colours become those of paper.
    await page.emulateMedia({ media: "print", colorScheme: "dark" });
    await settled(page);
    expect(await onPaper(page)).toEqual({ paper: "rgb(255, 255, 255)", ink: "rgb(0, 0, 0)", pressed: [], canvases: 0, isDrawn: true, isWhole: true });
    expect(pages.errors).toEqual([]);
  });

  const inFrame = test.runIf(isFramed(id));
  inFrame("embedded it is figure, claim, number and controls; what is damaged in an address is told, and it works", async () => {
    const page = await pages.at(`${fileOf(id, "en")}?embed=1#v=1&p=%%&o=1&h=x&n=x&c=x&s=x&b=x&f=x`);
    expect(await page.locator("header, footer, .prose, .onward").count()).toBe(0);
    expect(await page.locator("h1").textContent()).toBe(entry.claim.en);
    expect(await page.locator(".note").textContent()).toContain("could not be read");
    await pages.number(id);
  });
});

/** The pages that would be printed. */
function onPaper(page: Page) {
  return page.evaluate(() => {
    const seen = (what: string) => [...document.querySelectorAll(what)].filter((one) => one.checkVisibility());
    const { backgroundColor, color } = getComputedStyle(document.body);
    return {
      paper: backgroundColor,
      ink: color,
      pressed: seen("button, input, select, nav").map((one) => one.outerHTML.slice(0, 60)),
      canvases: seen("canvas").length,
      isDrawn: seen(".stage svg path, .stage svg circle").length > 5,
      isWhole: seen(".stage, .live, .prose p, .attempts li").length === document.querySelectorAll(".stage, .live, .prose p, .attempts li").length,
    };
  });
}

/** A4 less a centimetre on each side, at 96 pixels an inch. */
const SHEET = { width: Math.floor((190 / 25.4) * 96), height: (277 / 25.4) * 96 };

// Levels takes longest to open.
const PRINTED = isLong ? ["quad", "doctor", "levels"] : ["quad", "doctor"];
test.each(PRINTED)("%s is printed without empty sheets, with its figure", async (id) => {
  const page = await pages.at(fileOf(id, "en"), { colorScheme: "dark" });
  await live(page);
  const margin = "10mm";
  const sheets = (await page.pdf({ format: "A4", margin: { top: margin, right: margin, bottom: margin, left: margin } })).toString("latin1");
  const count = sheets.match(/\/Type\s*\/Page\b/g)!.length;
  // Afterwards the screen is as before.
  expect(await page.locator(".scene canvas").isVisible()).toBe(true);
  await page.setViewportSize({ width: SHEET.width, height: 800 });
  await page.emulateMedia({ media: "print" });
  await settled(page);
  const end = await page.evaluate(() => Math.max(...[...document.querySelectorAll("p, li, svg")].map((one) => one.getBoundingClientRect().bottom + scrollY)));
  expect(count).toBe(Math.ceil(end / SHEET.height));
});

test("one address shows every exhibit in a frame, in the reader's language, with its fragment", async () => {
  const page = await pages.site.browser.newPage({ locale: "en-GB", serviceWorkers: "block" });
  const met = async (address: string, wanted: string) => {
    await page.setContent(`<iframe src="${pages.site.base}${address}" width="700" height="700" title="figure"></iframe>`);
    const frame = page.frameLocator("iframe");
    await frame.locator("html[data-ready]").waitFor({ state: "attached" });
    const { href, embedded } = await frame.locator("html").evaluate((html) => ({ href: location.href, embedded: html.dataset["embedded"] }));
    expect(href, address).toBe(pages.site.base + wanted);
    return { frame, embedded };
  };
  const { frame, embedded } = await met("index.html?embed=1&exhibit=quad#v=1&h=0.3", "quad.html?embed=1#v=1&h=0.3");
  expect(embedded).toBe("1");
  expect(Number(await frame.locator('[data-name="live"]').getAttribute("value"))).toBeCloseTo(0.3, 12);
  expect(await frame.locator("header, footer, .onward, .note").count()).toBe(0);
  const names = await (await page.request.get(`${pages.site.base}language.js`)).text();
  expect(names).toContain(`exhibits = ${JSON.stringify(EXHIBITS.map(({ id }) => id))}`);
  await met("zh.html?embed=1&exhibit=csg#v=1&b=difference", "csg.zh.html?embed=1#v=1&b=difference");
  await met("?exhibit=quad&embed=1#l=zh&v=1&h=0.3", "quad.zh.html?embed=1#v=1&h=0.3");
  await met("zh.html?exhibit=quad#v=1&h=0.3&l=en", "quad.html#v=1&h=0.3");
  // An unknown name shows the widget's frame.
  for (const name of ["../quad", "__proto__", ...(isLong ? ["nothing", "javascript:alert(1)", ""] : [])]) {
    const address = `index.html?embed=1&exhibit=${encodeURIComponent(name)}#v=1&n=9`;
    const { frame } = await met(address, address);
    expect(await frame.locator("svg[data-figure=curve]").count()).toBe(1);
  }
  await page.close();
});

test("axe finds what it should: a button without a name, text with too little contrast", async () => {
  const page = await pages.site.browser.newPage();
  await page.setContent('<html lang="en"><title>x</title><main><h1>x</h1><button></button><p style="color: #aaa; background: #fff">pale</p></main>');
  const rules = (await axeFindings(page)).map((finding) => finding.split(":")[0]);
  expect(rules.sort()).toEqual(["button-name", "color-contrast"]);
  await page.close();
});

test("every page links to its versions in both languages, which exist, and has an icon", async () => {
  const names = readdirSync(DIST).filter((name) => name.endsWith(".html"));
  expect(names).toContain("workbench.zh.html");
  for (const name of names) {
    const html = readFileSync(join(DIST, name), "utf8");
    const links = [...html.matchAll(/<link rel="alternate" hreflang="([^"]+)" href="([^"]+)"/g)].map(([, tag, file]) => [tag, file]);
    expect(links.map(([tag]) => tag), name).toEqual([TAGS.en, TAGS.zh]);
    for (const [, file] of links) expect(names, `${name} names ${file}`).toContain(file);
    expect(links.some(([, file]) => file === name), name).toBe(true);
    expect(html, name).toMatch(/<link rel="icon" [^>]*href="data:image\/svg/);
  }
});

test("the list of exhibits has a figure and a link for each, and works without script", async () => {
  for (const language of isLong ? LANGUAGES : LANGUAGES.slice(0, 1)) {
    await stillPage.goto(pages.site.base + fileOf("exhibits", language));
    for (const { id, title } of EXHIBITS) {
      const card = stillPage.locator(`.cards a[href="${fileOf(id, language)}"]`);
      expect(await card.locator("h3").textContent()).toContain(title[language]);
      // What looks alike is one path.
      const isFile = (await card.locator("img.still").count()) === 1;
      expect(isFile || (await card.locator("svg path").count()) > 2, id).toBe(true);
    }
    const { page } = await pages.site.visit(fileOf("exhibits", language));
    expect(await axeFindings(page)).toEqual([]);
    await page.context().close();
  }
});

test("the other language's page opens with the same state", async () => {
  const page = await pages.at("quad.html#v=1&h=0.3");
  await page.getByRole("link", { name: "中文" }).click();
  await page.waitForURL(/quad\.zh\.html#v=1&h=0\.3$/);
  await page.waitForSelector("html[data-settled]");
  expect(await pages.number("quad")).toBeCloseTo(0.3, 12);
});

test("the viewer draws only after a change, and a lost context is restored", async () => {
  const page = await pages.at("culling.html", {
    prepare: (page) =>
      page.addInitScript(() => {
        const work = { draws: 0 };
        Object.assign(window, { work });
        for (const name of ["drawArrays", "drawElements", "drawArraysInstanced"] as const) {
          const draw = WebGL2RenderingContext.prototype[name] as (...args: unknown[]) => void;
          Object.assign(WebGL2RenderingContext.prototype, {
            [name](this: WebGL2RenderingContext, ...args: unknown[]) {
              work.draws += 1;
              draw.apply(this, args);
            },
          });
        }
      }),
  });
  await live(page);
  const draws = () => page.evaluate(() => (window as unknown as { work: { draws: number } }).work.draws);
  // A request is drawn within a few frames; after that nothing is drawn without a change.
  await page.evaluate(async (frames) => {
    const { work } = window as unknown as { work: { draws: number } };
    for (let before = -1, still = 0; still < frames; still = work.draws === before ? still + 1 : 0) {
      before = work.draws;
      await new Promise(requestAnimationFrame);
    }
  }, 24);
  const before = await draws();
  expect(before).toBeGreaterThan(0);
  await page.locator(".scene").focus();
  await page.keyboard.press("ArrowLeft");
  await settled(page);
  expect(await draws()).toBeGreaterThan(before);
  const lost = await page.evaluate(async () => {
    const canvas = document.querySelector<HTMLCanvasElement>(".scene canvas")!;
    const { work } = window as unknown as { work: { draws: number } };
    const extension = canvas.getContext("webgl2")!.getExtension("WEBGL_lose_context")!;
    const next = (type: string) => new Promise((done) => canvas.addEventListener(type, done, { once: true }));
    const gone = next("webglcontextlost");
    extension.loseContext();
    await gone;
    const before = work.draws;
    const back = next("webglcontextrestored");
    // The browser restores a context only after its loss was handled.
    setTimeout(() => extension.restoreContext(), 50);
    await back;
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    return work.draws - before;
  });
  expect(lost).toBeGreaterThan(0);
});

test("without WebGL the figure is drawn as flat shapes, and still turns and counts", async () => {
  const page = await pages.at("culling.html#v=1&f=", {
    prepare: (page) =>
      page.addInitScript(() => {
        const get = HTMLCanvasElement.prototype.getContext;
        Object.assign(HTMLCanvasElement.prototype, {
          getContext(this: HTMLCanvasElement, kind: string, ...rest: unknown[]) {
            return kind.startsWith("webgl") ? null : (get as (...args: unknown[]) => unknown).call(this, kind, ...rest);
          },
        });
      }),
  });
  await page.waitForSelector('.scene[data-viewer="svg"]');
  const before = await page.locator(".scene svg").innerHTML();
  await page.locator(".scene").focus();
  await page.keyboard.press("ArrowLeft");
  await settled(page);
  expect(await page.locator(".scene svg").innerHTML()).not.toBe(before);
  const box = (await page.locator(".scene").boundingBox())!;
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await settled(page);
  expect(await pages.number("culling")).toBe(1);
});
