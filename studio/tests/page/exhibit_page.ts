// An exhibit's page under test: opens it, reads its state from the address, and compares its number with the core's.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { expect } from "vitest";
import { Core } from "../../src/core/module";
import type { AnyExhibit } from "../../src/exhibits/exhibit";
import { read } from "../../src/exhibits/fragment";
import { EXHIBITS } from "../../src/exhibits/index";
import { Say } from "../../src/exhibits/say";
import { DIST, EXHIBITS_WASM, Site, digits, isLong, settled, type Visit } from "./site";

export class ExhibitPages {
  private visit: Visit | undefined;
  private constructor(
    readonly site: Site,
    readonly core: Core,
    readonly exhibits: ReadonlyMap<string, AnyExhibit>,
  ) {}

  static async open(): Promise<ExhibitPages> {
    const exhibits = new Map<string, AnyExhibit>();
    for (const entry of EXHIBITS) exhibits.set(entry.id, (await entry.load()).default);
    return new ExhibitPages(await Site.open(patient), await Core.load(readFileSync(EXHIBITS_WASM)), exhibits);
  }

  async at(...where: Parameters<Site["at"]>): Promise<Page> {
    this.visit = await this.site.at(...where);
    return this.visit.page;
  }

  /** Opens a state in the current page if it is of this file: its module has cached data that takes seconds to compute. */
  async on(...where: Parameters<Site["on"]>): Promise<Page> {
    this.visit = await this.site.on(...where);
    return this.visit.page;
  }

  get errors(): readonly string[] {
    return this.visit?.errors ?? [];
  }

  close(): Promise<void> {
    return this.site.close();
  }

  /** The state in the address, once it is written. */
  async state(id: string): Promise<Record<string, unknown>> {
    const page = this.visit!.page;
    await settled(page);
    const { defaults, parts } = this.exhibits.get(id)!;
    return read(new URL(page.url()).hash, defaults as Record<string, unknown>, parts).state;
  }

  /** The live number, after a check that it is the core's for the state in the address. */
  async number(id: string): Promise<number> {
    const page = this.visit!.page;
    const state = await this.state(id);
    const { question, number, texts } = this.exhibits.get(id)!;
    const answer = this.core.ask("exhibit", { exhibit: id, ...question(state) });
    const language = page.url().includes(".zh.") ? "zh" : "en";
    const say = new Say(language);
    const set = () => undefined;
    const { value, shown } = number({ state, answer, say, texts: texts[language], set, isStill: false, isSmall: false });
    expect(await digits(page, "live")).toBe(value);
    expect(await page.locator(".live data").textContent()).toBe(shown);
    return value!;
  }

  /** As `number`, for an exhibit whose answer takes the core ten seconds: in `make test` only the page computes it. */
  async costly(id: string): Promise<number> {
    if (isLong) return this.number(id);
    await settled(this.visit!.page);
    return digits(this.visit!.page, "live");
  }

  /** The core's number for an exhibit's initial state, from the build of its page. */
  written(file: string): number {
    const html = readFileSync(join(DIST, file), "utf8");
    return Number(/<data [^>]*data-name="live" value="([^"]+)"/.exec(html)![1]);
  }
}

/**
 * A page waits 15 seconds for an answer, which is enough for the module of the pages. The tests' module is half as fast, and two
 * others run at the same time, so a page could give up on an answer that is nearly there and ask again.
 */
export const patient = (page: Page) =>
  page.addInitScript(() => {
    const later = window.setTimeout.bind(window);
    Object.assign(window, { setTimeout: (act: () => void, ms?: number) => later(act, ms === 15_000 ? 50_000 : ms) });
  });

/** Waits until the viewer draws the 3D figure. */
export const live = (page: Page) => page.waitForSelector('.scene[data-viewer="webgl"]');

/** The handle in the figure. */
export const grip = (page: Page) => page.locator(".grip[role=slider]").first();

/** Drags from the middle of an element. */
export async function drag(page: Page, what: ReturnType<Page["locator"]>, dx: number, dy: number, steps = 8) {
  const box = (await what.boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + dx, y + dy, { steps });
  await page.mouse.up();
}
