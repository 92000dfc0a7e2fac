// A drag of sixty moves along a wave, like a hand's, for tests and benches that count or time the page's work.
import type { Locator, Page } from "playwright-core";

const MOVES = 60;

/** Drags the middle of an element. Each move waits for its answer and its frame. */
export async function wave(page: Page, what: Locator, begin: () => Promise<unknown>): Promise<void> {
  const box = (await what.boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await begin();
  for (let i = 1; i <= MOVES; i++) {
    await page.mouse.move(x + i * 2, y + 30 * Math.sin(i / 6));
    await new Promise((next) => setTimeout(next, 40));
  }
}

/** A handle of the first figure. */
export const handleOf = (page: Page, n: number) => page.locator("svg[data-figure] [role=slider]").nth(n).locator(".dot");

/** The main thread's work: pointer moves that arrived, questions to the worker, frames, changed nodes. */
export interface Work {
  moves: number;
  questions: number;
  frames: number;
  mutations: number;
}

/** Counts from the page's first script on; `workOf` reads the counts. */
export async function countWork(page: Page): Promise<void> {
  await page.addInitScript(() => {
    const work = { moves: 0, questions: 0, frames: 0, mutations: 0 };
    Object.assign(window, { work });
    addEventListener("pointermove", () => (work.moves += 1), true);
    const post = Worker.prototype.postMessage;
    Worker.prototype.postMessage = function (this: Worker, ...sent: [unknown]) {
      work.questions += 1;
      return post.apply(this, sent as never);
    };
    const request = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (draw) =>
      request((time) => {
        work.frames += 1;
        draw(time);
      });
    new MutationObserver((all) => (work.mutations += all.length)).observe(document, {
      subtree: true,
      childList: true,
      attributes: true,
      characterData: true,
    });
  });
}

/** The counts so far. */
export const workOf = (page: Page): Promise<Work> => page.evaluate(() => ({ ...(window as unknown as { work: Work }).work }));
