// How soon the page shows something, and what it weighs by then, on a processor four times slower than this one. Like any
// time it depends on the machine: `make bench-studio` prints it, beside what the page is made for.
import { readFileSync, readdirSync } from "node:fs";
import { loadavg } from "node:os";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import { afterAll, beforeAll, expect, test } from "vitest";
import { DIST, Site } from "../page/site";

/** First picture, and the page's weight compressed. */
const WANTED = { ms: 1000, kB: 400 };
const SLOWER = 4;
const RUNS = 5;

let site: Site;
beforeAll(async () => {
  site = await Site.open();
});
afterAll(() => site.close());

test.each(["", "zh.html"])("the first picture, and the first live one, of '%s'", async (address) => {
  const runs: [first: number, live: number][] = [];
  for (let i = 0; i < RUNS; i++) {
    const page = await site.browser.newPage({ viewport: { width: 390, height: 844 } });
    const session = await page.context().newCDPSession(page);
    await session.send("Emulation.setCPUThrottlingRate", { rate: SLOWER });
    await page.addInitScript(() => {
      const times = { first: 0, live: 0 };
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
    await page.waitForFunction(() => {
      const { times } = window as unknown as { times: { first: number; live: number } };
      return times.first > 0 && times.live > 0;
    });
    const { first, live } = await page.evaluate(() => (window as unknown as { times: { first: number; live: number } }).times);
    runs.push([first, live]);
    await page.close();
  }
  const middle = (which: 0 | 1) => runs.map((run) => run[which]).sort((a, b) => a - b)[Math.floor(RUNS / 2)]!.toFixed(0);
  const load = loadavg()[0]!.toFixed(1);
  console.log(`'${address}': first picture ${middle(0)} ms, live ${middle(1)} ms, ${SLOWER} times slower; wanted: ${WANTED.ms} ms; load ${load}`);
});

test("what the widget's page weighs", () => {
  const html = readFileSync(join(DIST, "index.html"), "utf8");
  const names = [...html.matchAll(/(?:src|href)="\.\/([\w./-]+\.(?:js|css))"/g)].map((match) => match[1]!);
  expect(names.length).toBeGreaterThanOrEqual(3);
  // The worker and the module are named by scripts, not by the page.
  names.push(...readdirSync(join(DIST, "assets")).filter((name) => /^worker-|\.wasm$/.test(name)).map((name) => `assets/${name}`));
  const bytes = [...new Set(["index.html", ...names])].map((name) => gzipSync(readFileSync(join(DIST, name)), { level: 9 }).length);
  console.log(`the page: ${Math.round(bytes.reduce((sum, size) => sum + size, 0) / 1000)} kB compressed; wanted: ${WANTED.kB} kB`);
});
