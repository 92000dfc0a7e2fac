// The workbench in a browser, opened with something small, for tests of the page.
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { expect } from "vitest";
import { bench } from "../../src/workbench/document";
import { pack } from "../../src/workbench/share";
import { ROOT, Site, type Visit, settled } from "./site";

/** How long one step may take: the module that tests build is half as fast as the one that pages have. */
const STEP_MS = 120_000;
/** What tests of the workbench are given. */
export const PATIENCE = { testTimeout: 2 * STEP_MS, hookTimeout: 60_000, expect: { poll: { timeout: STEP_MS } } };

/** The command as a module. */
export async function commandModule(): Promise<WebAssembly.Module> {
  const path = join(ROOT, "wasm/command.wasm");
  expect(existsSync(path), "make studio-page builds the module").toBe(true);
  return WebAssembly.compile(readFileSync(path));
}

export const text = (of: string) => new TextEncoder().encode(of);

/** A small script in the address: what the page opens with by itself takes a second of work. */
export async function small(of = "sphere(1)", language = ""): Promise<string> {
  return `workbench${language}.html#s=${await pack(bench("bracket.star", { "bracket.star": text(of) }))}`;
}

/** Pages of one test after the other, closed together. */
export class Workbenches {
  private readonly opened: Page[] = [];
  constructor(private readonly site: Site) {}

  async open(address?: string, options: Parameters<Site["ready"]>[1] = {}): Promise<Visit> {
    const prepare = async (page: Page) => {
      page.setDefaultTimeout(STEP_MS);
      await options.prepare?.(page);
    };
    const visit = await this.site.ready(address ?? (await small()), { ...options, prepare });
    this.opened.push(visit.page);
    await settled(visit.page);
    return visit;
  }

  close = async () => {
    await Promise.all(this.opened.splice(0).map((page) => page.context().close()));
  };
}

/** Chromium styles what it inserts into an editable text, and reports that the policy keeps it from it. */
export const faults = (errors: readonly string[]) =>
  errors.filter((error) => !error.startsWith("Applying inline style violates"));

/** The line that the page shows. */
export const line = (page: Page) => page.locator(".line code").textContent();

/** The script that is in the editor. */
export async function write(page: Page, text: string): Promise<void> {
  await page.locator(".cm-content").click();
  await page.keyboard.press("Control+a");
  await page.keyboard.insertText(text);
}
