// Dots in 3D have the requested width in CSS pixels, on screens of several densities.
import { readFile } from "node:fs/promises";
import { extname, join } from "node:path";
import { afterAll, beforeAll, expect, test } from "vitest";
import { build } from "vite";
import { ROOT, Site } from "./site";

declare global {
  var widthOfDot: (size: number) => number;
}

const BUILT = join(ROOT, "node_modules/.dots-page");
const TYPES: Record<string, string> = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css" };

let site: Site;
beforeAll(async () => {
  const root = join(ROOT, "tests/page/dots_page");
  await build({ root, configFile: false, base: "./", logLevel: "warn", build: { outDir: BUILT, emptyOutDir: true, target: "es2022", modulePreload: false } });
  site = await Site.open();
});
afterAll(() => site?.close());

test.each([1, 2, 3])("a dot of 9 pixels is that wide at a density of %s", async (density) => {
  const { page, errors } = await site.visit("dots/index.html", {
    deviceScaleFactor: density,
    prepare: (page) =>
      page.route("**/dots/**", async (route) => {
        const name = new URL(route.request().url()).pathname.split("/dots/")[1]!;
        await route.fulfill({ body: await readFile(join(BUILT, name)), contentType: TYPES[extname(name)] ?? "application/octet-stream" });
      }),
  });
  await page.waitForFunction(() => "widthOfDot" in window);
  for (const size of [9, 15]) {
    const width = await page.evaluate((of) => widthOfDot(of), size);
    // A device pixel at each end may be half covered.
    expect(Math.abs(width - size), `${width} pixels for ${size}`).toBeLessThanOrEqual(1);
  }
  await page.context().close();
  expect(errors).toEqual([]);
});
