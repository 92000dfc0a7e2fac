// The workbench in a browser with a small input, for tests of the page.
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { expect } from "vitest";
import { bench } from "../../src/workbench/document";
import { pack } from "../../src/workbench/share";
import { type Opening, ROOT, Site, type Visit, seen, settled } from "./site";

/** The time limit of a step: the tests' module is half as fast as that of the pages. */
const STEP_MS = 120_000;
/** The fixture of the workbench's tests. */
export const PATIENCE = { testTimeout: 2 * STEP_MS, hookTimeout: 60_000, expect: { poll: { timeout: STEP_MS } } };

/** The command as a module. */
export async function commandModule(): Promise<WebAssembly.Module> {
  const path = join(ROOT, "wasm/command.wasm");
  expect(existsSync(path), "make studio-page builds the module").toBe(true);
  return WebAssembly.compile(readFileSync(path));
}

export const text = (of: string) => new TextEncoder().encode(of);

/** A small script in the address: the page's own example takes a second of work. */
export async function small(of = "sphere(1)", language = ""): Promise<string> {
  return `workbench${language}.html#s=${await pack(bench("bracket.star", { "bracket.star": text(of) }))}`;
}

/**
 * Pages for one test after the other. Each test gets a freshly loaded page, but in the tab of an earlier test: there the
 * browser still has the compiled module, and compiling takes longer than most tests.
 */
export class Workbenches {
  private readonly opened: { visit: Visit; kind: string }[] = [];
  private readonly left: { visit: Visit; kind: string }[] = [];
  constructor(private readonly site: Site) {}

  async open(address?: string, options: Omit<Opening, "prepare" | "isFirst"> = {}): Promise<Visit> {
    // Settings that `seen` cannot change.
    const { viewport: _, colorScheme: __, reducedMotion: ___, ...others } = options;
    const kind = JSON.stringify(others);
    const at = this.left.findIndex((one) => one.kind === kind);
    const where = address ?? (await small());
    let visit: Visit;
    if (at >= 0) {
      ({ visit } = this.left.splice(at, 1)[0]!);
      this.opened.push({ visit, kind });
      await seen(visit.page, options);
      visit.errors.length = 0;
      await visit.page.goto(this.site.base + where);
    } else {
      visit = await this.site.visit(where, { ...options, prepare: async (page) => page.setDefaultTimeout(STEP_MS) });
      this.opened.push({ visit, kind });
    }
    await visit.page.waitForSelector("html[data-ready]");
    await settled(visit.page);
    return visit;
  }

  /** Call after each test. Pages are closed to end their work; the tab of a failed test is not reused. */
  close = async ({ task }: { task?: { result?: { state: string } | undefined } } = {}) => {
    const isFine = task?.result?.state !== "fail";
    for (const { visit, kind } of this.opened.splice(0)) {
      const { page } = visit;
      if (isFine) {
        await page.evaluate(() => localStorage.clear());
        await page.goto("about:blank");
        this.left.push({ visit, kind });
      } else {
        await page.context().close();
      }
    }
  };
}

/** Chromium styles text that it inserts into an editable element, and reports that the policy blocks it. */
export const faults = (errors: readonly string[]) =>
  errors.filter((error) => !error.startsWith("Applying inline style violates"));

/** Opens a panel over the picture, unless it is open. */
export async function panel(page: Page, name: "input" | "certificate" | "findings" | "beside" | "change" | "export"): Promise<void> {
  const button = page.locator(`[data-panel="${name}"]`);
  if ((await button.getAttribute("aria-expanded")) !== "true") await button.click();
  await page.locator(`#panel-${name}`).waitFor();
}

/** The command line that the page shows. */
export const line = (page: Page) => page.locator(".line code").textContent();

/** The script in the editor. */
export async function write(page: Page, text: string): Promise<void> {
  await panel(page, "input");
  await page.locator(".cm-content").click();
  await page.keyboard.press("Control+a");
  await page.keyboard.insertText(text);
}

/** Puts an example on the bench, from the shelf. */
export async function example(page: Page, name: string): Promise<void> {
  await panel(page, "input");
  await page.locator("[data-shelf=open]").click();
  await page.locator(`[data-example="${name}"]`).click();
}
