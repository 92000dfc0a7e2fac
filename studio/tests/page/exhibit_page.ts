// An exhibit's page under test: opened, its state read from the address, its number compared with the core's.
import { readFileSync } from "node:fs";
import type { Page } from "playwright-core";
import { expect } from "vitest";
import { Core } from "../../src/core/module";
import type { AnyExhibit } from "../../src/exhibits/exhibit";
import { read } from "../../src/exhibits/fragment";
import { EXHIBITS } from "../../src/exhibits/index";
import { Say } from "../../src/exhibits/say";
import { EXHIBITS_WASM, Site, digits, settled, type Visit } from "./site";

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
    return new ExhibitPages(await Site.open(), await Core.load(readFileSync(EXHIBITS_WASM)), exhibits);
  }

  async at(...where: Parameters<Site["at"]>): Promise<Page> {
    this.visit = await this.site.at(...where);
    return this.visit.page;
  }

  get errors(): readonly string[] {
    return this.visit?.errors ?? [];
  }

  close(): Promise<void> {
    return this.site.close();
  }

  /** The state that the address holds once the hand rests. */
  async state(id: string): Promise<Record<string, unknown>> {
    const page = this.visit!.page;
    await settled(page);
    const { defaults, parts } = this.exhibits.get(id)!;
    return read(new URL(page.url()).hash, defaults as Record<string, unknown>, parts).state;
  }

  /** The live number, which is what the core says about the state in the address. */
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
}

/** Until the figure in space is drawn by the viewer. */
export const live = (page: Page) => page.waitForSelector('.scene[data-viewer="webgl"]');

/** The handle in the figure. */
export const grip = (page: Page) => page.locator(".grip[role=slider]").first();

/** Drags from the middle of something. */
export async function drag(page: Page, what: ReturnType<Page["locator"]>, dx: number, dy: number, steps = 8) {
  const box = (await what.boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + dx, y + dy, { steps });
  await page.mouse.up();
}
