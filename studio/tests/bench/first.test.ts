// How soon each page shows something, how much is loaded by then, and how long it keeps the main thread, on a processor slowed
// down four times.
import { readdirSync } from "node:fs";
import { afterAll, beforeAll, expect, test, vi } from "vitest";
import { fileOf, firstFiles, weight } from "../page/bytes";
import { DIST, Site } from "../page/site";
import { Table, median } from "./judge";

vi.setConfig({ testTimeout: 120_000 });
const SLOWER = 4;
/** A time beyond its limit is measured so often, and the middle one counts. */
const RUNS = 3;

let site: Site;
const table = new Table(`Pages on a processor slowed down ${SLOWER} times; the longest task is that of full speed`, [
  "page",
  "first picture",
  "after",
  "live",
  "after",
  "longest task",
]);
beforeAll(async () => {
  site = await Site.open();
});
afterAll(async () => {
  table.print();
  await site.close();
});

interface Opened {
  first: number;
  live: number;
  task: number;
  firstKB: number;
  liveKB: number;
}

/** Opens a page with an empty cache, until it is live; on the list of exhibits nothing moves. */
async function opened(address: string): Promise<Opened> {
  const isLive = address !== "exhibits.html";
  const loaded = new Set<string>([address]);
  const context = await site.browser.newContext({ viewport: { width: 390, height: 844 }, locale: "en-GB", serviceWorkers: "block" });
  const page = await context.newPage();
  page.on("request", (request) => loaded.add(fileOf(request.url())));
  const session = await context.newCDPSession(page);
  await session.send("Emulation.setCPUThrottlingRate", { rate: SLOWER });
  await page.addInitScript(() => {
    const times = { first: 0, live: 0, task: 0 };
    new PerformanceObserver((list) => (times.task = Math.max(times.task, ...list.getEntries().map(({ duration }) => duration)))).observe({
      type: "longtask",
      buffered: true,
    });
    Object.assign(window, { times });
    new PerformanceObserver((list) => (times.first = list.getEntriesByName("first-contentful-paint")[0]?.startTime ?? times.first)).observe({
      type: "paint",
      buffered: true,
    });
    new MutationObserver(() => {
      if (!times.live && document.documentElement.dataset["ready"]) times.live = performance.now();
    }).observe(document, { attributes: true, subtree: true });
  });
  await page.goto(site.base + address);
  await page.waitForFunction((isLive) => {
    const { times } = window as unknown as { times: { first: number; live: number } };
    return times.first > 0 && (times.live > 0 || !isLive);
  }, isLive);
  // A scene below the window is only a place for one.
  if (isLive && (await page.locator(".scene > svg").count())) await page.waitForSelector(".scene[data-viewer]");
  const times = await page.evaluate(() => (window as unknown as { times: { first: number; live: number; task: number } }).times);
  const firstKB = weight([address, ...(await firstFiles(page))]) / 1000;
  await context.close();
  return { ...times, task: times.task / SLOWER, firstKB, liveKB: weight(loaded) / 1000 };
}

/** Every page in English. In Chinese they are the same, but for their texts. */
const PAGES = readdirSync(DIST).filter((file) => /^[a-z]+\.html$/.test(file) && file !== "zh.html");

test.each(PAGES)("%s", async (address) => {
  const of = address.split(".")[0]!;
  const runs = [await opened(address)];
  const middle = (which: keyof Opened) => median(runs.map((run) => run[which]));
  while (runs.length < RUNS && table.isDoubtful(of, { picture: middle("first"), task: middle("task") })) runs.push(await opened(address));
  const isLive = of !== "exhibits";
  // Tasks of less than 50 milliseconds are not told.
  const task = middle("task");
  expect(
    table.add(
      of,
      { what: "picture", value: middle("first") },
      { what: "first", value: runs[0]!.firstKB },
      isLive ? `${middle("live").toFixed(0)} ms` : "",
      isLive ? { what: "live", value: runs[0]!.liveKB } : "",
      task === 0 ? `below ${(50 / SLOWER).toFixed(0)} ms` : { what: "task", value: task },
    ),
  ).toEqual([]);
});
