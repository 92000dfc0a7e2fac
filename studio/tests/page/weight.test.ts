// What a page loads, compressed, before its first picture and until its figure is live, held to the limits that docs/studio.md
// names. `make test` has one module for all exhibits, which is not counted; test-long judges those that are shipped.
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { brotliCompressSync } from "node:zlib";
import { afterAll, beforeAll, expect, test } from "vitest";
import { moduleOf } from "../../src/exhibits/modules";
import { DIST, EXHIBITS_WASM, Site, isLong } from "./site";

/** Compressed by Brotli, as `chordal studio` and most hosts send them. */
const FIRST_BYTES = 150_000;
const LIVE_BYTES = 400_000;
/** What meshes or simplifies in several ways, and measures that, or has a still of thousands of triangles: these pages ask for more,
 * and not for more than today. */
const LARGER: Record<string, number> = {
  questions: 430_000,
  mountain: 540_000,
  baking: 540_000,
  levels: 600_000,
  squares: 680_000,
  booleans: 800_000,
  cubes: 800_000,
  budget: 920_000,
};
/** What is left of it beside a module. */
const BESIDE_MODULE_BYTES = 200_000;

const pages = readdirSync(DIST).filter((file) => file.endsWith(".html") && (isLong || !/zh\.html$/.test(file)));
const hasOwnModules = !readFileSync(join(EXHIBITS_WASM, `../exhibits/${moduleOf("quad")}.wasm`)).equals(readFileSync(EXHIBITS_WASM));

/** Without a module of their own: the lesson has the levels of its first picture, the mountain both surfaces. */
const FULLER: Record<string, number> = { lesson: LIVE_BYTES, mountain: 280_000 };

const limitOf = (file: string) => (hasOwnModules ? (LARGER[file.split(".")[0]!] ?? LIVE_BYTES) : (FULLER[file.split(".")[0]!] ?? BESIDE_MODULE_BYTES));

let site: Site;
beforeAll(async () => {
  site = await Site.open();
});
afterAll(() => site.close());

const weights = new Map<string, number>();
/** The compressed bytes of files of the build. */
function weight(files: Iterable<string>): number {
  let sum = 0;
  for (const file of new Set(files)) {
    const known = weights.get(file) ?? brotliCompressSync(readFileSync(join(DIST, file))).length;
    weights.set(file, known);
    sum += known;
  }
  return sum;
}

test.each(pages)("%s asks for little before its first picture, and until it is live", async (file) => {
  const loaded = new Set<string>([file]);
  const fileOf = (address: string) => new URL(address).pathname.replace("/some/where/", "");
  const { page, errors } = await site.visit(file, {
    prepare: async (page) => page.on("request", (request) => loaded.add(fileOf(request.url()))),
  });
  const blocking = await page
    .locator('link[rel=stylesheet], script[src]:not([type=module], [defer])')
    .evaluateAll((all) => all.map((one) => (one as HTMLScriptElement).src || (one as HTMLLinkElement).href));
  expect(weight([file, ...blocking.map(fileOf)]), "before the first picture").toBeLessThan(FIRST_BYTES);
  const hasScript = (await page.locator("script[type=module]").count()) > 0;
  // The workbench is the whole command: its text and its still are what is light.
  if (hasScript && !file.startsWith("workbench")) {
    await page.waitForSelector("html[data-ready]");
    if (await page.locator(".scene").count()) await page.waitForSelector(".scene[data-viewer]");
    const files = [...loaded].filter((name) => existsSync(join(DIST, name)));
    const counted = hasOwnModules ? files : files.filter((name) => !name.endsWith(".wasm"));
    // The lesson's first picture asks no module.
    expect(files.some((name) => name.endsWith(".wasm"))).toBe(!file.startsWith("lesson"));
    expect(weight(counted), `until it is live: ${counted.join(", ")}`).toBeLessThan(limitOf(file));
    console.log(`${file}: ${Math.round(weight(counted) / 1000)} kB until it is live`);
  }
  expect(errors).toEqual([]);
  await page.context().close();
});
