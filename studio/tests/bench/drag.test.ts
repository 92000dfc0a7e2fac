// How long a drag blocks the page's main thread. The number depends on the machine, so no test checks it:
// `make bench-studio` prints it, beside the goal of the page's design.
import { loadavg } from "node:os";
import { afterAll, beforeAll, test } from "vitest";
import type { Locator, Page } from "playwright-core";
import { EXHIBITS } from "../../src/exhibits/index";
import { handleOf } from "../page/drag";
import { Site, settled } from "../page/site";
import { dragCost } from "./drag_cost";

/** Half of a frame at 60 Hz: the browser needs the other half for painting. */
const WANTED_MS = 8;

let site: Site;
beforeAll(async () => {
  site = await Site.open();
});
afterAll(() => site.close());

test.each([
  ["in a usual window", 900],
  ["with the plot in sight as well", 1700],
])("the main thread for each move of a drag, %s", async (where, height) => {
  const { page } = await site.ready("", { viewport: { width: 1200, height } });
  await settled(page);
  const { median, p95, moves } = await dragCost(page, handleOf(page, 1));
  console.log(
    `${where}: median ${median.toFixed(2)} ms, 95 of 100 below ${p95.toFixed(2)} ms, of ${moves} moves; wanted: a median of ${WANTED_MS} ms`,
  );
  await page.context().close();
});

/** What is dragged in an exhibit: its handle; else its slider; else the figure itself. */
async function handleIn(page: Page): Promise<Locator> {
  const all = [page.locator(".grip[role=slider] .dot").first(), page.locator(".panel input[type=range]").first(), page.locator(".scene")];
  for (const one of all) if (await one.count()) return one;
  throw new Error("there is nothing to drag");
}

test.each(EXHIBITS.map(({ id }) => id).filter((id) => id !== "questions"))("the main thread for each move of a drag, in the exhibit %s", async (id) => {
  const { page } = await site.ready(`${id}.html`);
  await settled(page);
  if (await page.locator(".scene").count()) await page.waitForSelector('.scene[data-viewer="webgl"]');
  const { median, p95, moves } = await dragCost(page, await handleIn(page));
  const load = loadavg()[0]!.toFixed(1);
  console.log(
    `${id}: median ${median.toFixed(2)} ms, 95 of 100 below ${p95.toFixed(2)} ms, of ${moves} moves; wanted: a median of ${WANTED_MS} ms; load ${load}`,
  );
  await page.context().close();
});
