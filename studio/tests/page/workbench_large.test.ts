// A very large file on the workbench: its findings appear, or a message, and the page keeps working.
import { closeSync, mkdtempSync, openSync, readFileSync, rmSync, writeSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, expect, test, vi } from "vitest";
import { run } from "../../src/core/command";
import { split } from "../../src/workbench/document";
import { LAYOUT_TEXTS } from "../../src/workbench/layout/texts";
import { ROOT, Site, digits, isLong, settled } from "./site";
import { PATIENCE, Workbenches, commandModule, example, line } from "./workbench_page";

/** The time limit for the largest file. */
const LARGE_MS = 600_000;
vi.setConfig({ ...PATIENCE, testTimeout: 2 * LARGE_MS, expect: { poll: { timeout: LARGE_MS } } });

const folder = mkdtempSync(join(tmpdir(), "chordal-large-"));
let site: Site;
let pages: Workbenches;
beforeAll(async () => {
  site = await Site.open();
  pages = new Workbenches(site);
});
afterEach((context) => pages.close(context));
afterAll(async () => {
  await site.close();
  rmSync(folder, { recursive: true });
});

/** A torus of `2 * around * across` triangles without one of them, as a binary STL; 50 bytes each. */
function torus(path: string, around: number, across: number): void {
  const file = openSync(path, "w");
  const head = Buffer.alloc(84);
  head.writeUInt32LE(2 * around * across - 1, 80);
  writeSync(file, head);
  const at = (i: number, j: number) => {
    const [u, v] = [(2 * Math.PI * (i % around)) / around, (2 * Math.PI * (j % across)) / across];
    const far = 2 + Math.cos(v);
    return [far * Math.cos(u), far * Math.sin(u), Math.sin(v)];
  };
  for (let i = 0; i < around; i++) {
    const row = Buffer.alloc(100 * across);
    for (let j = 0; j < across; j++) {
      const [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
      for (const [k, corners] of [[a, b, c], [a, c, d]].entries()) {
        corners.flat().forEach((x, n) => row.writeFloatLE(x!, 100 * j + 50 * k + 12 + 4 * n));
      }
    }
    writeSync(file, i === 0 ? row.subarray(50) : row);
  }
  closeSync(file);
}

/** Keeps what the certificate says, from now on. */
const listen = (page: Page) =>
  page.evaluate(() => {
    const told = new Set<string>();
    Object.assign(window, { told });
    new MutationObserver(() => told.add(document.querySelector(".certificate")?.textContent ?? "")).observe(document, { subtree: true, childList: true, characterData: true });
  });
const toldOn = (page: Page) => page.evaluate(() => [...(window as unknown as { told: Set<string> }).told]);

/** `make test` opens a file of two megabytes in the same way. */
test.each(isLong ? [[1000, 20], [2000, 1000]] : [[1000, 20]])("2 times %i times %i triangles", async (around, across) => {
  const path = join(folder, "torus.stl");
  torus(path, around, across);
  const { page } = await pages.open();
  expect(await line(page)).toContain("bracket.star");
  await listen(page);
  await page.locator(".inputs input[type=file]").setInputFiles(path);
  const said = async (where: string) => (await page.locator(where).allTextContents()).join(" ");
  const refused = "p.fault, .note";
  await expect.poll(() => said(`.findings, ${refused}`)).toMatch(/.{20,}/);
  // A file that is too large for a browser gives a message; in any other the defect is counted, and its triangles are seen before
  // their mesh is made.
  const isRefused = (await said(refused)) !== "";
  if (isRefused) {
    expect(around * across, await said(refused)).toBeGreaterThan(1e6);
    expect(await said(refused)).toContain("memory");
  } else {
    expect(await said(".findings")).toContain("3 boundary edges");
    await expect.poll(async () => (await toldOn(page)).filter((told) => told.includes(LAYOUT_TEXTS.en.asItIs)).length).toBeGreaterThan(0);
    expect(await line(page)).toContain("torus.stl");
  }
  // The mesh of so many triangles takes minutes; the page must accept other input meanwhile.
  await example(page, "bracket");
  await page.locator(".cm-content").waitFor();
  await settled(page);
  expect(await line(page)).toContain("bracket.star");
  expect(await page.locator(".findings").count()).toBe(0);
  expect(await page.locator(".certificate .proved").count()).toBe(1);
  // The core's number, of the example and of nothing before it.
  const outcome = await run(await commandModule(), [...split((await line(page))!).slice(1), "--json"], { "bracket.star": readFileSync(join(ROOT, "../examples/bracket.star")) });
  expect(await digits(page, "bound")).toBe(JSON.parse(outcome.stdout).certificate.bound.at_most);
});
