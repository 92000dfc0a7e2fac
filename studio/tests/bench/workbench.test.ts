// How soon the workbench shows something, and how soon it follows a drag. The times depend on the machine, and on the module:
// `make bench-studio` prints both, with the module of the pages.
import { readFileSync } from "node:fs";
import { loadavg } from "node:os";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, test, vi } from "vitest";
import { ROOT, Site, settled } from "../page/site";
import { example } from "../page/workbench_page";
import { dragCost } from "./drag_cost";

vi.setConfig({ testTimeout: 600_000 });
const STEP_MS = 120_000;
const RUNS = 5;
/** Three steps of a number, in CSS pixels. */
const WAY_PX = 15;

let site: Site;
let around: string;
beforeAll(async () => {
  site = await Site.open();
  const module = gzipSync(readFileSync(join(ROOT, "wasm/command.wasm")), { level: 9 }).length;
  around = `a module of ${(module / 1e6).toFixed(1)} MB`;
});
afterAll(() => site.close());

const median = (all: readonly number[]) => [...all].sort((a, b) => a - b)[Math.floor(all.length / 2)]!;
const load = () => `load ${loadavg()[0]!.toFixed(1)}, ${around}`;

/** When each was first visible, in milliseconds of the page's clock; 0 for never. */
interface Times {
  moved: number;
  up: number;
  draft: number;
  proved: number;
}

/** Records the times from the page's first script on. */
async function keepTimes(page: Page): Promise<void> {
  page.setDefaultTimeout(STEP_MS);
  await page.addInitScript(() => {
    const times: Times = { moved: 0, up: 0, draft: 0, proved: 0 };
    Object.assign(window, { times });
    addEventListener("pointermove", (event: PointerEvent) => (times.moved ||= event.buttons ? event.timeStamp : 0), true);
    addEventListener("pointerup", (event) => (times.up = event.timeStamp), true);
    const seen = (what: "draft" | "proved") => requestAnimationFrame((time) => (times[what] ||= time));
    new MutationObserver(() => {
      const big = document.querySelector(".certificate .big");
      if (!big || !document.querySelector('.scene[data-viewer="webgl"]')) return;
      if (big.classList.contains("draft")) seen("draft");
      // A proof that was shown before the end of the drag belongs to the text before.
      else if (!times.moved || times.up) seen("proved");
    }).observe(document, { subtree: true, childList: true, attributes: true, characterData: true });
  });
}

const until = (page: Page, what: keyof Times) =>
  page.waitForFunction((what) => (window as unknown as { times: Times }).times[what] > 0, what);
const timesOf = (page: Page): Promise<Times> => page.evaluate(() => (window as unknown as { times: Times }).times);

test("the first mesh and its proof, with an empty cache", async () => {
  const runs: Times[] = [];
  for (let i = 0; i < RUNS; i++) {
    const { page } = await site.visit("workbench.html", { prepare: keepTimes });
    await until(page, "proved");
    runs.push(await timesOf(page));
    await page.context().close();
  }
  const [draft, proved] = [median(runs.map((run) => run.draft || run.proved)), median(runs.map((run) => run.proved))];
  console.log(`first mesh ${draft.toFixed(0)} ms after the address, proved after ${proved.toFixed(0)} ms; ${load()}`);
});

test.each(["bracket", "gear", "vase", "badge"] as const)("a dragged number in the example %s", async (name) => {
  const { page } = await site.ready("workbench.html", { prepare: keepTimes });
  await page.locator(".cm-content").waitFor();
  await example(page, name);
  await settled(page);
  const number = page.locator(".cm-number").first();
  const [drafts, proofs]: [number[], number[]] = [[], []];
  for (let i = 0; i < RUNS; i++) {
    const { x, y, width, height } = (await number.boundingBox())!;
    const [left, top] = [x + width / 2, y + height / 2];
    await page.mouse.move(left, top);
    await page.mouse.down();
    await page.evaluate(() => {
      const { times } = window as unknown as { times: Times };
      Object.assign(times, { moved: 0, up: 0, draft: 0, proved: 0 });
    });
    // Back and forth.
    await page.mouse.move(left + (i % 2 ? -WAY_PX : WAY_PX), top);
    await until(page, "draft");
    await page.mouse.up();
    await until(page, "proved");
    const { moved, draft, up, proved } = await timesOf(page);
    drafts.push(draft - moved);
    proofs.push(proved - up);
    await settled(page);
  }
  const { longest, median: usual, moves } = await dragCost(page, number);
  console.log(
    `${name}: a draft ${median(drafts).toFixed(0)} ms after the number moved, its proof ${median(proofs).toFixed(0)} ms after ` +
      `the hand is off; ${usual.toFixed(1)} ms of the main thread for each of ${moves} moves, ${longest.toFixed(0)} ms in its ` +
      `longest task; ${load()}`,
  );
  await page.context().close();
});
