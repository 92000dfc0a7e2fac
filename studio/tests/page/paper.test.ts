// Pages on paper, as a picture: a page is printed to PDF, and the browser's viewer draws the sheet. A browser that shows the page
// by other means than its printer has may print other colours than it shows, as with blend modes that PDF lacks.
import type { Page } from "playwright-core";
import { type TestContext, afterAll, beforeAll, expect, test } from "vitest";
import { CORNERS } from "../../src/exhibits/paint";
import { Site, isLong, settled } from "./site";

type Point = readonly [x: number, y: number];
type Color = readonly [r: number, g: number, b: number];
/** The mean colour of a square of pixels, and how far its channels are from it at most. */
interface Seen {
  color: Color;
  spread: number;
}

/** A4 and its margins, in CSS pixels, of which an inch has 96. */
const SHEET_PX = (210 / 25.4) * 96;
const MARGIN_PX = (10 / 25.4) * 96;
const INNER_PX = Math.floor(SHEET_PX - 2 * MARGIN_PX);
/** Steps of a channel that a colour may be off. Chosen: two pixels along a gradient of 250, and the steps of a printed one. */
const NEAR = 12;

let site: Site;
beforeAll(async () => {
  site = await Site.open();
});
afterAll(() => site.close());

/** Opens a page in dark colours, as those of the screen must not be those of paper. */
async function open(file: string, context: TestContext): Promise<Page> {
  const { page } = await site.ready(file, { colorScheme: "dark" });
  await settled(page);
  if (await page.locator(".scene").count()) await page.waitForSelector('.scene[data-viewer="webgl"]');
  const hasViewer = await page.evaluate(() => navigator.pdfViewerEnabled);
  if (!hasViewer) {
    console.warn(`${file}: NOT LOOKED AT ON PAPER, because this browser has no viewer of PDF`);
    context.skip("this browser has no viewer of PDF");
  }
  return page;
}

/** Prints a page, opens its first sheet in the viewer, and turns the page itself to what is printed, as wide as the sheet. */
async function print(page: Page): Promise<Page> {
  const margin = "10mm";
  const pdf = await page.pdf({ format: "A4", margin: { top: margin, right: margin, bottom: margin, left: margin } });
  const viewer = await page.context().newPage();
  await viewer.setViewportSize({ width: 900, height: 1200 });
  const html = '<!doctype html><style>body { margin: 0; background: #000 }</style><embed src="sheet.pdf#toolbar=0&navpanes=0&zoom=100" type="application/pdf" width="900" height="1200">';
  await viewer.route("**/sheet.html", (route) => route.fulfill({ body: html, contentType: "text/html" }));
  await viewer.route("**/sheet.pdf", (route) => route.fulfill({ body: pdf, contentType: "application/pdf" }));
  await viewer.goto(`${site.base}sheet.html`);
  await page.setViewportSize({ width: INNER_PX, height: 1000 });
  await page.emulateMedia({ media: "print", colorScheme: "dark" });
  await settled(page);
  return viewer;
}

/** The squares around points of a picture; on the viewer's, of points of the printed page, once its sheet is there. */
async function colorsOf(viewer: Page, picture: Buffer, points: readonly Point[], half: number, isSheet: boolean): Promise<Seen[] | null> {
  return viewer.evaluate(
    async ({ png, points, half, sheet }) => {
      const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(png), (c) => c.charCodeAt(0))]));
      const { width, height } = bitmap;
      const pencil = new OffscreenCanvas(width, height).getContext("2d")!;
      pencil.drawImage(bitmap, 0, 0);
      const { data } = pencil.getImageData(0, 0, width, height);
      const at = (x: number, y: number) => data.subarray(4 * (y * width + x), 4 * (y * width + x) + 3);
      const isWhite = (x: number, y: number) => at(x, y).every((channel) => channel > 250);
      let [left, top, scale] = [0, 0, 1];
      if (sheet) {
        // The sheet begins and ends with white, whatever is on it.
        const row = [...Array(width).keys()].filter((x) => isWhite(x, height >> 1));
        if (row.length === 0) return null;
        left = row[0]!;
        scale = (row.at(-1)! + 1 - left) / sheet.width;
        const column = [...Array(height).keys()].filter((y) => isWhite(left + 3, y));
        top = column[0]!;
        [left, top] = [left + sheet.margin * scale, top + sheet.margin * scale];
      }
      return points.map(([x, y]) => {
        const [cx, cy] = [Math.round(left + x * scale), Math.round(top + y * scale)];
        const all: number[][] = [];
        for (let dy = -half; dy <= half; dy++) for (let dx = -half; dx <= half; dx++) all.push([...at(cx + dx, cy + dy)]);
        const color = [0, 1, 2].map((k) => all.reduce((sum, one) => sum + one[k]!, 0) / all.length) as unknown as Color;
        return { color, spread: Math.max(...all.flatMap((one) => one.map((channel, k) => Math.abs(channel - color[k]!)))) };
      });
    },
    { png: picture.toString("base64"), points, half, sheet: isSheet ? { width: SHEET_PX, margin: MARGIN_PX } : null },
  );
}

const onSheet = async (viewer: Page, points: readonly Point[], half = 0) => colorsOf(viewer, await viewer.screenshot(), points, half, true);
const isFar = ({ color: a }: Seen, b: Color) => a.some((channel, k) => Math.abs(channel - b[k]!) > NEAR);
const written = (color: Color) => color.map(Math.round).join(" ");

/** Weights that are off all lines of the figure, which lead from the corners to its middle: near a corner, an edge, and between. */
const WEIGHTS = [[0.86, 0.11, 0.03], [0.6, 0.3, 0.1], [0.48, 0.47, 0.05]].flatMap(([a, b, c]) => [[a, b, c], [a, c, b], [b, a, c], [b, c, a], [c, a, b], [c, b, a]] as [number, number, number][]);

/** Points of the triangle on the printed page, with the colours that their weights give. */
async function blended(page: Page): Promise<{ points: Point[]; colors: Color[] }> {
  const corners = await page.locator(".blended .base").evaluate((path) => {
    const matrix = (path as SVGPathElement).getScreenCTM()!;
    const numbers = path.getAttribute("d")!.match(/-?[\d.]+/g)!.map(Number);
    return [0, 1, 2].map((k) => {
      const { x, y } = new DOMPoint(numbers[2 * k], numbers[2 * k + 1]).matrixTransform(matrix);
      return [x + scrollX, y + scrollY] as const;
    });
  });
  const mixed = (of: readonly (readonly number[])[], weights: readonly number[], k: number) => weights.reduce((sum, weight, corner) => sum + weight * of[corner]![k]!, 0);
  return {
    points: WEIGHTS.map((weights) => [mixed(corners, weights, 0), mixed(corners, weights, 1)] as const),
    colors: WEIGHTS.map((weights) => [0, 1, 2].map((k) => 255 * mixed(CORNERS, weights, k)) as unknown as Color),
  };
}

test("the triangle of three colours is printed in the mixtures of its corners", async (context) => {
  const page = await open("weights.html", context);
  const viewer = await print(page);
  const { points, colors } = await blended(page);
  const wrong = async () => {
    const seen = await onSheet(viewer, points);
    return seen?.flatMap((one, i) => (isFar(one, colors[i]!) ? [`${WEIGHTS[i]}: ${written(one.color)} for ${written(colors[i]!)}`] : [])) ?? ["no sheet"];
  };
  await expect.poll(wrong).toEqual([]);
  await page.context().close();
});

test("colours that PDF cannot add are seen to be wrong on paper, although the screen has them right", async (context) => {
  const page = await open("weights.html", context);
  // As the triangle was drawn once: the ramps are added to black.
  await page.evaluate(() => {
    const rules = [".blended .base { fill: #000 !important }", ".blended .ramp { mix-blend-mode: plus-lighter !important }", ".blended .turned-back { display: none }"];
    for (const rule of rules) document.styleSheets[0]!.insertRule(rule);
  });
  const viewer = await print(page);
  const { points, colors } = await blended(page);
  const shown = (await colorsOf(viewer, await page.screenshot({ fullPage: true }), points, 0, false))!;
  expect(shown.filter((one, i) => isFar(one, colors[i]!)).map(({ color }) => written(color))).toEqual([]);
  // Once the triangle is there, no longer in the white of the sheet.
  let seen: Seen[] = [];
  await expect.poll(async () => (seen = (await onSheet(viewer, points)) ?? []).filter(({ color }) => Math.min(...color) < 240).length).toBe(points.length);
  expect(seen.filter((one, i) => isFar(one, colors[i]!)).length).toBeGreaterThan(WEIGHTS.length / 2);
  await page.context().close();
});

/** Half of a square of pixels, and how even its colours are, less than what they may be off, with two pixels around: a line
 * is printed up to a pixel off. */
const HALF = 5;
const EVEN = 8;

const LOOKED_AT = isLong ? ["pixels", "tangent", "quad", "cross", "normals", "squares", "tracing", "blend"] : ["pixels", "tangent"];
for (const id of LOOKED_AT) {
  test(`${id} is printed in the colours that its page has for paper`, async (context) => {
    const page = await open(`${id}.html`, context);
    const viewer = await print(page);
    const box = (await page.locator(".stage").first().boundingBox())!;
    const grid: Point[] = [];
    for (let y = box.y + 2 * HALF; y < box.y + box.height - 2 * HALF; y += HALF) for (let x = box.x + 2 * HALF; x < box.x + box.width - 2 * HALF; x += HALF) grid.push([x, y]);
    const shown = (await colorsOf(viewer, await page.screenshot({ fullPage: true }), grid, HALF + 2, false))!;
    // The insides of what is painted.
    const inside = shown.flatMap(({ color, spread }, i) => (spread < EVEN && Math.min(...color) < 235 ? [{ color, at: grid[i]! }] : []));
    expect(inside.length).toBeGreaterThan(20);
    const wrong = async () => {
      const seen = await onSheet(viewer, inside.map(({ at }) => at), HALF);
      return seen?.flatMap((one, i) => (isFar(one, inside[i]!.color) ? [`at ${inside[i]!.at.map(Math.round)}: ${written(one.color)} for ${written(inside[i]!.color)}`] : [])) ?? ["no sheet"];
    };
    await expect.poll(wrong).toEqual([]);
    await page.context().close();
  });
}
