// How soon the workbench shows something, and how soon it follows a drag. The times depend on the machine, and on the module.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { brotliCompressSync, constants } from "node:zlib";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, expect, test, vi } from "vitest";
import { ROOT, Site, settled } from "../page/site";
import { example } from "../page/workbench_page";
import { dragCost } from "./drag_cost";
import { Table, median } from "./judge";

vi.setConfig({ testTimeout: 300_000 });
const STEP_MS = 120_000;
/** What is measured so often, the middle of which counts; twice as often if it is beyond its limit. */
const RUNS = 3;
/** Three steps of a number, in CSS pixels. */
const WAY_PX = 15;

let site: Site;
const table = new Table("A dragged number on the workbench", ["example", "draft", "proof, from release", "main thread per move", "longest task"]);
const opening: string[] = [];
beforeAll(async () => {
  site = await Site.open();
});
afterAll(async () => {
  table.print();
  console.log(opening.join("\n"));
  await site.close();
});

/** When each was first visible, in milliseconds of the page's clock; 0 for never. */
interface Times {
  /** Whether a drag is measured, and not the opening of the page. */
  isDrag: boolean;
  moved: number;
  up: number;
  draft: number;
  proved: number;
}

/** Records the times from the page's first script on. */
async function keepTimes(page: Page): Promise<void> {
  page.setDefaultTimeout(STEP_MS);
  await page.addInitScript(() => {
    const times: Times = { isDrag: false, moved: 0, up: 0, draft: 0, proved: 0 };
    Object.assign(window, { times });
    addEventListener("pointermove", (event: PointerEvent) => (times.moved ||= event.buttons ? event.timeStamp : 0), true);
    addEventListener("pointerup", (event) => (times.up = event.timeStamp), true);
    // Not the time of the frame, which on a busy machine is long past when it is drawn.
    const seen = (what: "draft" | "proved") =>
      requestAnimationFrame(() => {
        // A frame that was asked for before a drag comes after its begin.
        if (!times.isDrag || (what === "draft" ? times.moved : times.up)) times[what] ||= performance.now();
      });
    new MutationObserver(() => {
      const big = document.querySelector(".certificate .big");
      if (!big || !document.querySelector('.scene[data-viewer="webgl"]')) return;
      if (big.classList.contains("draft")) seen("draft");
      // A proof that is shown before the end of the drag, or still at its begin, belongs to the text before.
      else if (!times.isDrag || times.up) seen("proved");
    }).observe(document, { subtree: true, childList: true, attributes: true, characterData: true });
  });
}

const until = (page: Page, what: Exclude<keyof Times, "isDrag">) =>
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
  // Fast and nearly as small as at the best level, which takes half a minute.
  const module = brotliCompressSync(readFileSync(join(ROOT, "wasm/command.wasm")), { params: { [constants.BROTLI_PARAM_QUALITY]: 5 } }).length;
  opening.push(`With an empty cache the first mesh appears after ${draft.toFixed(0)} ms, its proof after ${proved.toFixed(0)} ms; a module of ${(module / 1e6).toFixed(1)} MB`);
  expect(runs.every((run) => run.proved > 0)).toBe(true);
});

test.each(["bracket", "gear", "vase", "badge"] as const)("%s", async (name) => {
  const { page } = await site.ready("workbench.html", { prepare: keepTimes });
  await page.locator(".cm-content").waitFor();
  await example(page, name);
  await settled(page);
  const number = page.locator(".cm-number").first();
  const [drafts, proofs]: [number[], number[]] = [[], []];
  const isDoubtful = () => table.isDoubtful(name, { draft: median(drafts), proof: median(proofs) });
  for (let i = 0; i < RUNS || (i < 2 * RUNS && isDoubtful()); i++) {
    const { x, y, width, height } = (await number.boundingBox())!;
    const [left, top] = [x + width / 2, y + height / 2];
    await page.mouse.move(left, top);
    await page.mouse.down();
    await page.evaluate(() => {
      const { times } = window as unknown as { times: Times };
      Object.assign(times, { isDrag: true, moved: 0, up: 0, draft: 0, proved: 0 });
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
  expect(moves).toBeGreaterThan(40);
  const wrong = table.add(
    name,
    { what: "draft", value: median(drafts) },
    { what: "proof", value: median(proofs) },
    { what: "move", value: usual },
    { what: "task", value: longest },
  );
  expect(wrong).toEqual([]);
  await page.context().close();
});
