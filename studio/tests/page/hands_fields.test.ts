// The exhibits in which a reader moves an eye, a loupe, balls, a drill or a threshold: their numbers are the core's and change as
// their claims say.
import { afterAll, afterEach, beforeAll, expect, test } from "vitest";
import { ExhibitPages, drag, grip, live } from "./exhibit_page";
import { digits, settled } from "./site";

let pages: ExhibitPages;
beforeAll(async () => {
  pages = await ExhibitPages.open();
});
afterEach(() => expect(pages.errors).toEqual([]));
afterAll(() => pages.close());

test("adaptive: every cause that is left out costs triangles, and the eye can be dragged in the side view", async () => {
  const page = await pages.at("adaptive.html");
  await live(page);
  const counts = [await pages.number("adaptive")];
  expect(await digits(page, "outline")).toBeLessThanOrEqual(4);
  for (const cut of ["outline", "near", "bends"]) {
    await page.locator(`input[name=${cut}]`).uncheck({ force: true });
    counts.push(await pages.number("adaptive"));
  }
  expect(counts).toEqual([...counts].sort((a, b) => a - b));
  expect(new Set(counts).size).toBe(4);
  // The table has what has been tried from this eye.
  const shown = await page.locator(".panel dl dd").allTextContents();
  expect(shown.slice(0, 4).map((text) => Number(text.replace(/,/g, "")))).toEqual([...counts].reverse());
  for (const cut of ["bends", "near", "outline"]) await page.locator(`input[name=${cut}]`).check({ force: true });
  const before = (await pages.state("adaptive"))["view"];
  await drag(page, page.locator(".aside-scene .grip"), 40, 10);
  await pages.number("adaptive");
  expect((await pages.state("adaptive"))["view"]).not.toEqual(before);
  // Keys move it, too.
  const dragged = (await pages.state("adaptive"))["view"];
  await page.locator(".aside-scene .grip").focus();
  await page.keyboard.press("ArrowLeft");
  await pages.number("adaptive");
  expect((await pages.state("adaptive"))["view"]).not.toEqual(dragged);
});

test("mountain: both stay within the pixels, and from afar the teapot needs few triangles; the loupe moves", async () => {
  const page = await pages.at("mountain.html");
  const near = await pages.number("mountain");
  for (const name of ["teapot-pixels", "mountain-pixels"]) expect(await digits(page, name)).toBeLessThanOrEqual(2);
  expect(await digits(page, "mountain-allowed")).toBeGreaterThan(1000 * (await digits(page, "teapot-allowed")));
  const chords = await page.locator(".loupe-of-pixels .teapot .chords").getAttribute("d");
  expect(chords).toContain("M");
  await drag(page, grip(page), 30, 20);
  await pages.number("mountain");
  expect(await page.locator(".loupe-of-pixels .teapot .chords").getAttribute("d")).not.toBe(chords);
  await page.locator("#distance").fill("16");
  expect(await pages.number("mountain")).toBeLessThan(near);
});

test("shimmer: triangles below a pixel flicker, those of four pixels hardly; it turns by keys, and by itself if motion is wanted", async () => {
  const page = await pages.at("shimmer.html");
  const fine = await pages.number("shimmer");
  expect(fine).toBeGreaterThan(100);
  await page.locator("input[name=size]").nth(3).check();
  expect(await pages.number("shimmer")).toBeLessThan(fine / 10);
  await grip(page).focus();
  await page.keyboard.press("ArrowRight");
  await pages.number("shimmer");
  expect((await pages.state("shimmer"))["frame"]).toBe(61);
  await page.emulateMedia({ reducedMotion: "no-preference" });
  await page.getByRole("button", { name: "Let it turn" }).click();
  await page.waitForFunction(() => Number(document.querySelector<HTMLInputElement>("#frame")!.value) > 63);
  await page.getByRole("button", { name: "Stop" }).click();
  await settled(page);
  await page.emulateMedia({ reducedMotion: "reduce" });
  expect(await page.locator(".moving").isVisible()).toBe(false);
});

test("network: the threshold and the lattice change the mesh, and the point reads occupancy and true distance", async () => {
  const page = await pages.at("network.html");
  await live(page);
  expect(await pages.number("network")).toBeGreaterThan(0.9);
  expect(await digits(page, "weights")).toBe(353);
  const inside = await digits(page, "inside");
  await page.locator("#threshold").fill("95");
  await pages.number("network");
  expect(await digits(page, "inside")).toBeLessThan(inside);
  await page.locator("#cells").fill("40");
  await pages.number("network");
  expect(await digits(page, "samples")).toBe(41 ** 3);
  await page.evaluate(() => (location.hash = "#v=1&p=0.9,0,0.9"));
  expect(await pages.number("network")).toBeLessThan(0.1);
});

test("cubes: twice the cells cross about four times as many, and the mesher that knows the parts keeps the edges", async () => {
  const page = await pages.at("cubes.html");
  await live(page);
  const coarse = await pages.number("cubes");
  const crossed = await digits(page, "crossed");
  await page.locator("#cells").fill("20");
  expect(await pages.number("cubes")).toBeLessThan(coarse);
  const ratio = (await digits(page, "crossed")) / crossed;
  expect(ratio).toBeGreaterThan(3);
  expect(ratio).toBeLessThan(6);
  await page.locator("input[name=method][value=corners]").check();
  expect(await pages.number("cubes")).toBeLessThan(coarse / 4);
  const before = (await pages.state("cubes"))["slice"];
  await grip(page).focus();
  await page.keyboard.press("ArrowUp");
  await pages.number("cubes");
  expect((await pages.state("cubes"))["slice"]).toBeGreaterThan(before as number);
});

test("booleans: the textbook method leaves open edges near the lower face, the field nowhere", async () => {
  const page = await pages.at("booleans.html");
  await live(page);
  expect(await pages.number("booleans")).toBeGreaterThan(0);
  await page.locator("input[name=way][value=field]").check();
  expect(await pages.number("booleans")).toBe(0);
  await page.locator("input[name=way][value=textbook]").check();
  await page.locator("#tip").fill("1");
  expect(await pages.number("booleans")).toBe(0);
  const before = (await pages.state("booleans"))["place"];
  await drag(page, grip(page), 30, 0);
  await pages.number("booleans");
  expect((await pages.state("booleans"))["place"]).not.toEqual(before);
});

test("blend: the value is a lower bound outside, and the distance if there is no blend", async () => {
  const page = await pages.at("blend.html");
  const share = await pages.number("blend");
  expect(share).toBeLessThan(0.99);
  expect(await digits(page, "value")).toBeLessThanOrEqual(await digits(page, "min"));
  const pieces = await digits(page, "pieces");
  await page.locator("#width").fill("0");
  expect(await pages.number("blend")).toBeCloseTo(1, 2);
  await page.evaluate(() => (location.hash = "#v=1&a=3,4&b=9.5,4&n=0"));
  await pages.number("blend");
  expect(await digits(page, "pieces")).toBe(pieces + 1);
  await grip(page).focus();
  await page.keyboard.press("ArrowRight");
  await pages.number("blend");
  expect((await pages.state("blend"))["first"]).toEqual([3.1, 4]);
});

test("csg, tracing and squares: their shapes can be dragged, and the numbers follow", async () => {
  for (const [id, name] of [["csg", "Disc A"], ["tracing", "Ball"], ["squares", "Square"]] as const) {
    const page = await pages.at(`${id}.html`);
    const before = await pages.number(id);
    await drag(page, page.getByRole("slider", { name, exact: true }), 35, 25);
    const after = await pages.number(id);
    expect(new URL(page.url()).hash, id).toMatch(/&a=/);
    if (id !== "squares") continue;
    expect(after).not.toBe(before);
  }
});
