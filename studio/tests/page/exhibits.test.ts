// The exhibits as readers meet them: numbers that are the core's and change as claimed, by mouse, touch and keys, by address,
// embedded, broken, and without script.
import { readFileSync } from "node:fs";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, beforeEach, describe, expect, test } from "vitest";
import { Core } from "../../src/core/module";
import type { AnyExhibit } from "../../src/exhibits/exhibit";
import { read } from "../../src/exhibits/fragment";
import { EXHIBITS, STOPS, fileOf, fileOfStop } from "../../src/exhibits/index";
import { Say } from "../../src/exhibits/say";
import { EXHIBITS_WASM, Site, digits, seriousFindings, settled, type Visit } from "./site";

let site: Site;
let core: Core;
let visit: Visit | undefined;
const exhibits = new Map<string, AnyExhibit>();
beforeAll(async () => {
  site = await Site.open();
  core = await Core.load(readFileSync(EXHIBITS_WASM));
  for (const entry of EXHIBITS) exhibits.set(entry.id, (await entry.load()).default);
});
afterAll(() => site.close());
beforeEach(async () => {
  await visit?.page.context().close();
  visit = undefined;
});

async function open(...where: Parameters<Site["ready"]>): Promise<Page> {
  visit = await site.ready(...where);
  await settled(visit.page);
  return visit.page;
}

/** The state that the address holds once the hand rests. */
async function stateOf(page: Page, id: string): Promise<Record<string, unknown>> {
  await settled(page);
  const { defaults, parts } = exhibits.get(id)!;
  return read(new URL(page.url()).hash, defaults as Record<string, unknown>, parts).state;
}

/** The live number shown is what the core says about the state in the address. */
async function expectNumber(page: Page, id: string): Promise<number> {
  const state = await stateOf(page, id);
  const { question, number, texts } = exhibits.get(id)!;
  const answer = core.ask("exhibit", { exhibit: id, ...question(state) });
  const language = page.url().includes(".zh.") ? "zh" : "en";
  const { value, shown } = number({
    state,
    answer,
    say: new Say(language),
    texts: texts[language],
    set: () => undefined,
    isStill: false,
    isSmall: false,
  });
  expect(await digits(page, "live")).toBe(value);
  expect(await page.locator(".live data").textContent()).toBe(shown);
  return value!;
}

const live = (page: Page) => page.waitForSelector('.scene[data-viewer="webgl"]');
const grip = (page: Page) => page.locator(".grip[role=slider]").first();

/** Drags from the middle of something. */
async function drag(page: Page, what: ReturnType<Page["locator"]>, dx: number, dy: number, steps = 8) {
  const box = (await what.boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + dx, y + dy, { steps });
  await page.mouse.up();
}

describe.each(EXHIBITS.map((entry) => [entry.id, entry] as const))("%s", (id, entry) => {
  test("says its number as the core does, before and after it is brought to life, in both languages", async () => {
    for (const language of ["en", "zh"] as const) {
      const still = await site.visit(fileOf(id, language), { javaScriptEnabled: false });
      expect(await still.page.locator("h1").textContent()).toBe(entry.claim[language]);
      expect(await still.page.locator("html").getAttribute("lang")).toBe(language === "en" ? "en" : "zh-CN");
      const before = await digits(still.page, "live");
      expect(await still.page.locator(".stage svg path, .stage svg circle").count()).toBeGreaterThan(5);
      expect(await still.page.locator("[style]").count(), "a strict policy forbids styles in the text").toBe(0);
      await still.page.context().close();
      const page = await open(fileOf(id, language));
      expect(await expectNumber(page, id)).toBe(before);
      const n = STOPS.indexOf(entry);
      const [last, next] = [STOPS[n - 1], STOPS[n + 1]];
      const onward = page.locator(".onward a");
      expect(await onward.last().getAttribute("href")).toBe(next ? fileOfStop(next, language) : fileOf("exhibits", language));
      expect(await onward.first().getAttribute("href")).toBe(last ? fileOfStop(last, language) : fileOf("exhibits", language));
      expect(await page.locator(".path [aria-current=page]").textContent()).toBe(String(n + 1));
      expect(visit!.errors).toEqual([]);
      await page.context().close();
      visit = undefined;
    }
  });

  test("axe finds nothing serious, by day and by night, wide and narrow", async () => {
    for (const [colorScheme, width] of [
      ["light", 1200],
      ["dark", 360],
    ] as const) {
      const page = await open(fileOf(id, colorScheme === "dark" ? "zh" : "en"), {
        colorScheme,
        viewport: { width, height: 800 },
      });
      expect(await seriousFindings(page), colorScheme).toEqual([]);
      expect(await page.evaluate(() => document.documentElement.scrollWidth), "nothing sticks out").toBeLessThanOrEqual(width);
      await page.context().close();
      visit = undefined;
    }
  });

  test("embedded it is figure, claim, number and controls; what is damaged in an address is told, and it works", async () => {
    const page = await open(`${fileOf(id, "en")}?embed=1#v=1&p=%%&o=1&h=x&n=x&c=x&s=x&b=x&f=x`);
    expect(await page.locator("header, footer, .prose, .onward").count()).toBe(0);
    expect(await page.locator("h1").textContent()).toBe(entry.claim.en);
    expect(await page.locator(".note").textContent()).toContain("could not be read");
    await expectNumber(page, id);
  });
});

test("quad: lifting D by mouse and keys moves the number and the middle; three corners stay at zero", async () => {
  const page = await open("quad.html");
  await live(page);
  const before = await expectNumber(page, "quad");
  await drag(page, grip(page), 0, 60);
  const after = await expectNumber(page, "quad");
  expect(after).toBeLessThan(before - 0.1);
  expect(await digits(page, "rise")).toBeCloseTo(after / 2, 12);
  await grip(page).focus();
  await page.keyboard.press("ArrowUp");
  await page.keyboard.press("Shift+ArrowUp");
  expect(await expectNumber(page, "quad")).toBeCloseTo(after + 0.11, 2);
  expect(await grip(page).getAttribute("aria-valuetext")).toContain("units");
  await page.locator("input[name=corners][value='3']").check();
  await grip(page).focus();
  for (const key of ["PageUp", "ArrowDown", "End", "Home"]) {
    await page.keyboard.press(key);
    expect(await expectNumber(page, "quad")).toBe(0);
  }
  expect(visit!.errors).toEqual([]);
});

test("quad: a finger turns the figure sideways, two keys turn it back", async () => {
  const page = await open("quad.html", { hasTouch: true, viewport: { width: 400, height: 800 } });
  await live(page);
  const box = (await page.locator(".scene").boundingBox())!;
  const touch = await page.context().newCDPSession(page);
  const at = (dx: number) => [{ x: box.x + 60 + dx, y: box.y + 40 }];
  await touch.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: at(0) });
  for (let dx = 10; dx <= 100; dx += 10) await touch.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: at(dx) });
  await touch.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  const turned = (await stateOf(page, "quad"))["view"] as { azimuth: number; elevation: number };
  expect(turned.azimuth).toBeLessThan(-80);
  await page.locator(".scene").focus();
  await page.keyboard.press("Home");
  expect((await stateOf(page, "quad"))["view"]).toEqual((exhibits.get("quad")!.defaults as { view: unknown }).view);
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("+");
  const near = (await stateOf(page, "quad"))["view"] as { distance: number; azimuth: number };
  expect(near.distance).toBeLessThan(6);
  expect(near.azimuth).not.toBe(turned.azimuth);
});

test("inside: the point is inside exactly where all three signs agree, and clockwise they are all negative", async () => {
  const page = await open("inside.html");
  expect(await expectNumber(page, "inside")).toBe(3);
  await drag(page, grip(page), -250, 0);
  expect(await expectNumber(page, "inside")).toBeLessThan(3);
  expect(await page.locator(".live .meaning").textContent()).toContain("outside");
  await page.goto(`${site.base}inside.html#v=1&w=cw`);
  await page.reload();
  await page.waitForSelector("html[data-settled]");
  expect(await expectNumber(page, "inside")).toBe(0);
  expect(await page.locator(".live .meaning").textContent()).toContain("is inside");
  for (const i of [0, 1, 2]) expect(await digits(page, `edge-${i}`)).toBeLessThan(0);
  // At a corner two edge functions are exactly zero.
  await page.goto(`${site.base}inside.html#v=1&p=2,1.4`);
  await page.reload();
  await page.waitForSelector("html[data-settled]");
  expect([await digits(page, "edge-1"), await digits(page, "edge-2")]).toEqual([0, 0]);
  expect(await page.locator(".live .meaning").textContent()).toContain("On an edge");
});

test("weights: they sum to one everywhere; four corners have two colours in the middle", async () => {
  const page = await open("weights.html");
  await grip(page).focus();
  for (const key of ["ArrowLeft", "PageDown", "Shift+ArrowUp", "PageUp", "Home"]) {
    await page.keyboard.press(key);
    expect(await expectNumber(page, "weights")).toBeCloseTo(1, 14);
  }
  await page.locator("input[name=corners][value='4']").check();
  await page.goto(`${site.base}weights.html#v=1&c=4&p=6,4`);
  await page.reload();
  await page.waitForSelector("html[data-settled]");
  const gap = await expectNumber(page, "weights");
  expect(gap).toBeGreaterThan(0.3);
  const differences = await Promise.all(
    [0, 1, 2].map(async (k) => Math.abs((await digitsOf(page, `color-0-${k}`)) - (await digitsOf(page, `color-1-${k}`)))),
  );
  expect(Math.max(...differences)).toBeCloseTo(gap, 12);
});

async function digitsOf(page: Page, name: string): Promise<number> {
  return digits(page, name);
}

test("weights: what the browser blends at a place is the colour that the core says", async () => {
  const page = await open("weights.html#v=1&p=8,3");
  const shown = await page.locator("svg.flat").screenshot();
  const box = (await page.locator("svg.flat").boundingBox())!;
  // Beside the probe and its spokes; the core is asked about the same place.
  const place = [4.4, 2.2] as const;
  const { question } = exhibits.get("weights")!;
  const answer = core.ask("exhibit", { exhibit: "weights", ...question({ probe: place, corners: "3", cut: "first" }) }) as {
    blends: { color: number[] }[];
  };
  const seen = await page.evaluate(
    async ({ data, x, y }) => {
      const image = await createImageBitmap(
        new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], { type: "image/png" }),
      );
      const canvas = new OffscreenCanvas(image.width, image.height);
      const context = canvas.getContext("2d")!;
      context.drawImage(image, 0, 0);
      return [...context.getImageData(Math.round(x * image.width), Math.round(y * image.height), 1, 1).data];
    },
    {
      data: shown.toString("base64"),
      x: (place[0] * 60 + 1) / (box.width * (722 / box.width)),
      y: ((8 - place[1]) * 60 + 1) / (box.height * (482 / box.height)),
    },
  );
  answer.blends[0]!.color.forEach((channel, k) => expect(Math.abs(seen[k]! - 255 * channel)).toBeLessThan(4));
});

test("index: bytes are 12 a vertex and 6 a triangle, and 36 a triangle without", async () => {
  const page = await open("indexed.html");
  await live(page);
  for (const storage of ["indexed", "unindexed"]) {
    await page.locator(`input[name=storage][value=${storage}]`).check();
    for (const stop of ["0", "6", "12"]) {
      await page.locator("#triangles").fill(stop);
      const bytes = await expectNumber(page, "indexed");
      const n = await digits(page, "triangles");
      const vertices = await digits(page, "vertices");
      const each = await digits(page, "per-vertex");
      // Three corners a triangle, so many at a vertex.
      expect(vertices * each).toBeCloseTo(3 * n, 6);
      expect(bytes).toBe(storage === "indexed" ? 12 * vertices + 6 * n : 36 * n);
    }
  }
  expect(await digits(page, "ring")).toBeGreaterThan(3);
});

test("normals: a cube has 24 vertices below 90°, 8 above; a ball's normals cost nothing where it is smooth", async () => {
  const page = await open("normals.html");
  await live(page);
  const slider = page.locator("#crease");
  expect(await expectNumber(page, "normals")).toBe(24);
  await slider.fill("89");
  expect(await expectNumber(page, "normals")).toBe(24);
  await slider.focus();
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowRight");
  expect(await expectNumber(page, "normals")).toBe(8);
  await page.locator("input[name=shape][value=ball]").check();
  expect(await expectNumber(page, "normals")).toBe(162);
  await slider.fill("0");
  expect(await expectNumber(page, "normals")).toBe(960);
  expect(await digits(page, "positions")).toBe(162);
});

test("culling: a pressed triangle is turned, breaks three edges and leaves a hole; from behind there is none", async () => {
  const page = await open("culling.html#v=1&f=");
  await live(page);
  expect(await expectNumber(page, "culling")).toBe(0);
  const box = (await page.locator(".scene").boundingBox())!;
  await page.mouse.click(box.x + box.width / 2 + 4, box.y + box.height / 2 + 3);
  await settled(page);
  expect(await expectNumber(page, "culling")).toBe(1);
  expect(await digits(page, "inconsistent")).toBe(3);
  const { flipped } = (await stateOf(page, "culling")) as { flipped: number[] };
  expect(flipped.length).toBe(1);
  await drag(page, page.locator(".scene"), 440, 0, 20);
  expect(await expectNumber(page, "culling")).toBe(0);
  expect(await digits(page, "back-share")).toBeGreaterThan(0.35);
  await page.getByRole("button", { name: "Turn all of them over" }).click();
  await page.getByRole("button", { name: "Turn it over" }).click();
  await settled(page);
  expect(await digits(page, "inconsistent")).toBe(0);
  expect(visit!.errors).toEqual([]);
});

test("doctor: every patient is healed by the buttons that are offered", async () => {
  const page = await open("doctor.html");
  for (const patient of ["hole", "seam", "crack", "flipped", "branch", "double"]) {
    await page.locator(`input[name=patient][value=${patient}]`).check();
    await settled(page);
    expect(await expectNumber(page, "doctor"), patient).toBeGreaterThan(0);
    const cure = page.locator(".findings button").first();
    for (let i = 0; (await cure.count()) > 0; i++) {
      expect(i, patient).toBeLessThan(4);
      await cure.click();
      await settled(page);
    }
    expect(await expectNumber(page, "doctor"), patient).toBe(0);
    expect(await digits(page, "closed")).toBe(1);
    expect(await digits(page, "volume")).toBeGreaterThan(3);
    await page.getByRole("button", { name: "Take the last one back" }).click();
    await settled(page);
  }
  expect(visit!.errors).toEqual([]);
});

test("the list of all has a figure and a link for each, and works without script", async () => {
  for (const language of ["en", "zh"] as const) {
    visit = await site.visit(fileOf("exhibits", language), { javaScriptEnabled: false });
    const { page } = visit;
    for (const { id, title } of EXHIBITS) {
      const card = page.locator(`.cards a[href="${fileOf(id, language)}"]`);
      expect(await card.locator("h3").textContent()).toContain(title[language]);
      expect(await card.locator("svg path").count()).toBeGreaterThan(3);
    }
    await page.context().close();
    visit = await site.visit(fileOf("exhibits", language));
    expect(await seriousFindings(visit.page)).toEqual([]);
    await visit.page.context().close();
    visit = undefined;
  }
});

test("the other language's page opens with the same state", async () => {
  const page = await open("quad.html#v=1&h=0.3");
  await page.getByRole("link", { name: "中文" }).click();
  await page.waitForURL(/quad\.zh\.html#v=1&h=0\.3$/);
  await page.waitForSelector("html[data-settled]");
  expect(await expectNumber(page, "quad")).toBeCloseTo(0.3, 12);
});

test("the viewer rests when nothing changes, and a lost context comes back", async () => {
  const page = await open("culling.html", {
    prepare: (page) =>
      page.addInitScript(() => {
        const work = { draws: 0 };
        Object.assign(window, { work });
        for (const name of ["drawArrays", "drawElements", "drawArraysInstanced"] as const) {
          const draw = WebGL2RenderingContext.prototype[name] as (...args: unknown[]) => void;
          Object.assign(WebGL2RenderingContext.prototype, {
            [name](this: WebGL2RenderingContext, ...args: unknown[]) {
              work.draws += 1;
              draw.apply(this, args);
            },
          });
        }
      }),
  });
  await live(page);
  const draws = () => page.evaluate(() => (window as unknown as { work: { draws: number } }).work.draws);
  // Whatever was asked for is drawn within a few frames; after that there is nothing to do.
  await page.evaluate(() => new Promise<void>((done) => setTimeout(done, 1200)));
  const before = await draws();
  await page.evaluate(() => new Promise<void>((done) => setTimeout(done, 400)));
  expect(await draws()).toBe(before);
  expect(before).toBeGreaterThan(0);
  await page.locator(".scene").focus();
  await page.keyboard.press("ArrowLeft");
  await settled(page);
  expect(await draws()).toBeGreaterThan(before);
  const lost = await page.evaluate(async () => {
    const canvas = document.querySelector<HTMLCanvasElement>(".scene canvas")!;
    const { work } = window as unknown as { work: { draws: number } };
    const extension = canvas.getContext("webgl2")!.getExtension("WEBGL_lose_context")!;
    const next = (type: string) => new Promise((done) => canvas.addEventListener(type, done, { once: true }));
    const gone = next("webglcontextlost");
    extension.loseContext();
    await gone;
    const before = work.draws;
    const back = next("webglcontextrestored");
    // The browser lets a context be restored once its loss was handled.
    setTimeout(() => extension.restoreContext(), 50);
    await back;
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    return work.draws - before;
  });
  expect(lost).toBeGreaterThan(0);
});

test("without WebGL the figure is drawn flat, and still turns and counts", async () => {
  const page = await open("culling.html#v=1&f=", {
    prepare: (page) =>
      page.addInitScript(() => {
        const get = HTMLCanvasElement.prototype.getContext;
        Object.assign(HTMLCanvasElement.prototype, {
          getContext(this: HTMLCanvasElement, kind: string, ...rest: unknown[]) {
            return kind.startsWith("webgl") ? null : (get as (...args: unknown[]) => unknown).call(this, kind, ...rest);
          },
        });
      }),
  });
  await page.waitForSelector('.scene[data-viewer="svg"]');
  const before = await page.locator(".scene svg").innerHTML();
  await page.locator(".scene").focus();
  await page.keyboard.press("ArrowLeft");
  await settled(page);
  expect(await page.locator(".scene svg").innerHTML()).not.toBe(before);
  const box = (await page.locator(".scene").boundingBox())!;
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await settled(page);
  expect(await expectNumber(page, "culling")).toBe(1);
});
