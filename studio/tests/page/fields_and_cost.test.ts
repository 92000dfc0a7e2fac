// The exhibits of fields and of cost: their numbers are the core's and change as their claims say.
import { afterAll, afterEach, beforeAll, expect, test } from "vitest";
import type { Vec3 } from "../../src/viewer/layers";
import { type View, dot, towardsEye } from "../../src/viewer/view";
import { ExhibitPages, grip, live } from "./exhibit_page";
import { digits, isLong, axeFindings, settled } from "./site";

let pages: ExhibitPages;
beforeAll(async () => {
  pages = await ExhibitPages.open();
});
afterEach(() => expect(pages.errors).toEqual([]));
afterAll(() => pages.close());

test("field: the sign is the side, field and mesh agree on it, and differ by no more than the proved bound", async () => {
  const page = await pages.at("field.html");
  const places = [["6,4", "outside"], ["9.3,4.8", "inside"], ["1,1", "outside"], ["10.2,6.2", "outside"]] as const;
  for (const [place, is] of isLong ? places : places.slice(0, 2)) {
    for (const [asked, stop] of [["field", "0"], ["mesh", "0"], ["mesh", "4"]]) {
      await page.evaluate((hash) => (location.hash = hash), `#v=1&p=${place}&a=${asked}&n=${stop}`);
      const value = await pages.number("field");
      expect(value < 0, `${place} ${asked}`).toBe(is === "inside");
      expect(await page.locator(".live .meaning").textContent()).toContain(is);
      expect(await digits(page, "apart")).toBeLessThanOrEqual(await digits(page, "bound"));
    }
  }
  const edges = await digits(page, "edges");
  await page.locator("#length").fill("6");
  await settled(page);
  expect(await digits(page, "edges")).toBeGreaterThan(edges);
});

test("field: keys move the point into the hole, where the sign flips", async () => {
  const page = await pages.on("field.html", "#v=1&p=6,1.9");
  expect(await pages.number("field")).toBeLessThan(0);
  await grip(page).focus();
  for (let i = 0; i < 14; i++) await page.keyboard.press("ArrowUp");
  expect(await pages.number("field")).toBeGreaterThan(0);
  expect(await grip(page).getAttribute("aria-valuetext")).toContain("outside");
});

test("csg: the value is the distance outside a union and less inside where the parts overlap; it is never larger", async () => {
  const page = await pages.at("csg.html");
  expect(await pages.number("csg")).toBeLessThan(0.9);
  for (const [operation, place, isLess] of [
    ["union", "1,7", false],
    ["union", "6.1,4.3", true],
    ["intersection", "6.1,4.3", false],
    ["intersection", "8.6,7.2", true],
    ["difference", "2.5,4", false],
    ["difference", "9.5,2", true],
  ] as const) {
    await page.evaluate((hash) => (location.hash = hash), `#v=1&p=${place}&b=${operation}`);
    const share = await pages.number("csg");
    expect(share, `${operation} ${place}`).toBeLessThan(1.001);
    expect(share < 0.98, `${operation} ${place}`).toBe(isLess);
  }
});

test("tracing: a direct ray takes few steps, a grazing one many", async () => {
  const page = await pages.at("tracing.html#v=1&p=6.1,6");
  const direct = await pages.number("tracing");
  await page.evaluate(() => (location.hash = "#v=1&p=7.4,2.97"));
  expect(await pages.number("tracing")).toBeGreaterThan(3 * direct);
  const gone: number[] = [];
  for (const n of ["1", "3", "10", "30"]) {
    await page.locator("#steps").fill(n);
    await settled(page);
    gone.push(await digits(page, "gone"));
    expect(await page.locator(".step").count()).toBe(Number(n));
  }
  expect(gone).toEqual([...gone].sort((a, b) => a - b));
  expect(gone[0]).toBe(0);
  // The scene in space is drawn when the reader comes there, and stays while a ray is dragged.
  await page.locator(".in-space").scrollIntoViewIfNeeded();
  await page.waitForSelector('.in-space .scene[data-viewer="webgl"]');
});

test("squares: twice as fine a lattice still cuts corners off, and the mesher that knows the parts does not", async () => {
  const page = await pages.at("squares.html#v=1&n=12");
  const coarse = await pages.number("squares");
  expect(await digits(page, "ambiguous")).toBeGreaterThan(0);
  await page.locator("#cells").fill("48");
  const fine = await pages.number("squares");
  // Four times as many cells: a smooth outline would have a sixteenth of the error.
  expect(fine).toBeGreaterThan(coarse / 8);
  await page.locator("input[name=method][value=corners]").check();
  expect(await pages.number("squares")).toBeLessThan(fine / 4);
  expect(await digits(page, "segments")).toBeLessThan(60);
});

test("squares: one cube has corners that keys and presses switch, and the address restores it", async () => {
  const page = await pages.on("squares.html", "#v=1");
  await page.locator("input[name=look][value=cube]").check();
  await live(page);
  // Two opposite corners of a face: two triangles, two pieces, and one ambiguous face.
  expect(await pages.number("squares")).toBe(1);
  const facts = async () => Promise.all(["triangles", "pieces", "readings"].map((name) => digits(page, name)));
  expect(await facts()).toEqual([2, 2, 2]);
  const patterns = await digits(page, "patterns");
  const alternates = (signs: number) =>
    [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]].filter((face) => {
      const [a, b, c, d] = face.map((corner) => (signs >> corner) & 1);
      return a === c && b === d && a !== b;
    }).length;
  const all = Array.from({ length: 256 }, (_, signs) => alternates(signs));
  expect(patterns).toBe(all.filter((n) => n > 0).length);
  const corner = (n: number) => page.getByRole("button", { name: `Corner ${n}`, exact: true });
  let signs = 9;
  for (const n of isLong ? [2, 8, 5, 1, 7] : [2, 5]) {
    await corner(n).focus();
    await page.keyboard.press(n % 2 ? "Enter" : "Space");
    signs ^= 1 << (n - 1);
    expect(await pages.number("squares"), `${signs}`).toBe(alternates(signs));
    expect(await corner(n).getAttribute("aria-pressed")).toBe(String(((signs >> (n - 1)) & 1) === 1));
    expect(await digits(page, "readings")).toBe(2 ** alternates(signs));
    expect((await pages.state("squares"))["signs"]).toBe(signs);
  }
  await page.getByRole("button", { name: "every other corner" }).click();
  expect(await pages.number("squares")).toBe(6);
  expect(await facts()).toEqual([4, 4, 64]);
  // A press on the corner in the figure.
  const box = (await page.locator(".corner.inside circle").first().boundingBox())!;
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await settled(page);
  expect((await pages.state("squares"))["signs"]).toBe(104);
  await page.locator(".scene").focus();
  await page.keyboard.press("ArrowLeft");
  const { view } = await pages.state("squares");
  expect(view).not.toEqual((pages.exhibits.get("squares")!.defaults as { view: unknown }).view);
});

test("squares: the address opens one cube with the corner of a box, which marching cubes cuts off", async () => {
  const page = await pages.at("squares.zh.html#v=1&k=cube&g=1&t=1");
  await live(page);
  expect(await pages.number("squares")).toBe(0);
  // From the middle of the cell to the plane through the middles of three edges.
  expect(Math.abs((await digits(page, "lost")) - Math.sqrt(1 / 3))).toBeLessThan(0.01);
  expect(await page.locator(".live .meaning").textContent()).toContain("0.58");
  expect(await axeFindings(page)).toEqual([]);
  await page.locator("input[name=look][value=lattice]").check();
  expect(await pages.number("squares")).toBeGreaterThan(0);
  expect(await page.locator("svg.flat .lattice").count()).toBe(1);
});

test("baking: the two bounds add up, the measured error is within, and smaller cells have smaller errors", async () => {
  const page = await pages.at("baking.html#v=1&n=8");
  let before = Infinity;
  for (const cells of isLong ? ["8", "16", "28"] : ["8", "16"]) {
    await page.locator("#cells").fill(cells);
    const bound = await pages.number("baking");
    expect(bound).toBeLessThan(before);
    expect(bound).toBeCloseTo((await digits(page, "there")) + (await digits(page, "home")), 9);
    expect(await digits(page, "measured")).toBeLessThan(bound);
    before = bound;
  }
});

test("baking: a button turns the view to the worst place", async () => {
  const page = await pages.at("baking.html#v=1&n=8&o=0,-80,6.2,0,0,0");
  await page.getByRole("button", { name: "Turn to the worst place" }).click();
  const { view } = (await pages.state("baking")) as { view: View };
  const { worst } = pages.core.ask("exhibit", { exhibit: "baking", shape: "cylinder", cells: 8 }) as { worst: [Vec3, Vec3] };
  expect(dot(towardsEye(view), worst[0])).toBeGreaterThan(0.9 * Math.hypot(...worst[0]));
});

test("levels: a model in its true size is the level or the original, or their difference, and no outline is far off", async () => {
  const page = await pages.at("levels.html#v=1&k=teapot&n=4");
  const image = page.locator(".same img");
  const box = (await image.boundingBox())!;
  expect([box.width, box.height]).toEqual([320, 192]);
  const coarse = await image.getAttribute("src");
  await page.getByRole("button", { name: "⇄" }).click();
  await settled(page);
  expect(await image.getAttribute("src")).not.toBe(coarse);
  expect(await page.locator(".same figcaption").textContent()).toMatch(/^5,064 triangles$/);
  await page.getByRole("button", { name: "the difference" }).click();
  await settled(page);
  expect(await page.locator(".same figcaption").textContent()).toContain("difference");
  // Of an outline as long as some hundred pixels.
  expect(await digits(page, "outline")).toBeLessThan(200);
  await page.locator("#distance").fill("0");
  await settled(page);
  expect(await digits(page, "differ")).toBe(0);
});

test("levels: farther away fewer triangles are within a pixel, and the mountain keeps its triangles until it is far", async () => {
  const page = await pages.at("levels.html");
  expect(await pages.costly("levels")).toBe(pages.written("levels.html"));
  const counts: number[] = [];
  for (const stop of ["0", "4", "8", "18"]) {
    await page.locator("#distance").fill(stop);
    counts.push(await pages.costly("levels"));
    for (const name of ["teapot", "mountain"]) expect(await digits(page, `${name}-pixels`)).toBeLessThanOrEqual(1);
  }
  // At ten times the distance the teapot has lost nearly all of its triangles and the mountain none; at 19 km it has, too.
  expect(counts[0]! - counts[1]!).toBeGreaterThan(0.5 * counts[0]!);
  expect(counts[2]).toBeGreaterThan(0.8 * counts[1]!);
  expect(counts[3]).toBeLessThan(0.5 * counts[2]!);
  expect(await digits(page, "off-axis")).toBeGreaterThan(1.5);
});

test("overshade: large triangles shade a pixel little more than once, those below a pixel four times", async () => {
  const page = await pages.at("overshade.html#v=1&n=0");
  expect(await pages.number("overshade")).toBeLessThan(1.5);
  await page.locator("#side").focus();
  await page.keyboard.press("End");
  expect(await pages.number("overshade")).toBe(4);
  expect(await digits(page, "lanes")).toBe(4 * (await digits(page, "covered")));
  expect(await digits(page, "missed")).toBeGreaterThan(0.9 * (await digits(page, "triangles")));
  expect(await digits(page, "seen")).toBe(0);
  const image = page.locator(".same img");
  expect(await image.count()).toBe(1);
  await page.locator("#side").fill("0");
  await settled(page);
  expect(await digits(page, "seen")).toBeGreaterThan(1000);
  const coarse = await image.getAttribute("src");
  await page.getByRole("button", { name: "⇄" }).click();
  await settled(page);
  expect(await image.getAttribute("src")).not.toBe(coarse);
});

test("budget: half the error takes √2 times the segments and about twice the triangles", async () => {
  const page = await pages.at("budget.html");
  expect(await pages.costly("budget")).toBe(pages.written("budget.html"));
  await page.evaluate(() => (location.hash = "#v=1&s=curve&n=4"));
  const curve = await pages.costly("budget");
  expect(curve).toBeGreaterThan(-0.6);
  expect(curve).toBeLessThan(-0.4);
  for (const shape of ["patch", "cage", "nurbs", "field"]) {
    await page.locator(`input[name=shape][value=${shape}]`).check();
    const slope = await pages.costly("budget");
    expect(slope, shape).toBeGreaterThan(-1.15);
    expect(slope, shape).toBeLessThan(-0.8);
    expect(await digits(page, "times")).toBeGreaterThan(1.6);
  }
});

test("budget: samples give the triangles of their cells for any budget, a mesh the fewest; both end at the error of their source", async () => {
  const page = await pages.on("budget.html", "#v=1&s=volume&n=0");
  expect(await pages.costly("budget")).toBe(0);
  const cells = await digits(page, "count");
  for (const shape of ["volume", "mesh"]) {
    await page.locator(`input[name=shape][value=${shape}]`).check();
    await settled(page);
    const off = await digits(page, "source");
    for (const step of [0, 2, 3, 4]) {
      await page.locator("#step").fill(String(step));
      await pages.costly("budget");
      const length = 0.125 / 2 ** step;
      const shown = (await page.locator('[data-name="count"]').getAttribute("value")) ?? "";
      expect(shown !== "", `${shape} ${length}`).toBe(length > off);
      expect(await page.locator(".live.bad").count()).toBe(length > off ? 0 : 1);
      if (shape === "volume" && shown) expect(Number(shown)).toBe(cells);
      if (shown) expect(await digits(page, "bound")).toBeLessThanOrEqual(length);
    }
  }
  await page.locator("#step").fill("0");
  await settled(page);
  const fewest = await digits(page, "count");
  for (const shape of ["patch", "cage", "nurbs", "field"]) {
    await page.locator(`input[name=shape][value=${shape}]`).check();
    await settled(page);
    expect(await digits(page, "count"), shape).toBeGreaterThan(fewest);
  }
});

test("budget: no label of the chart is cut off or overlaps another, wide and narrow, in both languages", async () => {
  // In `make test`, wide in one language and narrow in the other.
  const looks = [[1200, "curve"], [360, "mesh"]] as const;
  for (const [k, file] of ["budget.html", "budget.zh.html"].entries()) {
    const page = await pages.on(file, "#v=1&s=curve&n=4");
    for (const [width, shape] of isLong ? looks : [looks[k]!]) {
      await page.setViewportSize({ width, height: 740 });
      await page.locator(`input[name=shape][value=${shape}]`).check();
      await settled(page);
      const found = await page.evaluate(() => {
        const svg = document.querySelector<SVGSVGElement>("svg.chart.flat")!;
        const frame = svg.getBoundingClientRect();
        const words = [...svg.querySelectorAll("text")].filter((one) => one.checkVisibility());
        const isOut = (box: DOMRect) =>
          box.left < frame.left || box.right > frame.right || box.top < frame.top || box.bottom > frame.bottom;
        const names = words.filter((one) => one.classList.contains("name")).map((one) => one.getBoundingClientRect());
        // A line of text is a quarter higher than its letters.
        const lie = names.filter((box, i) => names.some((other, k) => k < i && Math.abs(other.top - box.top) < 0.75 * box.height));
        // The lengths are side by side.
        const lengths = words.filter((one) => /^0\.\d+$/.test(one.textContent!)).map((one) => one.getBoundingClientRect());
        const touch = lengths.filter((box, i) => i > 0 && box.left < lengths[i - 1]!.right + 2);
        const wrong = [...words.filter((one) => isOut(one.getBoundingClientRect())).map((one) => one.textContent), ...lie, ...touch];
        return { wrong, looked: [names.length, lengths.length] };
      });
      expect(Math.min(...found.looked), `${file} ${width} ${shape}: names and lengths`).toBeGreaterThanOrEqual(2);
      expect(found.wrong, `${file} ${width} ${shape}`).toEqual([]);
    }
  }
});

test("questions: a card turns only after a choice or a written answer, and has the initial number of its exhibit", async () => {
  const page = await pages.at("questions.html");
  expect(await pages.number("questions")).toBe(0);
  const seen = new Map<string, [value: number, shown: string, label: string]>();
  const questions = ["triangles", "normals", "winding", "joins", "fields", "cost"];
  expect(await page.locator("[data-question]").count()).toBe(questions.length);
  for (const [k, question] of questions.entries()) {
    const card = page.locator(`[data-question=${question}]`);
    const turn = card.getByRole("button");
    expect(await turn.isDisabled()).toBe(true);
    expect(await card.locator("data").count(), "the number is not in the page before").toBe(0);
    if (k % 2) await card.getByRole("textbox").fill("my own words");
    else await card.getByRole("radio").first().check();
    await turn.click();
    await settled(page);
    expect(await pages.number("questions")).toBe(k + 1);
    expect(await card.textContent()).toMatch(k % 2 ? /You wrote: my own words/ : /As you said|You chose/);
    const links = card.locator(".seen a");
    for (const link of await links.all()) {
      const file = (await link.getAttribute("href"))!;
      expect((await page.request.get(new URL(file, page.url()).href)).ok(), file).toBe(true);
    }
    const [shown, label] = await Promise.all([card.locator("data").textContent(), card.locator(".number-of span").textContent()]);
    seen.set((await links.first().getAttribute("href"))!, [await digits(page, `card-${question}`), shown!, label!]);
  }
  // Every second one in `make test`.
  for (const [file, [value, shown, label]] of [...seen].filter((_, k) => isLong || k % 2 === 0)) {
    const there = await pages.at(file);
    expect(await digits(there, "live"), file).toBe(value);
    expect(await there.locator(".live h2").textContent()).toBe(label);
    expect(await there.locator(".live data").textContent()).toBe(shown);
  }
});

test("questions: without script every answer is there, in a fold", async () => {
  for (const file of ["questions.html", "questions.zh.html"]) {
    const { page } = await pages.site.visit(file, { javaScriptEnabled: false });
    const cards = page.locator("[data-question] details");
    expect(await cards.count()).toBe(6);
    for (const card of await cards.all()) {
      expect(await card.locator(".back").isVisible()).toBe(false);
      await card.locator("summary").click();
      expect(await card.locator(".back").isVisible()).toBe(true);
      expect(Number(await card.locator("data").getAttribute("value"))).not.toBeNaN();
    }
    await page.context().close();
  }
});
