// The workbench's picture and layout: it fills the window, panels lie over it and are remembered, nothing scrolls the page; the
// wheel, the sides, measuring and the section, by pointer and by keys.
import type { Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, expect, test, vi } from "vitest";
import { Site, settled } from "./site";
import { PATIENCE, Workbenches, faults, panel, small, write } from "./workbench_page";

vi.setConfig(PATIENCE);

let site: Site;
let pages: Workbenches;
beforeAll(async () => {
  site = await Site.open();
  pages = new Workbenches(site);
});
afterEach((context) => pages.close(context));
afterAll(() => site.close());

const LAPTOP = { viewport: { width: 1366, height: 768 } };
const PHONE = { viewport: { width: 390, height: 844 } };

/** The share of the window that the picture has, and that of it which nothing covers. */
const shares = (page: Page) =>
  page.evaluate(() => {
    const { width, height } = document.querySelector(".stage-column canvas")!.getBoundingClientRect();
    const covers = [...document.querySelectorAll(".bench > header, .status, .tabs-of-panels, .sheet")].map((one) => one.getBoundingClientRect());
    let [free, all] = [0, 0];
    for (let x = 5; x < innerWidth; x += 10) {
      for (let y = 5; y < innerHeight; y += 10) {
        all += 1;
        if (!covers.some((box) => x >= box.left && x < box.right && y >= box.top && y < box.bottom)) free += 1;
      }
    }
    return [(width * height) / (innerWidth * innerHeight), free / all] as const;
  });

/** Whether the page as a whole cannot be scrolled. */
const isStill = (page: Page) =>
  page.evaluate(() => {
    scrollTo(0, 500);
    return scrollY === 0 && document.documentElement.scrollWidth <= innerWidth;
  });

test.each([LAPTOP, PHONE])("the picture fills the window, and an enclosure is written, measured and exported without scrolling: $viewport", async (size) => {
  const { page, errors } = await pages.open(undefined, size);
  const isPhone = size === PHONE;
  await write(page, "box(40, 30, 20) - move(box(36, 26, 20), 0, 0, 2)");
  await settled(page);
  expect(await page.locator(".status").textContent()).toMatch(/off by at most .*, proved, [\d,]+ triangles/);
  await page.locator("#panel-input .close").click();
  const [whole, free] = await shares(page);
  expect(whole).toBeCloseTo(1, 2);
  expect(free).toBeGreaterThan(0.7);
  // The wall in front, at the cross in the middle of the picture.
  await page.locator(".scene").focus();
  await page.keyboard.press("1");
  await page.keyboard.press("p");
  await page.getByLabel("Measure").selectOption("wall");
  await page.locator(".scene").focus();
  await page.keyboard.press("Enter");
  const wall = page.locator('[data-result="wall"]').last();
  await wall.waitFor();
  expect(Number(await wall.getAttribute("data-value"))).toBeCloseTo(2, 5);
  expect(await isStill(page), "measured").toBe(true);
  for (const name of ["input", "certificate", "beside", "change", "export"] as const) {
    await panel(page, name);
    expect(await isStill(page), name).toBe(true);
    // Under the panel, too.
    expect((await shares(page))[0]).toBeCloseTo(1, 2);
  }
  await expect.poll(() => page.locator('[data-export="3mf"]').isVisible()).toBe(true);
  // Within the window as it is: nothing is scrolled.
  const { y, height } = (await page.locator('[data-export="3mf"]').boundingBox())!;
  expect(y).toBeGreaterThan(0);
  expect(y + height).toBeLessThanOrEqual(page.viewportSize()!.height);
  const [download] = await Promise.all([page.waitForEvent("download"), page.locator('[data-export="3mf"]').click()]);
  expect(download.suggestedFilename()).toMatch(/\.3mf$/);
  // On a phone one sheet at a time.
  expect(await page.locator(".sheet:visible").count()).toBe(isPhone ? 1 : 2);
  expect(faults(errors)).toEqual([]);
});

test("panels are resized by pointer and keys, and are as they were after the page is opened again", async () => {
  const { page } = await pages.open(undefined, LAPTOP);
  const width = () => page.locator("#panel-input").evaluate((one) => one.clientWidth);
  const edge = page.locator("#panel-input .edge");
  await edge.focus();
  const before = await width();
  await page.keyboard.press("ArrowRight");
  await expect.poll(width).toBeGreaterThan(before);
  const box = (await edge.boundingBox())!;
  await page.mouse.move(box.x + 4, 400);
  await page.mouse.down();
  await page.mouse.move(500, 400, { steps: 4 });
  await page.mouse.up();
  await expect.poll(width).toBeGreaterThan(490);
  await panel(page, "certificate");
  const wide = await width();
  await page.reload();
  await page.waitForSelector("html[data-ready]");
  await settled(page);
  expect(await width()).toBe(wide);
  expect(await page.locator("#panel-certificate").isVisible()).toBe(true);
  await page.locator("#panel-certificate .close").click();
  // The focus is on the button that opens it again.
  expect(await page.evaluate(() => (document.activeElement as HTMLElement).dataset["panel"])).toBe("certificate");
});

/** The sizes of the box, as the picture shows them. */
const sizesOf = (page: Page) => page.locator(".sizes text").allTextContents();

test("the wheel zooms without scrolling the page, sides and projection change by keys, Home goes back", async () => {
  const { page } = await pages.open(await small("box(4, 3, 2)"), LAPTOP);
  await page.waitForSelector("html[data-solid]");
  expect((await sizesOf(page)).sort()).toEqual(["2", "3", "4"]);
  const square = () => page.locator(".scale").textContent();
  const first = await square();
  await page.mouse.move(900, 400);
  for (let i = 0; i < 12; i++) await page.mouse.wheel(0, -240);
  await expect.poll(square).not.toBe(first);
  expect(await page.evaluate(() => scrollY)).toBe(0);
  await page.locator(".scene").focus();
  await page.keyboard.press("Home");
  await expect.poll(square).toBe(first);
  // From the front the depth has no length in the picture.
  await page.keyboard.press("1");
  await page.keyboard.press("p");
  await expect.poll(async () => (await sizesOf(page)).sort()).toEqual(["2", "4"]);
  expect(await page.getByLabel("Parallel").isChecked()).toBe(true);
  await page.keyboard.press("5");
  await expect.poll(async () => (await sizesOf(page)).sort()).toEqual(["3", "4"]);
  await page.keyboard.press("g");
  expect(await page.getByLabel("Grid", { exact: true }).isChecked()).toBe(false);
});

test("the help is closed by Escape and by a press elsewhere, and what is measured stays", async () => {
  const { page } = await pages.open(undefined, LAPTOP);
  const isOpen = () => page.locator(".about").evaluate((about) => (about as HTMLDetailsElement).open);
  await page.getByLabel("Measure").selectOption("wall");
  await page.locator(".about summary").click();
  expect(await isOpen()).toBe(true);
  await page.keyboard.press("Escape");
  expect([await isOpen(), await page.locator(".measure-card").count()]).toEqual([false, 1]);
  await page.locator(".about summary").click();
  await page.mouse.click(700, 600);
  expect(await isOpen()).toBe(false);
});

test("distances, walls and edges of a box are measured on its mesh, by pointer and by keys, and Escape clears", async () => {
  const { page } = await pages.open(await small("box(4, 3, 2)"), LAPTOP);
  await page.waitForSelector("html[data-solid]");
  await page.locator(".scene").focus();
  await page.keyboard.press("1");
  await page.keyboard.press("p");
  const value = async (of: string) => Number(await page.locator(`[data-result="${of}"]`).last().getAttribute("data-value"));
  // The cross is in the middle of the front.
  await page.getByLabel("Measure").selectOption("wall");
  await page.locator(".scene").focus();
  await page.keyboard.press("Enter");
  await page.locator('[data-result="wall"]').waitFor();
  expect(await value("wall")).toBeCloseTo(3, 5);
  expect(await page.locator(".measure-card").textContent()).toMatch(/± is twice the error of the mesh, .* \(proved\)/);
  // From corner to corner: where the lines of the sizes end, moved to the outline of the box.
  await page.getByLabel("Measure").selectOption("edge");
  const lines = await page.locator(".sizes path").evaluateAll((all) => all.map((one) => (one.getAttribute("d") ?? "").match(/-?[\d.]+/g)!.map(Number)));
  const across = lines.find(([ax, ay, bx, by]) => Math.abs(ay! - by!) < 1 && Math.abs(ax! - bx!) > 50)!;
  const up = lines.find(([ax, ay, bx, by]) => Math.abs(ax! - bx!) < 1 && Math.abs(ay! - by!) > 50)!;
  const [left, right] = [Math.min(across[0]!, across[2]!), Math.max(across[0]!, across[2]!)];
  // The line of X is below the box, that of Z at its side.
  const [top, bottom] = [Math.min(up[1]!, up[3]!), Math.max(up[1]!, up[3]!)];
  await page.mouse.click((left + right) / 2, top + 2);
  await page.locator('[data-result="edge"]').waitFor();
  expect(await value("edge")).toBeCloseTo(4, 5);
  await page.getByLabel("Measure").selectOption("distance");
  await page.mouse.click(left + 3, top + 3);
  await page.mouse.click(left + 3, bottom - 3);
  await page.locator('[data-result="distance"]').waitFor();
  expect(await value("distance")).toBeCloseTo(2, 5);
  await page.keyboard.press("Escape");
  await expect.poll(() => page.locator("[data-result]").count()).toBe(0);
  await page.keyboard.press("Escape");
  await expect.poll(() => page.locator(".measure-card").count()).toBe(0);
});

test("the section is moved and turned by its handles, aligned and flipped, and shows its fill", async () => {
  const { page } = await pages.open(await small("sphere(1)"), LAPTOP);
  await page.getByLabel("Cut open").check({ force: true });
  const slide = page.getByRole("slider", { name: "Position of the cut" }).last();
  const shown = () => page.locator(".section-card output").textContent();
  expect(await shown()).toMatch(/^50%, y = /);
  await slide.focus();
  await page.keyboard.press("ArrowUp");
  await expect.poll(shown).toMatch(/^51%, y = −0\.0\d+$/);
  const turn = page.getByRole("slider", { name: "Turn the section" });
  await turn.focus();
  await page.keyboard.press("ArrowRight");
  expect(await turn.getAttribute("aria-valuetext")).toContain("−85°");
  await page.getByRole("button", { name: "Across z" }).click();
  expect(await turn.getAttribute("aria-valuetext")).toContain("90° up");
  await page.getByRole("button", { name: "Flip" }).click();
  await expect.poll(shown).toMatch(/^49%, z = /);
  await page.getByRole("button", { name: "Across y" }).click();
  // Yellow is what the plane cuts.
  const shot = await page.locator(".stage-column .scene").screenshot();
  const yellow = await page.evaluate(async (data) => {
    const image = await createImageBitmap(new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], { type: "image/png" }));
    const canvas = new OffscreenCanvas(image.width, image.height).getContext("2d")!;
    canvas.drawImage(image, 0, 0);
    const { data: dots } = canvas.getImageData(0, 0, image.width, image.height);
    let count = 0;
    for (let i = 0; i < dots.length; i += 4) if (dots[i]! > 200 && dots[i + 1]! > 150 && dots[i + 2]! < 120) count += 1;
    return (4 * count) / dots.length;
  }, shot.toString("base64"));
  expect(yellow).toBeGreaterThan(0.03);
});

test("a face leads to its line in the script, and a line to its faces; print() and several mistakes are shown", async () => {
  const { page } = await pages.open(await small("a = box(4, 3, 2)\nb = cylinder(0.8, 5)\nprint('wall', 2)\na - b"), LAPTOP);
  await page.waitForSelector("html[data-solid]");
  expect(await page.locator(".said").textContent()).toContain("wall 2");
  await page.locator(".scene").focus();
  await page.keyboard.press("1");
  await page.keyboard.press("p");
  await page.waitForFunction(() => document.querySelectorAll(".sizes text").length === 2);
  const { x, y, width, height } = (await page.locator(".scene").boundingBox())!;
  // The free part of the window is right of the script.
  const left = (await page.locator("#panel-input").boundingBox())!.width;
  await page.mouse.click(x + left + (width - left) / 2, y + height / 2);
  await expect.poll(() => page.locator(".site").textContent()).toContain("Line 1: box()");
  await page.locator(".cm-line").nth(1).click();
  await expect.poll(() => page.locator(".site").textContent()).toContain("Line 2: cylinder()");
  await write(page, "a = bx(1, 1, 1)\nb = sphre(2)\na + b");
  await page.locator(".fault").waitFor();
  await settled(page);
  expect(await page.locator(".fault").textContent()).toContain("Line 1");
  expect(await page.locator(".more-faults").textContent()).toContain("Line 2");
  expect(await page.locator(".cm-problem").count()).toBe(2);
});

test.each(["no-preference", "reduce"] as const)("a turn goes on after it was let go and comes to rest, but not with reduced motion: %s", async (reducedMotion) => {
  const { page } = await pages.open(undefined, { ...LAPTOP, reducedMotion });
  // All in one task, since a busy machine hands events of a real pointer on too late to be a throw.
  await page.locator(".scene").evaluate((scene) => {
    scene.setPointerCapture = () => undefined;
    const send = (type: string, x: number) =>
      scene.dispatchEvent(new PointerEvent(type, { pointerId: 1, pointerType: "mouse", button: 0, buttons: 1, clientX: x, clientY: 400, bubbles: true }));
    send("pointerdown", 800);
    for (let i = 1; i <= 8; i++) send("pointermove", 800 + 10 * i);
    send("pointerup", 880);
  });
  const triad = () => page.locator(".triad").innerHTML();
  const turned = await page.evaluate(async () => {
    const frame = () => new Promise(requestAnimationFrame);
    const seen = new Set<string>();
    // Until it rests: for ten frames nothing changes.
    for (let still = 0; still < 10; still++) {
      await frame();
      const now = document.querySelector(".triad")!.innerHTML;
      if (!seen.has(now)) still = 0;
      seen.add(now);
    }
    return seen.size;
  });
  if (reducedMotion === "reduce") expect(turned).toBeLessThanOrEqual(2);
  else expect(turned).toBeGreaterThan(3);
  const rested = await triad();
  await settled(page);
  expect(await triad()).toBe(rested);
});
