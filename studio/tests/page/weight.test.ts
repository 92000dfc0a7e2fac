// What a page loads, compressed, before its first picture and until its figure is live, held to the limits that docs/studio.md
// names. `make test` has one module for all exhibits, which is not counted; test-long judges those that are shipped.
import { existsSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { afterAll, beforeAll, expect, test } from "vitest";
import { FIRST_BYTES, LARGER, LIVE_BYTES, firstFiles, fileOf, hasOwnModules, weight } from "./bytes";
import { DIST, Site, isLong } from "./site";

/** What is left of it beside a module. */
const BESIDE_MODULE_BYTES = 200_000;

const pages = readdirSync(DIST).filter((file) => file.endsWith(".html") && (isLong || !/zh\.html$/.test(file)));

/** Without a module of its own: the lesson has the levels of its first picture. */
const FULLER: Record<string, number> = { lesson: LIVE_BYTES };

const limitOf = (file: string) => (hasOwnModules ? (LARGER[file.split(".")[0]!] ?? LIVE_BYTES) : (FULLER[file.split(".")[0]!] ?? BESIDE_MODULE_BYTES));

let site: Site;
beforeAll(async () => {
  site = await Site.open();
});
afterAll(() => site.close());

test.each(pages)("%s asks for little before its first picture, and until it is live", async (file) => {
  const loaded = new Set<string>([file]);
  const { page, errors } = await site.visit(file, {
    prepare: async (page) => page.on("request", (request) => loaded.add(fileOf(request.url()))),
  });
  const first = [file, ...(await firstFiles(page))];
  // A page has styles and its colours, or nothing is weighed.
  expect(first.length).toBeGreaterThanOrEqual(3);
  expect(weight(first), "before the first picture").toBeLessThan(FIRST_BYTES);
  const hasScript = (await page.locator("script[type=module]").count()) > 0;
  // The workbench is the whole command: its text and its still are what is light.
  if (hasScript && !file.startsWith("workbench")) {
    await page.waitForSelector("html[data-ready]");
    if (await page.locator(".scene").count()) await page.waitForSelector(".scene[data-viewer]");
    const files = [...loaded].filter((name) => existsSync(join(DIST, name)));
    const counted = hasOwnModules ? files : files.filter((name) => !name.endsWith(".wasm"));
    // The lesson's first picture asks no module, and the questions none before somebody says something.
    expect(files.some((name) => name.endsWith(".wasm"))).toBe(!/^(lesson|questions)\b/.test(file));
    expect(weight(counted), `until it is live: ${counted.join(", ")}`).toBeLessThan(limitOf(file));
    console.log(`${file}: ${Math.round(weight(counted) / 1000)} kB until it is live`);
  }
  expect(errors).toEqual([]);
  await page.context().close();
});
