// How many frames a second the graphics card traces of a field while it turns. Only a graphics card is judged; what a processor does
// in its place is measured as well, and told.
import { afterAll, beforeAll, expect, test, vi } from "vitest";
import { Site, settled } from "../page/site";
import { example, panel } from "../page/workbench_page";
import { Table } from "./judge";

vi.setConfig({ testTimeout: 300_000 });
const STEP_MS = 120_000;
/** For so many frames or so long it is turned, whichever ends first. */
const FRAMES = 240;
const MOST_MS = 8000;

let site: Site;
let renderer = "";
let table: Table;
beforeAll(async () => {
  site = await Site.open(async () => undefined, { hasCard: true });
  const { page } = await site.visit("exhibits.html");
  renderer = await page.evaluate(() => {
    const gl = document.createElement("canvas").getContext("webgl2");
    const info = gl?.getExtension("WEBGL_debug_renderer_info");
    return gl ? String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER)) : "none";
  });
  await page.context().close();
  const isCard = !/swiftshader|llvmpipe|softpipe|software|basic render|^none$/i.test(renderer);
  const judges = isCard ? { isJudged: true } : { isJudged: false, why: `there is no graphics card here, and the processor draws (${renderer})` };
  table = new Table(`A traced field while it turns, by ${renderer}`, ["example", "frames", "picture"], judges);
});
afterAll(async () => {
  table?.print();
  await site.close();
});

test.each(["bracket", "gyroid_cube"])("%s", async (name) => {
  const { page } = await site.ready("workbench.html?live=1", {
    viewport: { width: 1366, height: 768 },
    prepare: async (page) => {
      page.setDefaultTimeout(STEP_MS);
      // Counts the frames in which the field's canvas was drawn.
      await page.addInitScript(() => {
        const drawn = { frames: 0 };
        Object.assign(window, { drawn });
        let isDrawn = false;
        for (const call of ["drawArrays", "drawElements"] as const) {
          const draw = WebGL2RenderingContext.prototype[call] as (...args: unknown[]) => void;
          Object.assign(WebGL2RenderingContext.prototype, {
            [call](this: WebGL2RenderingContext, ...args: unknown[]) {
              isDrawn ||= (this.canvas as HTMLCanvasElement).closest(".card-picture") !== null;
              draw.apply(this, args);
            },
          });
        }
        const count = () => {
          if (isDrawn) drawn.frames += 1;
          isDrawn = false;
          requestAnimationFrame(count);
        };
        requestAnimationFrame(count);
      });
    },
  });
  await page.locator(".cm-content").waitFor();
  await example(page, name);
  await panel(page, "beside");
  await page.waitForSelector(".live-field[data-live]");
  await settled(page);
  const { frames, ms, size } = await page.evaluate(
    async ([most, mostMs]) => {
      const field = document.querySelector<HTMLElement>(".live-field")!;
      const { drawn } = window as unknown as { drawn: { frames: number } };
      const turn = () => field.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft", bubbles: true, cancelable: true }));
      const frame = () => new Promise<number>(requestAnimationFrame);
      // The first frames may wait for each other's work in no queue yet.
      for (let i = 0; i < 3; i++) {
        turn();
        await frame();
      }
      const [before, from] = [drawn.frames, performance.now()];
      while (drawn.frames - before < most! && performance.now() - from < mostMs!) {
        turn();
        await frame();
      }
      // What is still in the queue of the card counts, too.
      const canvas = document.querySelector<HTMLCanvasElement>(".card-picture canvas")!;
      canvas.getContext("webgl2")!.readPixels(0, 0, 1, 1, WebGL2RenderingContext.RGBA, WebGL2RenderingContext.UNSIGNED_BYTE, new Uint8Array(4));
      return { frames: drawn.frames - before, ms: performance.now() - from, size: [canvas.width, canvas.height] as const };
    },
    [FRAMES, MOST_MS],
  );
  expect(frames, "the field was drawn while it turned").toBeGreaterThan(1);
  expect(table.add(name, { what: "frames", value: (1000 * frames) / ms }, size.join(" × "))).toEqual([]);
  await page.context().close();
});
