// The exhibits of the lesson's third part: each number changes as the exhibit claims, by mouse and keys.
import { afterAll, afterEach, beforeAll, expect, test } from "vitest";
import { ExhibitPages, drag, grip, live } from "./exhibit_page";
import { STOPS, WIDGET, fileOfStop } from "../../src/exhibits/index";
import { digits, isLong, axeFindings, settled } from "./site";

let pages: ExhibitPages;
beforeAll(async () => {
  pages = await ExhibitPages.open();
});
afterEach(() => expect(pages.errors).toEqual([]));
afterAll(() => pages.close());

test("bernstein: no weight is negative between the ends, one is beyond them, and they always sum to one", async () => {
  const page = await pages.at("bernstein.html");
  const before = (await pages.state("bernstein"))["t"] as number;
  await drag(page, grip(page), 60, -20);
  expect((await pages.state("bernstein"))["t"]).toBeGreaterThan(before + 0.03);
  for (const form of isLong ? ["arch", "wave", "loop"] : ["wave"]) {
    await page.locator(`input[name=form][value=${form}]`).check();
    for (const [t, isInside] of [["0", true], ["0.5", true], ["1", true], ["-0.1", false], ["1.1", false]] as const) {
      await page.locator("#t").fill(t);
      const smallest = await pages.number("bernstein");
      expect(smallest >= 0, `${form} ${t}`).toBe(isInside);
      expect(await digits(page, "sum")).toBeCloseTo(1, 14);
      expect(await page.locator(".live.good").count()).toBe(isInside ? 1 : 0);
    }
  }
  await grip(page).focus();
  await page.keyboard.press("Home");
  expect(await pages.number("bernstein")).toBeLessThan(-0.3);
  expect(await digits(page, "weight-1")).toBeLessThan(0);
});

test("bernstein: the construction stays in the figure for every t", async () => {
  const page = await pages.on("bernstein.html", "#v=1");
  const opacities = await page.locator(".weighted .label").evaluateAll((all) => all.map((one) => getComputedStyle(one).fillOpacity));
  expect(opacities, "each name is as dark as the others").toEqual(["1", "1", "1", "1"]);
  for (const form of isLong ? ["arch", "wave", "loop", "spout"] : ["loop", "spout"]) {
    await page.locator(`input[name=form][value=${form}]`).check();
    for (const t of ["-0.1", "-0.05", "0.5", "1.05", "1.1"]) {
      await page.locator("#t").fill(t);
      await settled(page);
      const out = await page.evaluate(() => {
        const svg = document.querySelector<SVGSVGElement>("svg.flat")!;
        const frame = svg.getBoundingClientRect();
        const seen = [...svg.querySelectorAll(".mark, .control, .level, .beyond, .grip .dot")].map((one) => one.getBoundingClientRect());
        const out = seen.filter((box) => box.left < frame.left || box.right > frame.right || box.top < frame.top || box.bottom > frame.bottom);
        return { looked: seen.length, out };
      });
      expect(out.looked, `${form} ${t}`).toBeGreaterThan(8);
      expect(out.out, `${form} ${t}`).toEqual([]);
    }
  }
});

test("joins: the chosen class is kept, the handle breaks higher ones, and the reflection is a picture", async () => {
  const page = await pages.at("joins.html");
  expect(await pages.number("joins")).toBe(1);
  for (const [keep, left] of [["C0", 0], ["C1", 1], ["C2", 2]] as const) {
    if (!isLong && keep === "C1") continue;
    await page.locator(`input[name=keep][value=${keep}]`).check();
    await settled(page);
    await page.locator(".panel .buttons button").click();
    expect(await pages.number("joins"), `${keep} at home`).toBe(2);
    expect(await digits(page, "curvature-gap")).toBeLessThan(1e-12);
    const before = await page.locator(".flat image").getAttribute("href");
    await drag(page, grip(page), -20, -30);
    expect(await pages.number("joins"), keep).toBe(left);
    expect((await digits(page, "angle")) > 5).toBe(left === 0);
    expect((await digits(page, "curvature-gap")) > 0.05).toBe(left < 2);
    expect(await page.locator(".flat image").getAttribute("href")).not.toBe(before);
  }
  const size = await page.evaluate(async () => {
    const image = new Image();
    image.src = document.querySelector(".flat image")!.getAttribute("href")!;
    await image.decode();
    return [image.naturalWidth, image.naturalHeight];
  });
  expect(size).toEqual([480, 156]);
});

test("runge: the rest of the polynomial moves several times as far as the point, the rest of the spline hardly", async () => {
  const page = await pages.at("runge.html#v=1&h=0.2");
  const point = (n: number) => page.getByRole("slider", { name: `Point ${n}`, exact: true }).and(page.locator(".grip"));
  const one = await pages.number("runge");
  expect(one).toBeGreaterThan(5 * 0.2);
  expect(await digits(page, "spline-moves")).toBeLessThan(0.2 / 5);
  await point(6).focus();
  for (let i = 0; i < 4; i++) await page.keyboard.press("ArrowUp");
  expect(await pages.number("runge")).toBeCloseTo(2 * one, 9);
  await page.locator("#count").fill("15");
  expect(await pages.number("runge")).toBeGreaterThan(6 * one);
  await drag(page, point(8), 0, 40);
  expect((await pages.state("runge"))["lift"]).toBeLessThan(0.1);
  await drag(page, point(3), 0, -20);
  expect((await pages.state("runge"))["row"]).toBe(-5);
  expect(await pages.number("runge")).toBeGreaterThan(0.2);
  await page.locator("#lift").fill("0");
  expect(await pages.number("runge")).toBe(0);
  await page.locator("#count").fill("11");
  await settled(page);
  expect(await digits(page, "polynomial-misses")).toBeCloseTo(1.916, 2);
});

test("cracks: different numbers crack, equal ones do not, and a side that is cut once never does", async () => {
  const page = await pages.at("cracks.html");
  await live(page);
  const before = await pages.number("cracks");
  expect(before).toBeGreaterThan(5);
  expect(await digits(page, "components")).toBe(2);
  await page.locator(".scene").focus();
  for (let i = 0; i < 6; i++) await page.keyboard.press("-");
  // At half the distance the crack is twice as wide.
  expect(await pages.number("cracks")).toBeLessThan(0.8 * before);
  await page.locator("#right").fill("3");
  expect(await pages.number("cracks")).toBe(0);
  expect(await digits(page, "lonely")).toBe(0);
  await page.locator("#right").fill("6");
  expect(await pages.number("cracks")).toBeGreaterThan(1);
  expect(await digits(page, "lonely")).toBe(3);
  await page.locator("input[name=cut][value=shared]").check();
  for (const right of ["1", "2", "5", "6", "12"]) {
    await page.locator("#right").fill(right);
    expect(await pages.number("cracks"), right).toBe(0);
    expect([await digits(page, "components"), await digits(page, "lonely")]).toEqual([1, 0]);
  }
  await page.locator("input[name=patches][value=spout]").check();
  expect(await pages.number("cracks")).toBe(0);
  await page.locator("input[name=cut][value=own]").check();
  expect(await pages.number("cracks")).toBeGreaterThan(1);
  await page.locator("#right").fill("3");
  expect(await pages.number("cracks")).toBe(0);
});

test("cage: each round has four times the faces and leaves about a quarter of the error, and a crease delays that", async () => {
  const page = await pages.at("cage.html");
  await live(page);
  await page.locator("#level").fill("5");
  const last = await pages.number("cage");
  expect(await digits(page, "faces")).toBe(14 * 4 ** 5);
  const errors = await Promise.all([0, 1, 2, 3, 4, 5].map((n) => digits(page, `error-${n}`)));
  expect(errors[5]).toBe(last);
  for (const n of [3, 4, 5]) {
    const ratio = errors[n - 1]! / errors[n]!;
    expect(ratio > 3.8 && ratio < 4.2, `round ${n}: ${ratio}`).toBe(true);
  }
  await page.locator("#sharpness").fill("2");
  expect(await pages.number("cage")).toBeGreaterThan(1.5 * last);
  await page.locator("#level").focus();
  await page.keyboard.press("Home");
  expect(await pages.number("cage")).toBeGreaterThan(0.3);
  await page.locator("input[name=show][value=limit]").check();
  await settled(page);
  expect(await page.locator(".ramp-scale rect").count()).toBe(8);
});

test("the tour leads through the widget, in the reader's language, but not in a frame", async () => {
  const n = STOPS.indexOf(WIDGET);
  expect(fileOfStop(STOPS[n - 1]!, "en")).toBe("pull.html");
  expect(fileOfStop(STOPS[n + 1]!, "en")).toBe("cracks.html");
  let page = await pages.at("index.html");
  const shown = () => page.locator(".onward a:not(.to-bench, .to-all):visible").evaluateAll((links) => links.map((link) => link.getAttribute("href")));
  expect(await shown()).toEqual(["pull.html", "cracks.html"]);
  expect(await page.locator(".onward .to-all:visible").getAttribute("href")).toBe("exhibits.html");
  expect(await axeFindings(page)).toEqual([]);
  await page.getByRole("button", { name: "中文" }).click();
  await settled(page);
  expect(await shown()).toEqual(["pull.zh.html", "cracks.zh.html"]);
  await page.locator(".onward a[rel=next]:visible").click();
  await page.waitForURL(/cracks\.zh\.html$/);
  await page.waitForSelector("html[data-ready]");
  await page.locator(".onward a[rel=prev]").click();
  await page.waitForURL(/zh\.html$/);
  page = await pages.at("index.html?embed=1");
  expect(await shown()).toEqual([]);
});
