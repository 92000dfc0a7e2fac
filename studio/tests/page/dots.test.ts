// Dots and lines in 3D have the requested width in CSS pixels, on screens of several densities, and are faint behind a body.
import { readFile } from "node:fs/promises";
import { extname, join } from "node:path";
import { afterAll, beforeAll, expect, test } from "vitest";
import { build } from "vite";
import { ROOT, Site } from "./site";

declare global {
  var widthOf: (what: "dot" | "line", size: number) => number;
  var colorOfMark: (what: "dot" | "line", isBehind: boolean) => number[];
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

test.each([1, 2, 3])("dots and lines are as wide as they should be at a density of %s, and marks show whether a body hides them", async (density) => {
  const { page, errors } = await site.visit("dots/index.html", {
    deviceScaleFactor: density,
    prepare: (page) =>
      page.route("**/dots/**", async (route) => {
        const name = new URL(route.request().url()).pathname.split("/dots/")[1]!;
        await route.fulfill({ body: await readFile(join(BUILT, name)), contentType: TYPES[extname(name)] ?? "application/octet-stream" });
      }),
  });
  await page.waitForFunction(() => "colorOfMark" in window);
  for (const what of ["dot", "line"] as const) {
    for (const size of [9, 15]) {
      const width = await page.evaluate(([what, of]) => widthOf(what, of), [what, size] as const);
      // A device pixel at each end may be half covered.
      expect(Math.abs(width - size), `${width} pixels for ${size}`).toBeLessThanOrEqual(1);
    }
    expect(await page.evaluate((what) => colorOfMark(what, false), what)).toEqual([255, 0, 0]);
    const [r, g, b] = await page.evaluate((what) => colorOfMark(what, true), what);
    expect(r).toBe(255);
    expect(g, "of a hidden mark something is left, and most is not").toSatisfy((green: number) => green > 140 && green < 245);
    expect(b).toBe(g);
  }
  await page.context().close();
  expect(errors).toEqual([]);
});
