// The reader's colours: chosen on any page, applied on all before anything is drawn, remembered if storage is allowed.
import type { Page } from "playwright-core";
import { afterAll, beforeAll, expect, test } from "vitest";
import { live } from "./exhibit_page";
import { Site, isLong, settled } from "./site";

let site: Site;
beforeAll(async () => {
  site = await Site.open();
});
afterAll(() => site.close());

const paper = (page: Page) => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
const choose = (page: Page, theme: string) => page.locator("select[data-themes]").selectOption(theme);

test("a choice on one page applies to every other, until it is the system's again", async () => {
  const { page, errors } = await site.visit("exhibits.html");
  const light = await paper(page);
  await choose(page, "dark");
  const dark = await paper(page);
  expect(dark).not.toBe(light);
  const files = ["", "csg.zh.html", "workbench.html", "quad.html?embed=1"];
  for (const file of isLong ? [...files, "zh.html", "quad.html", "exhibits.zh.html"] : files) {
    await page.goto(site.base + file);
    await page.waitForSelector("html[data-ready], .exhibits");
    expect(await paper(page), file).toBe(dark);
    const chosen = await page.locator("select[data-themes]").evaluateAll((all) => all.map((select) => (select as HTMLSelectElement).value));
    expect(chosen, file).toEqual(file.includes("embed") ? [] : ["dark"]);
  }
  await page.goto(`${site.base}quad.zh.html`);
  await page.waitForSelector("html[data-ready]");
  await choose(page, "light");
  await page.emulateMedia({ colorScheme: "dark" });
  expect(await paper(page)).toBe(light);
  await page.reload();
  await page.waitForSelector("html[data-ready]");
  expect(await paper(page)).toBe(light);
  await choose(page, "auto");
  expect(await paper(page)).toBe(dark);
  expect(errors).toEqual([]);
  await page.context().close();
});

test("other open pages follow", async () => {
  const { page } = await site.at("quad.html");
  const other = await page.context().newPage();
  await other.goto(`${site.base}inside.html`);
  await choose(page, "dark");
  await other.waitForSelector('html[data-theme="dark"]');
  await other.close();
});

test.each(["index.html", "quad.zh.html", "exhibits.html", "workbench.html"])("%s applies it before its first frame, without its modules", async (file) => {
  const prepare = async (page: Page) => {
    await page.route("**/assets/*.js", (route) => route.abort());
    await page.addInitScript(() => {
      localStorage.setItem("chordal theme", "dark");
      const seen: string[] = [];
      Object.assign(window, { seen });
      const look = () => {
        if (document.body) seen.push(getComputedStyle(document.documentElement).colorScheme);
        requestAnimationFrame(look);
      };
      requestAnimationFrame(look);
    });
  };
  const { page } = await site.visit(file, { prepare, colorScheme: "light" });
  await page.waitForFunction(() => (window as unknown as { seen: string[] }).seen.length > 3);
  expect(new Set(await page.evaluate(() => (window as unknown as { seen: string[] }).seen))).toEqual(new Set(["dark"]));
  expect(await page.locator('meta[name="color-scheme"]').getAttribute("content")).toBe("dark");
  await page.context().close();
});

test("without storage the choice lasts as long as the page", async () => {
  const prepare = (page: Page) =>
    page.addInitScript(() => {
      const refuse = () => {
        throw new DOMException("refused", "SecurityError");
      };
      Object.defineProperty(window, "localStorage", { get: refuse });
    });
  const { page, errors } = await site.visit("quad.html", { prepare });
  await page.waitForSelector("html[data-ready]");
  const light = await paper(page);
  await choose(page, "dark");
  expect(await paper(page)).not.toBe(light);
  await page.evaluate(() => (location.hash = "#v=1&h=0.2"));
  await settled(page);
  expect(await paper(page)).not.toBe(light);
  await page.reload();
  await page.waitForSelector("html[data-ready]");
  expect(await paper(page)).toBe(light);
  expect(errors).toEqual([]);
  await page.context().close();
});

test("a 3D figure is the same to the last pixel, with the reader's theme or the system's", async () => {
  const picture = async (colorScheme: "light" | "dark", theme: string) => {
    const { page } = await site.at("quad.html", { colorScheme });
    await live(page);
    await choose(page, theme);
    await settled(page);
    return (await page.locator(".scene").screenshot()).toString("base64");
  };
  const [day, night] = [await picture("light", "auto"), await picture("dark", "auto")];
  expect(day).not.toBe(night);
  expect(await picture("light", "dark")).toBe(night);
  expect(await picture("dark", "light")).toBe(day);
});

test("the widget's address may name a theme, which is not remembered; a choice by the reader replaces it", async () => {
  const { page } = await site.at("#v=1&n=9&h=d");
  expect(await page.locator("html").getAttribute("data-theme")).toBe("dark");
  expect(await page.locator("select[data-themes]").inputValue()).toBe("dark");
  await choose(page, "light");
  await settled(page);
  expect(await page.locator("html").getAttribute("data-theme")).toBe("light");
  expect(new URL(page.url()).hash).toBe("#v=1&n=9");
  await page.goto(`${site.base}#v=1&h=d`);
  await page.reload();
  await page.goto(`${site.base}quad.html`);
  expect(await page.locator("html").getAttribute("data-theme")).toBe("light");
});

test("without script there is no control for it", async () => {
  const { page } = await site.visit("quad.html", { javaScriptEnabled: false });
  expect(await page.locator("select[data-themes]").isVisible()).toBe(false);
  await page.context().close();
});
