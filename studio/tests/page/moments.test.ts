// The widget's two points, judging by eye and halving the gap, and their surroundings: the first screen, the film, formula and
// code, Back, print, narrow frames, the reader's language before any script has run.
import { readFileSync } from "node:fs";
import { afterAll, beforeAll, describe, expect, test } from "vitest";
import type { Page } from "playwright-core";
import { Core } from "../../src/core/module";
import { read } from "../../src/state/fragment";
import { DEFAULTS, STOPS } from "../../src/state/state";
import { Frame } from "../../src/view/frame";
import { Site, WASM, digits, isLong, settled, type Opening, type Visit } from "./site";

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

/** By the end of its name: it may begin with what is written on it. */
const button = (page: Page, name: string) => page.getByRole("button", { name: new RegExp(`${name}$`) });
const stateOf = async (page: Page) => {
  await settled(page);
  return read(new URL(page.url()).hash).state;
};
/** The core's answer for the current figure, with another number of segments for comparison. */
async function study(page: Page, change: { segments: number; other: number }, { control = DEFAULTS.control, density = 1 } = {}) {
  const width = await page.evaluate(() => Math.round(document.querySelector(".stage .drawing")!.getBoundingClientRect().width));
  const { goal, t } = DEFAULTS;
  return core.ask("study", { control, ...change, pixels_per_unit: new Frame(width).scale * density, pixels: goal, t, near: 1 });
}

describe("judging by eye", () => {
  test("what the screen draws is the chain alone, one thick stroke without dots, and flips to the true curve", async () => {
    const page = await open();
    const chain = await page.locator(".stage path.chain").getAttribute("d");
    const curve = await page.locator(".stage path.curve").getAttribute("d");
    await page.locator("input[name=look][value=chain]").check();
    await settled(page);
    const drawn = await page.locator(".stage .drawing path").evaluateAll((all) => all.map((one) => one.getAttribute("class")));
    expect(drawn).toEqual(["stroke"]);
    const stroke = page.locator(".stage path.stroke");
    expect(await stroke.getAttribute("d")).toBe(chain);
    const look = () => stroke.evaluate((one) => [getComputedStyle(one).strokeWidth, getComputedStyle(one).stroke]);
    const asChain = await look();
    expect(parseFloat(asChain[0]!)).toBeGreaterThanOrEqual(5);
    await button(page, "Flip between what the screen draws and the true curve").click();
    await settled(page);
    expect(await stroke.getAttribute("d")).toBe(curve);
    // Only the shape of the stroke may differ.
    expect(await look()).toEqual(asChain);
    expect(read(new URL(page.url()).hash).state.look).toBe("curve");
    await button(page, "Flip between what the screen draws and the true curve").click();
    await settled(page);
    expect(await stroke.getAttribute("d")).toBe(chain);
    expect(visit.errors).toEqual([]);
  });

  test("points can be moved by keys while the strokes are compared, and are visible then", async () => {
    const page = await stay("#v=1&e=s");
    const handle = page.locator("svg[data-figure] [role=slider]").nth(1);
    const faint = Number(await handle.evaluate((one) => getComputedStyle(one).opacity));
    await handle.focus();
    await page.keyboard.press("ArrowRight");
    await settled(page);
    expect((await stateOf(page)).control[1]).toEqual([2.3, 5.8]);
    expect(faint).toBeLessThan(0.3);
    expect(Number(await handle.evaluate((one) => getComputedStyle(one).opacity))).toBe(1);
  });

  test("the switch works by keys, and is announced", async () => {
    const page = await stay();
    await page.locator("input[name=look][value=both]").focus();
    await page.keyboard.press("ArrowRight");
    await settled(page);
    expect((await stateOf(page)).look).toBe("chain");
    expect(await page.locator("svg[data-figure]").getAttribute("aria-label")).toContain("one thick stroke");
  });
});

describe("halving", () => {
  test("2× reports its effect with the core's numbers, and the old chain stays as a ghost", async () => {
    const page = await stay();
    const before = await page.locator(".stage path.chain").getAttribute("d");
    expect(await page.locator(".halving").innerText()).toContain("from 6 to 12 segments");
    await button(page, "Twice as many segments").click();
    await settled(page);
    const { even, other } = await study(page, { segments: 12, other: 6 });
    expect(await digits(page, "gap-before")).toBe(other.even.gap!.pixels);
    expect(await digits(page, "gap-pixels")).toBe(even.gap!.pixels);
    expect(await digits(page, "times")).toBe(other.times.even);
    const three = (x: number) => Number(x.toPrecision(3)).toString();
    const words = `6 → 12: ${three(other.even.gap!.pixels)} → ${three(even.gap!.pixels)} px, 4.0 times less`;
    expect((await page.locator(".halving").innerText()).replace(/\s+/g, " ")).toBe(words);
    expect(await page.locator(".stage path.ghost").getAttribute("d")).toBe(before);
    const line = (await page.locator(".halving").boundingBox())!;
    const twice = (await button(page, "Twice as many segments").boundingBox())!;
    expect(line.y - (twice.y + twice.height)).toBeLessThan(20);
  });

  test("moving a point keeps the comparison, another number ends it", async () => {
    const page = await stay("#v=1&n=12&b=6");
    await page.locator("svg[data-figure] [role=slider]").nth(2).focus();
    await page.keyboard.press("ArrowDown");
    await settled(page);
    expect(await page.locator(".stage path.ghost").count()).toBe(1);
    expect(await digits(page, "times")).toBeGreaterThan(3.5);
    await button(page, "One segment more").click();
    await settled(page);
    expect(await page.locator(".stage path.ghost").count()).toBe(0);
    expect((await stateOf(page)).before).toBe(null);
  });

  test("half as many segments are reported as so many times the gap", async () => {
    const page = await stay("#v=1&n=12");
    await button(page, "Half as many segments").click();
    await settled(page);
    expect((await page.locator(".halving").innerText()).replace(/\s+/g, " ")).toMatch(/^12 → 6: .* 4\.0 times more$/);
  });

  test("the plot has the slope triangle, with the core's factor, and labels its goals", async () => {
    const page = await stay("#v=1&n=12&b=6");
    await page.locator("svg.plot").scrollIntoViewIfNeeded();
    await settled(page);
    expect(await page.locator(".plot .doubling text").allTextContents()).toEqual(["×2", "÷4.0"]);
    const path = async (what: string) => (await page.locator(what).getAttribute("d"))!;
    const [x0, y0, x1, y1] = (await path(".plot .doubling path")).match(/[\d.]+/g)!;
    const dots = (await path(".plot .even .dots")).match(/M[\d.]+ [\d.]+/g)!.map((dot) => dot.slice(1));
    // The triangle's corners are the dots of 6 and of 12 segments.
    expect(dots).toContain(`${x0} ${y0}`);
    expect(dots).toContain(`${x1} ${y1}`);
    expect(await page.locator(".plot .goal text").allTextContents()).toEqual(["1 px", "½ px", "¼ px"]);
    expect(await page.locator(".plot .goal.chosen text").textContent()).toBe("½ px");
  });
});

describe("the first screen", () => {
  // In `make test` each in one language.
  const [en, zh] = ["", "#v=1&l=zh"];
  test.each([
    [1366, 768, en, zh],
    [1366, 650, zh, en],
    [390, 844, en, zh],
    [414, 896, zh, en],
    [360, 640, zh, en],
  ])("title, figure and the slider are in view at %i × %i, in both languages", async (width, height, ...addresses) => {
    for (const address of isLong ? addresses : addresses.slice(0, 1)) {
      const page = await open(address, { viewport: { width, height }, hasTouch: width < 500 });
      for (const what of ["h1", ".stage .drawing", "#segments"]) {
        const box = (await page.locator(what).boundingBox())!;
        expect(box.y, `${what} ${address}`).toBeGreaterThanOrEqual(0);
        expect(box.y + box.height, `${what} ${address}`).toBeLessThanOrEqual(height);
      }
      if (width > 1000) {
        // And its effect on the gap.
        for (const what of [".halving", ".flip"]) {
          const box = (await page.locator(what).boundingBox())!;
          expect(box.y + box.height, `${what} ${address}`).toBeLessThanOrEqual(height);
        }
      }
    }
  });

  test("formula and code are next to the figure, with the core's numbers", async () => {
    const page = await stay();
    const { formula, needed } = await study(page, { segments: 6, other: 12 });
    expect(await digits(page, "formula-segments")).toBe(formula.segments);
    expect(await page.locator(".recipe").innerText()).toContain(`proved chord by chord, ${needed.even} are enough`);
    const [stage, recipe] = await Promise.all([page.locator(".stage").boundingBox(), page.locator(".recipe").boundingBox()]);
    expect(recipe!.y - (stage!.y + stage!.height)).toBeLessThan(40);
    expect(await page.locator("math").count()).toBe(1);
    expect((await page.locator(".recipe code").innerText()).split("\n").length).toBe(6);
  });

  test("the first proved number is labelled so, and a larger one that fails is named with its gap", async () => {
    // A hairpin, on screens of three densities.
    const hairpin = "c=840,560,20,300,260,350,650,430";
    const control = read(`v=1&${hairpin}`).state.control;
    let failing = 0;
    for (const density of [1, 2, 3]) {
      const page = await stay(`#v=1&d=${density}&${hairpin}`);
      expect(await page.locator(".needed h3").innerText()).toBe("First number proved for ½ px");
      const { needed } = await study(page, { segments: 6, other: 12 }, { control, density });
      expect(await digits(page, "needed-even")).toBe(needed.even);
      const { even_fails, even_from } = needed;
      expect(await page.locator(".exception").count()).toBe(even_fails ? 1 : 0);
      if (even_fails && even_fails.pixels! > 0.5) {
        failing += 1;
        expect(await digits(page, "even-fails-pixels")).toBe(even_fails.pixels);
        expect(await page.locator(".exception").innerText()).toContain(`with ${even_fails.segments} the gap is`);
        expect(await page.locator(".exception").innerText()).toContain(`From ${even_from} on every number`);
        await page.getByLabel("Segments", { exact: true }).focus();
        await page.evaluate((n) => (location.hash += `&n=${n}`), even_fails.segments);
        await settled(page);
        expect(await page.locator(".headline").innerText()).toContain("That shows");
      }
    }
    expect(failing).toBeGreaterThan(0);
  });

  test("headline and number have the colour of the verdict", async () => {
    for (const [address, found] of [["#v=1&n=6", "seen"], ["#v=1&n=64", "smooth"]] as const) {
      const page = await stay(address);
      const colour = (what: string) => page.locator(what).evaluate((one) => getComputedStyle(one).color);
      expect(await page.locator(".headline").getAttribute("class")).toContain(found);
      expect(await colour(".readout .big")).toBe(await colour(".headline"));
    }
  });
});

describe("the film", () => {
  test("it plays from stop to stop to the last, after one press, and is one step of the history", async () => {
    const page = await open("#v=1&n=80", { isFirst: true });
    const shown = page.evaluate(
      () =>
        new Promise<number[]>((done) => {
          const all: number[] = [];
          const output = document.querySelector("output[for=segments]")!;
          new MutationObserver(() => {
            all.push(Number(output.textContent));
            if (all.at(-1) === 128) done(all);
          }).observe(output, { characterData: true, subtree: true, childList: true });
        }),
    );
    const length = await page.evaluate(() => history.length);
    await page.getByRole("button", { name: /^Play/ }).click();
    // On a machine that draws slowly, two of them may share a frame.
    const [stops, drawn] = [STOPS.filter((n) => n > 80), await shown];
    expect(drawn).toEqual(stops.filter((n) => drawn.includes(n)));
    expect(2 * drawn.length).toBeGreaterThan(stops.length);
    await settled(page);
    expect(await page.getByRole("button", { name: /^Play/ }).getAttribute("aria-pressed")).toBe("false");
    expect(await page.evaluate(() => history.length)).toBe(length + 1);
    expect((await stateOf(page)).segments).toBe(128);
  });

  test("a touch of the slider ends it", async () => {
    const page = await open("#v=1&n=2");
    await page.getByRole("button", { name: /^Play/ }).click();
    await page.waitForFunction(() => document.querySelector("output[for=segments]")!.textContent === "4");
    await page.getByLabel("Segments", { exact: true }).fill("30");
    await settled(page);
    expect((await stateOf(page)).segments).toBe(STOPS[30]);
    expect(await page.getByRole("button", { name: /^Play/ }).count()).toBe(1);
  });
});

test("a straight curve that turns back beyond its chain has a measured gap", async () => {
  const page = await stay("#v=1&n=5&c=500,300,900,300,100,300,500,300");
  const x = (t: number) => 5 * (1 - t) ** 3 + 27 * t * (1 - t) ** 2 + 3 * t * t * (1 - t) + 5 * t ** 3;
  expect(await digits(page, "gap-units")).toBeCloseTo(x((3 - Math.sqrt(3)) / 6) - x(0.2), 12);
  expect(await digits(page, "gap-pixels")).toBeGreaterThan(0.1);
});

describe("Back", () => {
  test("it undoes all steps before it leaves the page", async () => {
    const page = await open("", { isFirst: true });
    await button(page, "One segment more").click();
    await settled(page);
    await page.locator("input[name=spacing][value=fewest]").check();
    await settled(page);
    await button(page, "Two curves joined").click();
    await settled(page);
    expect(await page.locator("svg[data-figure=seam]").count()).toBe(1);
    await page.goBack();
    await settled(page);
    expect(await page.locator("svg[data-figure=curve]").count()).toBe(1);
    expect(await stateOf(page)).toMatchObject({ view: "curve", spacing: "fewest", segments: 7 });
    await page.goBack();
    await settled(page);
    expect(await stateOf(page)).toMatchObject({ spacing: "even", segments: 7 });
    await page.goBack();
    await settled(page);
    expect(await stateOf(page)).toEqual(DEFAULTS);
    await page.goForward();
    await settled(page);
    expect(await stateOf(page)).toMatchObject({ segments: 7 });
    expect(await page.locator("output[for=segments]").textContent()).toBe("7");
  });

  test("a drag is one step", async () => {
    const page = await open("", { isFirst: true });
    const length = await page.evaluate(() => history.length);
    const box = (await page.locator("svg[data-figure] [role=slider]").nth(1).locator(".dot").boundingBox())!;
    await page.mouse.move(box.x + 5, box.y + 5);
    await page.mouse.down();
    for (let i = 1; i <= 12; i++) {
      const before = page.url();
      await page.mouse.move(box.x + 5 + 5 * i, box.y + 5 + 3 * i);
      // Waits until the address is written.
      if (i % 6 === 0) await page.waitForFunction((before) => location.href !== before, before);
    }
    await page.mouse.up();
    await settled(page);
    expect(await page.evaluate(() => history.length)).toBe(length + 1);
    await page.goBack();
    expect((await stateOf(page)).control).toEqual(DEFAULTS.control);
  });
});

describe("languages", () => {
  test("a reader of Chinese never sees an English page", async () => {
    // The modules are blocked, so that only earlier scripts can redirect.
    const prepare = (page: Page) => page.route("**/assets/*.js", (route) => route.abort());
    const readers = new Map<string, Page>();
    const met = async (address: string, locale: string) => {
      const known = readers.get(locale);
      const page = known ?? (await site.visit(address, { locale, prepare })).page;
      readers.set(locale, page);
      // Leave the page first: the address may differ only in its fragment.
      await known?.goto("about:blank");
      await known?.goto(site.base + address);
      const heading = await page.locator("h1").innerText();
      const end = new URL(page.url());
      return [heading.includes("段") ? "zh" : "en", end.search + end.hash];
    };
    expect(await met("", "zh-CN")).toEqual(["zh", ""]);
    expect(await met("?embed=1#v=1&n=9", "zh-TW")).toEqual(["zh", "?embed=1#v=1&n=9"]);
    expect(await met("#v=1&l=en", "zh-CN")).toEqual(["en", "#v=1&l=en"]);
    expect(await met("zh.html#v=1&l=en", "zh-CN")).toEqual(["en", "#v=1&l=en"]);
    expect(await met("#v=1&l=zh", "en-GB")).toEqual(["zh", "#v=1&l=zh"]);
    expect(await met("zh.html", "en-GB")).toEqual(["zh", ""]);
    expect(await met("", "fr-FR")).toEqual(["en", ""]);
    await Promise.all([...readers.values()].map((page) => page.context().close()));
  });

  test("each view has its own title and ending, in both languages", async () => {
    const said = new Set<string>();
    for (const address of ["#v=1", "#v=1&w=s", "#v=1&l=zh", "#v=1&l=zh&w=s"]) {
      const page = await stay(address);
      const heading = await page.locator("h1").innerText();
      expect(await page.title()).toBe(heading);
      said.add(heading);
      said.add(await page.locator(".closing").innerText());
    }
    expect(said.size).toBe(8);
  });
});

test("curvatures at the joint have signs, and are the core's", async () => {
  const page = await stay("#v=1&w=s");
  const { seam } = DEFAULTS;
  const curves = { first: seam.slice(0, 4) as never, second: seam.slice(4) as never };
  const { join } = core.ask("seam", { ...curves, smoothness: "C0", leader: "first", scale: 1 });
  expect(join.curvatures[0]! * join.curvatures[1]!).toBeLessThan(0);
  expect(await digits(page, "curvature-before")).toBe(join.curvatures[0]);
  expect(await digits(page, "curvature-after")).toBe(join.curvatures[1]);
  expect(await page.locator('[data-name="curvature-before"]').innerText()).toMatch(/^−/);
  expect(await page.locator('[data-name="curvature-after"]').innerText()).toMatch(/^\+/);
});

test("figures have no negative size in a frame of any width", async () => {
  const page = await site.browser.newPage();
  const errors: string[] = [];
  page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  for (const width of isLong ? [20, 60, 90, 120, 200, 300] : [20, 90, 300]) {
    await page.setContent(`<iframe src="${site.base}#v=1" width="${width}" height="400" title="narrow"></iframe>`);
    const frame = page.frameLocator("iframe");
    await frame.locator("html[data-ready]").waitFor({ state: "attached" });
    await frame.locator("html[data-settled]").waitFor({ state: "attached" });
    const sizes = await frame.locator("svg, rect, circle").evaluateAll((all) =>
      all.flatMap((one) => ["width", "height", "r"].flatMap((name) => one.getAttribute(name) ?? [])),
    );
    expect(sizes.length, `${width}`).toBeGreaterThan(10);
    expect(sizes.filter((size) => !(parseFloat(size) >= 0)), `${width}`).toEqual([]);
  }
  expect(errors).toEqual([]);
  await page.close();
});

describe("on paper", () => {
  test("everything is printed: no part is left out, split or blank, and there are no controls", async () => {
    for (const address of ["#v=1", "#v=1&h=d", "#v=1&w=s"]) {
      const page = await stay(address, { viewport: { width: 900, height: 700 } });
      await page.emulateMedia({ media: "print" });
      const parts = await page.locator("main section, main .stage").evaluateAll((all) =>
        all.map((one) => [getComputedStyle(one).contentVisibility, one.getBoundingClientRect().height > 150]),
      );
      expect(parts.length, address).toBeGreaterThanOrEqual(1);
      for (const part of parts) expect(part, address).toEqual(["visible", true]);
      const whole = page.locator("main svg, pre, table, .readout");
      expect(await whole.count(), address).toBeGreaterThanOrEqual(2);
      const cut = await whole.evaluateAll((all) =>
        all
          .filter((one) => getComputedStyle(one).breakInside !== "avoid" && !one.closest("figure"))
          .map((one) => one.outerHTML.slice(0, 60)),
      );
      expect(cut, address).toEqual([]);
      const pressed = await page
        .locator("button:not(.needed button), input[type=range], select, nav")
        .evaluateAll((all) => all.filter((one) => one.checkVisibility()).length);
      expect(pressed, address).toBe(0);
      // In print it is ink on white, with any theme.
      expect(await page.evaluate(() => getComputedStyle(document.body).backgroundColor)).toBe("rgb(255, 255, 255)");
    }
  });
});
