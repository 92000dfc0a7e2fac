// How soon each page shows something, how much is loaded by then, and how long it keeps the main thread, on a processor slowed
// down four times. The times depend on the machine: `make bench-studio` prints them, beside the goals.
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { loadavg } from "node:os";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import { afterAll, beforeAll, test } from "vitest";
import { DIST, Site } from "../page/site";

/** The first picture, the bytes loaded for it and for the live one, compressed, and the longest task at full speed. */
const WANTED = { ms: 1000, kB: 150, liveKB: 400, taskMs: 50 };
const SLOWER = 4;
const RUNS = 3;

let site: Site;
beforeAll(async () => {
  site = await Site.open();
});
afterAll(() => site.close());

/** Every page in English. In Chinese they are the same, but for their texts. */
const PAGES = readdirSync(DIST).filter((file) => /^[a-z]+\.html$/.test(file) && file !== "zh.html");

test.each(PAGES)("the first picture and the first live one of '%s', and the bytes loaded for them", async (address) => {
  // On the list nothing moves.
  const isLive = address !== "exhibits.html";
  const runs: [first: number, live: number, task: number][] = [];
  const loaded = new Set<string>();
  const atFirst = new Set<string>();
  for (let i = 0; i < RUNS; i++) {
    const context = await site.browser.newContext({ viewport: { width: 390, height: 844 }, locale: "en-GB", serviceWorkers: "block" });
    const page = await context.newPage();
    page.on("request", (request) => loaded.add(new URL(request.url()).pathname.replace("/some/where/", "") || "index.html"));
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
    if (await page.locator(".scene").count()) await page.waitForSelector(".scene[data-viewer]");
    const { first, live, task } = await page.evaluate(
      () => (window as unknown as { times: { first: number; live: number; task: number } }).times,
    );
    runs.push([first, live, task]);
    // The resources that block the first picture: the page, its styles, and scripts that are not modules.
    const blocking = await page.locator('link[rel=stylesheet], script[src]:not([type=module], [defer])').evaluateAll((all) =>
      all.map((one) => new URL((one as HTMLScriptElement).src || (one as HTMLLinkElement).href).pathname.replace("/some/where/", "")),
    );
    for (const name of [address, ...blocking]) atFirst.add(name);
    await context.close();
  }
  const weight = (names: Iterable<string>) => {
    const files = [...names].filter((name) => existsSync(join(DIST, name)));
    return Math.round(files.reduce((sum, name) => sum + gzipSync(readFileSync(join(DIST, name)), { level: 9 }).length, 0) / 1000);
  };
  const middle = (which: 0 | 1 | 2) => runs.map((run) => run[which]).sort((a, b) => a - b)[Math.floor(RUNS / 2)]!.toFixed(0);
  const load = loadavg()[0]!.toFixed(1);
  console.log(
    `'${address}': first picture ${middle(0)} ms after ${weight(atFirst)} kB, ` +
      `${isLive ? `live ${middle(1)} ms` : "complete"} after ${weight(loaded)} kB, ` +
      `longest task ${middle(2)} ms, ${SLOWER} times slower; wanted: a picture within ${WANTED.ms} ms and ${WANTED.kB} kB, ` +
      `live within ${WANTED.liveKB} kB, tasks of ${WANTED.taskMs * SLOWER} ms; load ${load}`,
  );
});
