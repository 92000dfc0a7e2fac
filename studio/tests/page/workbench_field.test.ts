// The field beside the mesh as the graphics card draws it: while one turns it and drags numbers, until the core's picture of the
// same view is there.
import { afterAll, afterEach, beforeAll, expect, test, vi } from "vitest";
import { Site, settled } from "./site";
import { PATIENCE, Workbenches, faults, panel, small, write } from "./workbench_page";

vi.setConfig(PATIENCE);

let site: Site;
let pages: Workbenches;
beforeAll(async () => {
  site = await Site.open();
  pages = new Workbenches(site);
});
afterEach((context) => pages.close(context));
afterAll(() => site.close());

/** A page that draws fields although the processor does the work. */
const open = async (script: string) => {
  const visit = await pages.open((await small(script)).replace("#", "?live=1#"));
  // Fields are drawn while their panel is seen.
  await panel(visit.page, "beside");
  return visit;
};

test("shows the card's picture while one turns, and the core's when one rests", async () => {
  const { page, errors } = await open("box(2, 2, 1) - cylinder(0.4, 2)");
  await page.waitForSelector(".live-field[data-live]");
  await settled(page);
  expect(await page.locator(".card-picture[data-shown]").count()).toBe(0);
  await page.locator(".live-field").focus();
  await page.keyboard.press("ArrowLeft");
  await page.waitForSelector(".card-picture[data-shown] canvas");
  // The core's picture of the new view replaces it.
  await page.waitForSelector(".card-picture:not([data-shown])", { state: "attached" });
  await settled(page);
  expect(faults(errors)).toEqual([]);
});

test("another number changes the picture before the core has drawn it", async () => {
  const { page, errors } = await open("sphere(1) & box(1.6, 1.6, 1.6)");
  await page.waitForSelector(".live-field[data-live]");
  await settled(page);
  await write(page, "sphere(1) & box(1.2, 1.6, 1.6)");
  await page.waitForSelector(".card-picture[data-shown] canvas");
  await settled(page);
  expect(await page.locator(".live-field[data-live]").count()).toBe(1);
  expect(faults(errors)).toEqual([]);
});

test("a shape whose distance is computed from triangles has no program, and the core's picture stays", async () => {
  const { page, errors } = await open("redistance(box(2, 2, 1), 0.1)");
  await page.locator(".field-picture:not([hidden])").waitFor();
  await settled(page);
  expect(await page.locator(".live-field[data-live]").count()).toBe(0);
  expect(faults(errors)).toEqual([]);
});
