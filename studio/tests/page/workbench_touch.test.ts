// The workbench by touch: numbers of the script are dragged, one finger turns the shape, two zoom.
import type { CDPSession, Locator, Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, expect, test, vi } from "vitest";
import { Site, digits, settled } from "./site";
import { PATIENCE, Workbenches, faults, line, panel, small } from "./workbench_page";

vi.setConfig(PATIENCE);

let site: Site;
let pages: Workbenches;
beforeAll(async () => {
  site = await Site.open();
  pages = new Workbenches(site);
});
afterEach((context) => pages.close(context));
afterAll(() => site.close());

type Point = readonly [x: number, y: number];

/** Fingers on a page. */
class Hand {
  private constructor(private readonly session: CDPSession) {}

  static of = async (page: Page) => new Hand(await page.context().newCDPSession(page));

  private send(type: "touchStart" | "touchMove" | "touchEnd", at: readonly Point[]) {
    return this.session.send("Input.dispatchTouchEvent", { type, touchPoints: at.map(([x, y], id) => ({ x, y, id })) });
  }

  /** Moves each finger from its first position to its last. */
  async stroke(from: readonly Point[], to: readonly Point[]): Promise<void> {
    await this.send("touchStart", from);
    for (let i = 1; i <= MOVES; i++) {
      const at = from.map(([x, y], k): Point => [x + ((to[k]![0] - x) * i) / MOVES, y + ((to[k]![1] - y) * i) / MOVES]);
      await this.send("touchMove", at);
    }
    await this.send("touchEnd", []);
  }
}
const MOVES = 10;

const phone = { hasTouch: true, isMobile: true, viewport: { width: 390, height: 844 } };

/** The middle of an element, after it was scrolled into view. */
async function middleOf(what: Locator): Promise<Point> {
  await what.scrollIntoViewIfNeeded();
  const { x, y, width, height } = (await what.boundingBox())!;
  return [x + width / 2, y + height / 2];
}

test("a finger drags a number of the script; the result is proved, and one step of undo", async () => {
  const { page, errors } = await pages.open(await small("box(2, 1, 1)"), phone);
  const before = await digits(page, "bound");
  await panel(page, "input");
  const number = page.locator(".cm-number").first();
  await number.waitFor();
  const [x, y] = await middleOf(number);
  const hand = await Hand.of(page);
  await hand.stroke([[x, y]], [[x + 100, y]]);
  const script = () => page.locator(".cm-line").first().textContent();
  const [, dragged] = /^box\((.+), 1, 1\)$/.exec((await script())!)!;
  expect(Number(dragged)).toBeGreaterThan(2);
  await settled(page);
  expect(await page.locator(".certificate .proved").count()).toBe(1);
  // Half a percent of a longer diagonal.
  expect(await digits(page, "bound")).not.toBe(before);
  await page.getByRole("button", { name: "Undo" }).tap();
  await expect.poll(script).toBe("box(2, 1, 1)");
  // A vertical stroke scrolls the text.
  await hand.stroke([[x, y]], [[x + 2, y - 100]]);
  expect(await script()).toBe("box(2, 1, 1)");
  expect(faults(errors)).toEqual([]);
});

test("one finger turns the shape, two zoom, and the page never scrolls", async () => {
  const { page, errors } = await pages.open(await small("box(4, 1, 1)"), phone);
  await panel(page, "input");
  await page.locator('input[name=budget][value="px"]').check({ force: true });
  await page.getByRole("button", { name: /^Close/ }).tap();
  // Pixels are counted from the eye to the box: the view in the command line.
  const away = async () => {
    await settled(page);
    return Number(/dist=([\d.]+)/.exec((await line(page))!)![1]);
  };
  await expect.poll(() => line(page)).toContain("dist=");
  const first = await away();
  const hand = await Hand.of(page);
  const scene = page.locator(".stage-column .scene");
  const [x, y] = await middleOf(scene);
  await hand.stroke([[x - 80, y]], [[x + 80, y]]);
  const turned = await away();
  expect(Math.abs(turned / first - 1)).toBeGreaterThan(0.01);
  // From 60 pixels apart to 150, and back: the eye moves towards the centre, and only part of that way is outside of the box.
  await hand.stroke([[x - 30, y], [x + 30, y]], [[x - 75, y], [x + 75, y]]);
  const near = await away();
  expect(near).toBeLessThan(0.5 * turned);
  await hand.stroke([[x - 75, y], [x + 75, y]], [[x - 30, y], [x + 30, y]]);
  expect((await away()) / turned).toBeCloseTo(1, 1);
  // Up and down as well, since there is no page to scroll.
  const still = await away();
  await hand.stroke([[x, y]], [[x + 2, y + 150]]);
  expect(Math.abs((await away()) / still - 1)).toBeGreaterThan(0.01);
  expect(await page.evaluate(() => [scrollY, document.documentElement.scrollHeight <= innerHeight])).toEqual([0, true]);
  expect(faults(errors)).toEqual([]);
});
