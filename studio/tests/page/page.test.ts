// The page in a browser: by hand, by keys, by address, embedded, broken, and without script.
import { readFileSync } from "node:fs";
import { afterAll, beforeAll, describe, expect, test } from "vitest";
import type { Page } from "playwright-core";
import { Core } from "../../src/core/module";
import { read } from "../../src/state/fragment";
import { DEFAULTS, type State } from "../../src/state/state";
import { Frame } from "../../src/view/frame";
import { countWork, handleOf, type Work, wave, workOf } from "./drag";
import { Site, WASM, digits, isLong, axeFindings, settled, type Opening, type Visit } from "./site";

let site: Site;
let core: Core;
let visit: Visit;
beforeAll(async () => {
  site = await Site.open();
  core = await Core.load(readFileSync(WASM));
});
afterAll(() => site.close());
async function open(...where: Parameters<Site["at"]>): Promise<Page> {
  visit = await site.at(...where);
  return visit.page;
}
/** Opens a fragment in the current page, if it is this one. */
async function stay(fragment = "#v=1", options: Opening = {}): Promise<Page> {
  visit = await site.on("", fragment, options);
  return visit.page;
}

const handle = (page: Page, i: number) => page.locator("svg[data-figure] [role=slider]").nth(i);

/** The state in the address, once it is written. */
async function stateOf(page: Page): Promise<State> {
  await settled(page);
  return read(new URL(page.url()).hash).state;
}

/** The core's answer for the page's state, at the page's scale. */
async function expected(page: Page, state: State) {
  const { width, density } = await page.evaluate(() => ({
    width: Math.round(document.querySelector(".stage .drawing")!.getBoundingClientRect().width),
    density: devicePixelRatio,
  }));
  const scale = new Frame(width).scale;
  const pixels_per_unit = scale * (state.density || density);
  return core.ask("study", { control: state.control, segments: state.segments, other: 1, pixels_per_unit, pixels: state.goal, t: state.t, near: 1 });
}

async function expectNumbers(page: Page, state: State) {
  const answer = await expected(page, state);
  const chain = answer[state.spacing];
  expect(await digits(page, "gap-pixels")).toBe(chain.gap!.pixels);
  expect(await digits(page, "gap-units")).toBe(chain.gap!.distance);
  expect(await digits(page, "bound-units")).toBe(chain.bound.at_most);
  for (const spacing of ["even", "fewest"] as const) {
    expect(await digits(page, `${spacing}-gap-pixels`)).toBe(answer[spacing].gap!.pixels);
    expect(await digits(page, `${spacing}-bound-pixels`)).toBe(answer[spacing].bound.pixels);
    expect(await digits(page, `needed-${spacing}`)).toBe(answer.needed[spacing]);
  }
}

/** Twice, because sections are laid out when they come into view, which moves those below. */
async function intoSight(page: Page, what: string) {
  for (let i = 0; i < 2; i++) {
    await page.locator(what).scrollIntoViewIfNeeded();
    await settled(page);
  }
}

async function drag(page: Page, i: number, dx: number, dy: number, steps = 8) {
  const box = (await handle(page, i).locator(".dot").boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + dx, y + dy, { steps });
  await page.mouse.up();
}

describe("one curve", () => {
  test("the numbers on the page are the core's, digit for digit", async () => {
    const page = await open();
    await expectNumbers(page, DEFAULTS);
    expect(visit.errors).toEqual([]);
  });

  test("a dragged point moves the curve, the numbers and the address", async () => {
    const page = await stay();
    await drag(page, 1, 60, 40);
    const state = await stateOf(page);
    expect(state.control[1]).not.toEqual(DEFAULTS.control[1]);
    expect(state.control[0]).toEqual(DEFAULTS.control[0]);
    const scale = await page.evaluate(() => document.querySelector(".stage .drawing")!.getBoundingClientRect().width / 10.8);
    expect(state.control[1]![0] - DEFAULTS.control[1]![0]).toBeCloseTo(60 / scale, 1);
    expect(DEFAULTS.control[1]![1] - state.control[1]![1]).toBeCloseTo(40 / scale, 1);
    await expectNumbers(page, state);
    expect(visit.errors).toEqual([]);
  });

  test("a point dragged out of the figure stays inside the drawing", async () => {
    const page = await stay();
    await drag(page, 3, 3000, -3000);
    expect((await stateOf(page)).control[3]).toEqual([10, 6]);
  });

  test("a finger moves a point as the mouse does", async () => {
    const page = await open("", { hasTouch: true, viewport: { width: 400, height: 800 } });
    const box = (await handle(page, 0).locator(".dot").boundingBox())!;
    const touch = await page.context().newCDPSession(page);
    const at = (dx: number) => [{ x: box.x + box.width / 2 + dx, y: box.y + box.height / 2 }];
    await touch.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: at(0) });
    for (let dx = 5; dx <= 60; dx += 5) await touch.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: at(dx) });
    await touch.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
    const state = await stateOf(page);
    expect(state.control[0]![0]).toBeGreaterThan(DEFAULTS.control[0]![0] + 0.5);
  });

  test("every handle moves by keys and announces its position", async () => {
    const page = await stay();
    for (let i = 0; i < 4; i++) {
      await handle(page, i).focus();
      const [x, y] = DEFAULTS.control[i]!;
      await page.keyboard.press("ArrowRight");
      await page.keyboard.press("ArrowRight");
      await page.keyboard.press("ArrowDown");
      await page.keyboard.press("Shift+ArrowLeft");
      await settled(page);
      const spoken = `x ${(x + 0.2 - 0.01).toFixed(2)}, y ${(y - 0.1).toFixed(2)}`;
      expect(await handle(page, i).getAttribute("aria-valuetext")).toBe(spoken);
    }
    const state = await stateOf(page);
    expect(state.control[0]).toEqual([1.19, 0.7]);
    await expectNumbers(page, state);
  });

  test("the number of segments is chosen by slider, by buttons and in the plot", async () => {
    const page = await stay();
    const slider = page.getByLabel("Segments", { exact: true });
    await slider.focus();
    await page.keyboard.press("ArrowRight");
    await settled(page);
    expect(await slider.getAttribute("aria-valuetext")).toBe("7 segments");
    await page.getByRole("button", { name: "Twice as many segments" }).click();
    await page.getByRole("button", { name: "Twice as many segments" }).click();
    await page.getByRole("button", { name: "One segment fewer" }).click();
    const state = await stateOf(page);
    expect(state.segments).toBe(27);
    await expectNumbers(page, state);
    await intoSight(page, "svg.plot");
    const plot = (await page.locator("svg.plot").boundingBox())!;
    await page.locator("svg.plot").click({ position: { x: plot.width - 17, y: plot.height / 2 } });
    expect((await stateOf(page)).segments).toBeGreaterThan(120);
  });

  test("the first proved number is offered, shown, and sufficient", async () => {
    const page = await stay();
    await page.locator("input[name=goal][value='0.25']").check();
    await settled(page);
    await page.getByRole("button", { name: /segments where it bends$/ }).click();
    const state = await stateOf(page);
    expect([state.goal, state.spacing]).toEqual([0.25, "fewest"]);
    expect(state.segments).toBe((await expected(page, state)).needed.fewest);
    expect(await page.locator(".verdicts [data-verdict]").evaluateAll((all) => all.map((one) => one.getAttribute("data-verdict")))).toEqual([
      "smooth", "smooth", "smooth",
    ]);
    expect(await page.locator(".headline").textContent()).toContain("It looks smooth");
  });

  test("on a denser screen the same gap is more pixels", async () => {
    const page = await stay();
    const once = await digits(page, "gap-pixels");
    for (const density of [1, 2, 3]) {
      await page.locator(`input[name=density][value="${density}"]`).check();
      await settled(page);
      expect(await digits(page, "gap-pixels")).toBeCloseTo(once * density, 9);
    }
    await open("", { deviceScaleFactor: 2 });
    expect(await digits(visit.page, "gap-pixels")).toBeCloseTo(once * 2, 9);
  });

  test("de Casteljau's point is dragged along the curve and by its slider", async () => {
    const page = await stay();
    const rider = page.locator(".rider");
    await intoSight(page, ".rider");
    const box = (await rider.locator(".dot").boundingBox())!;
    await page.mouse.move(box.x + 8, box.y + 8);
    await page.mouse.down();
    await page.mouse.move(box.x + 200, box.y + 60, { steps: 6 });
    await page.mouse.up();
    const state = await stateOf(page);
    expect(state.t).toBeGreaterThan(DEFAULTS.t + 0.1);
    const slider = page.getByLabel("Share of the way, t");
    await slider.focus();
    await page.keyboard.press("Home");
    await settled(page);
    expect(await slider.getAttribute("aria-valuetext")).toBe("0% of the way, at x 1.00, y 0.80");
  });

  test("the points can be moved by plain sliders, too", async () => {
    const page = await stay();
    await page.getByText("Move the points by numbers").click();
    await page.getByLabel("Control point 2, x").fill("4.25");
    expect((await stateOf(page)).control[1]).toEqual([4.25, 5.8]);
  });

  test("four coincident points are reported", async () => {
    const page = await open("#v=1&c=300,300,300,300,300,300,300,300");
    expect(await page.locator(".headline").textContent()).toContain("nothing to draw");
    expect(visit.errors).toEqual([]);
  });
});

describe("two curves", () => {
  test("C0, C1 and C2 are established, kept during a drag, and confirmed by the core", async () => {
    const page = await stay("#v=1&w=s");
    for (const [wish, level] of [["C1", 1], ["C2", 2], ["C0", 0]] as const) {
      await page.locator(`input[name=smoothness][value=${wish}]`).check();
      await settled(page);
      if (wish !== "C0") expect(await digits(page, "parametric")).toBe(level);
      await drag(page, 2, 25, -30);
      const state = await stateOf(page);
      const { join } = core.ask("seam", { first: state.seam.slice(0, 4) as never, second: state.seam.slice(4) as never, smoothness: "none", leader: "first", scale: 1 });
      // A joint at C0 may be smoother by chance, until the drag.
      expect(join.parametric).toBe(level);
      expect(await digits(page, "curvature-gap")).toBeCloseTo(join.curvature_gap!, 9);
    }
    expect(visit.errors).toEqual([]);
  });

  test("the second curve leads if its handle is dragged", async () => {
    const page = await stay("#v=1&w=s&k=1");
    const second = page.getByRole("slider", { name: "Second curve, control point 2", exact: true });
    const i = await page.locator("svg[data-figure] [role=slider]").evaluateAll((all) => all.findIndex((one) => one.getAttribute("aria-label") === "Second curve, control point 2"));
    await drag(page, i, 30, 20);
    const state = await stateOf(page);
    expect(state.seam[2]).not.toEqual(DEFAULTS.seam[2]);
    expect(await digits(page, "parametric")).toBe(1);
    await second.focus();
  });

  test("the joint moves its neighbours, too, by keys", async () => {
    const page = await stay("#v=1&w=s&k=2");
    await page.getByRole("slider", { name: "The joint" }).focus();
    await page.keyboard.press("ArrowUp");
    const state = await stateOf(page);
    expect(state.seam[3]).toEqual([5, 3.5]);
    expect(state.seam[4]).toEqual([5, 3.5]);
    expect(state.seam[2]).toEqual([3.9, 4.5]);
    expect(state.seam[5]).toEqual([6.1, 2.5]);
    expect(await digits(page, "parametric")).toBe(2);
  });

  test("curves that are not joined stay apart", async () => {
    const page = await stay("#v=1&w=s");
    await page.locator("input[name=smoothness][value=none]").check();
    await settled(page);
    await drag(page, 4, 40, 40);
    await settled(page);
    expect(await page.locator('[data-name="geometric"]').textContent()).toBe("apart");
    expect(await digits(page, "position-gap")).toBeGreaterThan(0.5);
  });
});

describe("address, language, surroundings", () => {
  test("a link restores the state from which it was made", async () => {
    const page = await open("#v=1&n=33&s=f&g=4&d=2&c=100,100,200,500,800,500,900,100&t=700");
    const state = read(new URL(page.url()).hash).state;
    expect([state.segments, state.spacing, state.goal, state.density, state.t]).toEqual([33, "fewest", 0.25, 2, 0.7]);
    await expectNumbers(page, state);
    expect(await page.locator(".slider output").first().textContent()).toBe("33");
    // Another link on the same page, as if pasted into the address bar.
    await page.evaluate(() => (location.hash = "#v=1&n=3"));
    await settled(page);
    expect(await page.locator(".slider output").first().textContent()).toBe("3");
    await expectNumbers(page, { ...DEFAULTS, segments: 3 });
  });

  test("a corrupt address gives the default page and a note that can be closed", async () => {
    const more = ["#v=7&n=3", "#v=1&c=1e999,0,0,0,0,0,0,0"];
    for (const hash of ["#v=1&n=9e99&c=NaN", "#%%%", "#v=1&k=__proto__&j=1,2", ...(isLong ? more : [])]) {
      const page = await open(hash);
      expect(await page.locator("[data-note='note.damaged']").count(), hash).toBe(1);
      await settled(page);
      await expectNumbers(page, DEFAULTS);
      await page.getByRole("button", { name: "Close this note" }).click();
      await settled(page);
      expect(await page.locator(".note").count()).toBe(0);
      expect(visit.errors, hash).toEqual([]);
    }
  });

  test("the language is switched at once, everywhere, and kept in the address", async () => {
    const page = await open();
    await page.getByRole("button", { name: "中文" }).click();
    await page.waitForSelector("html[lang=zh-CN]");
    await settled(page);
    expect(await page.title()).toBe("要分多少段，曲线看起来才光滑？");
    expect(await page.locator("h1").textContent()).toBe("要分多少段，曲线看起来才光滑？");
    expect(await page.locator(".headline").textContent()).toMatch(/^6 段，弦高误差/);
    // Everything except names, numbers and units must be Chinese.
    const english = await page.evaluate(() => {
      // Formula and code are the same in all languages.
      document.querySelectorAll("main :is(math, pre)").forEach((one) => one.remove());
      const all = document.querySelector("main")!.innerText;
      return { all, words: [...(all.match(/\b[a-z]{3,}\b/g) ?? [])] };
    });
    expect(english.all.length).toBeGreaterThan(200);
    expect(english.words).toEqual([]);
    expect((await stateOf(page)).language).toBe("zh");
    await open(new URL(page.url()).hash);
    expect(await visit.page.locator("html").getAttribute("lang")).toBe("zh-CN");
  });

  test("a reader whose browser speaks Chinese gets the Chinese page, and zh.html is always Chinese", async () => {
    let page = await open("", { locale: "zh-CN" });
    expect(await page.locator("html").getAttribute("lang")).toBe("zh-CN");
    page = await open("zh.html");
    expect(await page.locator("html").getAttribute("lang")).toBe("zh-CN");
  });

  test("embedded, the page is only the figure and its controls", async () => {
    const page = await open("?embed=1#v=1&n=9");
    expect(await page.locator("header, footer, .plot, .closing").count()).toBe(0);
    expect(await page.locator("svg[data-figure=curve]").count()).toBe(1);
    const other = await page.context().newPage();
    await other.setContent(`<iframe src="${site.base}?embed=1#v=1&n=9" width="400" height="700" title="figure"></iframe>`);
    const frame = other.frameLocator("iframe");
    await frame.locator("html[data-ready]").waitFor();
    expect(await frame.locator(".slider output").first().textContent()).toBe("9");
    await other.close();
  });

  test("at 360 pixels nothing overflows, in both views and languages", async () => {
    // In `make test` each view has one language.
    for (const address of ["", "#v=1&l=zh&w=s", "?embed=1", ...(isLong ? ["#v=1&w=s", "#v=1&l=zh"] : [])]) {
      const page = await open(address, { viewport: { width: 360, height: 740 } });
      await page.locator("details").evaluateAll((all) => all.forEach((one) => ((one as HTMLDetailsElement).open = true)));
      expect(await page.evaluate(() => document.documentElement.scrollWidth), address).toBeLessThanOrEqual(360);
    }
  });

  test("dark and light follow the system and the reader", async () => {
    const paper = (page: Page) => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const light = await paper(await open("", { colorScheme: "light" }));
    const page = await open("", { colorScheme: "dark" });
    const dark = await paper(page);
    expect(dark).not.toBe(light);
    await page.getByLabel("Colours").selectOption("light");
    await settled(page);
    expect(await paper(page)).toBe(light);
  });

  test("nothing moves by itself with prefers-reduced-motion", async () => {
    const page = await open("", { reducedMotion: "reduce" });
    const durations = await page.locator("*").evaluateAll((all) => all.map((one) => getComputedStyle(one).transitionDuration));
    expect(new Set(durations)).toEqual(new Set(["0s"]));
  });
});

describe("without script, and after failures", () => {
  test("without script there is the text and a figure, in both languages", async () => {
    for (const [file, words] of [["", "How many segments"], ["zh.html", "要分多少段"]] as const) {
      const { page } = await site.visit(file, { javaScriptEnabled: false });
      expect(await page.locator("h1").innerText()).toContain(words);
      expect(await page.locator("svg.drawing").count()).toBe(5);
      expect(await page.locator(".plot .dots").count()).toBe(2);
      const { even } = core.ask("study", { ...QUESTION_OF_STILL, control: DEFAULTS.control, segments: DEFAULTS.segments });
      expect(Number(await page.locator('[data-name="gap-pixels"]').getAttribute("value"))).toBe(even.gap!.pixels);
      expect(await page.locator(".closing").first().isVisible()).toBe(true);
      await page.context().close();
    }
  });

  test("a module that traps is replaced, with a note to the reader", async () => {
    let loads = 0;
    const prepare = (page: Page) =>
      page.route("**/*.wasm", async (route) => {
        loads += 1;
        // The first module traps at the first question; later ones work.
        await (loads === 1 ? route.fulfill({ body: Buffer.from(TRAPPING) }) : route.continue());
      });
    const page = await open("", { prepare });
    expect(loads).toBe(2);
    expect(await page.locator("[data-note='note.rebuilt']").count()).toBe(1);
    await expectNumbers(page, DEFAULTS);
    await drag(page, 2, 30, 30);
    await expectNumbers(page, await stateOf(page));
  });

  test("if the module never works, the still page stays, with a note", async () => {
    const prepare = (page: Page) => page.route("**/*.wasm", (route) => route.fulfill({ body: Buffer.from(TRAPPING) }));
    visit = await site.visit("", { prepare });
    await visit.page.waitForSelector(".note");
    await visit.page.waitForFunction(() => document.querySelector(".notes")!.textContent!.includes("does not run here"));
    expect(await visit.page.locator("h1").innerText()).toContain("How many segments");
  });
});

describe("accessibility and cost", () => {
  test("axe finds nothing, in both views, themes and languages, nor on the still page", async () => {
    for (const view of ["c", "s"]) {
      for (const theme of ["l", "d"]) {
        for (const language of ["en", "zh"]) {
          // In `make test` each view has one theme and one language.
          if (!isLong && new Set([view === "c", theme === "l", language === "en"]).size > 1) continue;
          const address = `#v=1&w=${view}&h=${theme}&l=${language}`;
          const page = await open(address);
          await page.locator("details").evaluateAll((all) => all.forEach((one) => ((one as HTMLDetailsElement).open = true)));
          expect(await axeFindings(page), address).toEqual([]);
        }
      }
    }
    const still = await site.visit("zh.html", { prepare: (page) => page.route("**/*.js", (route) => route.abort()) });
    expect(await axeFindings(still.page)).toEqual([]);
    await still.page.context().close();
  });

  // In `make test` only the taller window, in which more has to be drawn.
  const windows = [
    ["with the plot in sight as well", 1700],
    ["in a usual window", 900],
  ] as const;
  test.each(isLong ? windows : windows.slice(0, 1))("a move of a drag asks two questions and changes at most a hundred nodes, %s", async (_, height) => {
    const page = await open("", { viewport: { width: 1200, height }, prepare: countWork });
    let before = await workOf(page);
    await wave(page, handleOf(page, 1), async () => (before = await workOf(page)));
    const after = await workOf(page);
    const done = (what: keyof Work) => after[what] - before[what];
    const moves = done("moves");
    expect(moves).toBeGreaterThan(40);
    // The figure's question and the plot's.
    expect(done("questions")).toBeLessThanOrEqual(2 * moves);
    // If an answer is slow, a frame without it and one with it; then the plot.
    expect(done("frames")).toBeLessThanOrEqual(3 * moves);
    // Measured: 83 for each move.
    expect(done("mutations")).toBeLessThanOrEqual(100 * moves);
  });
});

/** The still page is drawn 720 pixels wide, at one device pixel per CSS pixel. */
const QUESTION_OF_STILL = { other: 1, pixels_per_unit: new Frame(720).scale, pixels: 1, t: 0, near: 1 };

/** A module with a memory and a `chordal_alloc` that traps. */
const TRAPPING = [
  0, 0x61, 0x73, 0x6d, 1, 0, 0, 0, 1, 6, 1, 0x60, 1, 0x7f, 1, 0x7f, 3, 2, 1, 0, 5, 3, 1, 0, 1, 7, 26, 2, 6,
  ...Buffer.from("memory"), 2, 0, 13, ...Buffer.from("chordal_alloc"), 0, 0, 10, 5, 1, 3, 0, 0, 0x0b,
];
