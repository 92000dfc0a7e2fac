// What files of the build weigh as they are sent, and what pages may ask for: for the test of it, and for the bench.
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { brotliCompressSync } from "node:zlib";
import type { Page } from "playwright-core";
import { moduleOf } from "../../src/exhibits/modules";
import { DIST, EXHIBITS_WASM } from "./site";

/** Compressed by Brotli, as `chordal studio` and most hosts send them. */
export const FIRST_BYTES = 150_000;
export const LIVE_BYTES = 400_000;
/** What meshes or simplifies in several ways, and measures that, or has a still of thousands of triangles: these pages ask for more,
 * and not for more than today. */
export const LARGER: Record<string, number> = {
  mountain: 405_000,
  baking: 515_000,
  levels: 575_000,
  squares: 640_000,
  booleans: 760_000,
  cubes: 760_000,
  budget: 870_000,
};

/** Whether the modules are those of the pages. The tests have one for all exhibits, which is larger and half as fast. */
export const hasOwnModules = !readFileSync(join(EXHIBITS_WASM, `../exhibits/${moduleOf("quad")}.wasm`)).equals(readFileSync(EXHIBITS_WASM));

const weights = new Map<string, number>();
/** The compressed bytes of those files that are of the build. */
export function weight(files: Iterable<string>): number {
  let sum = 0;
  for (const file of new Set(files)) {
    if (!existsSync(join(DIST, file))) continue;
    const known = weights.get(file) ?? brotliCompressSync(readFileSync(join(DIST, file))).length;
    weights.set(file, known);
    sum += known;
  }
  return sum;
}

/** The file of the build behind an address. */
export const fileOf = (address: string) => new URL(address).pathname.replace("/some/where/", "") || "index.html";

/** What the first picture of a page needs: its styles, scripts that are no modules, and pictures in sight. */
export async function firstFiles(page: Page): Promise<string[]> {
  const all = await page.evaluate(() => [
    ...[...document.querySelectorAll<HTMLLinkElement>("link[rel=stylesheet]")].map(({ href }) => href),
    ...[...document.querySelectorAll<HTMLScriptElement>("script[src]:not([type=module], [defer])")].map(({ src }) => src),
    ...[...document.images].filter((image) => image.getBoundingClientRect().top < innerHeight && image.currentSrc.startsWith(location.origin)).map(({ currentSrc }) => currentSrc),
  ]);
  return all.map(fileOf);
}
