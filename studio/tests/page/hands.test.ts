// The exhibits whose shapes are moved by hand: each number follows the hand, by mouse, touch and keys.
import { afterAll, afterEach, beforeAll, expect, test } from "vitest";
import { ExhibitPages, drag, live } from "./exhibit_page";
import { digits, settled } from "./site";

let pages: ExhibitPages;
beforeAll(async () => {
  pages = await ExhibitPages.open();
});
afterEach(() => expect(pages.errors).toEqual([]));
afterAll(() => pages.close());

/** The handle with this name. */
const handle = (page: Awaited<ReturnType<ExhibitPages["at"]>>, name: string) => page.getByRole("slider", { name, exact: true });

test("pixels: with the top-left rule each pixel of two triangles is filled once, with the others twice or not at all", async () => {
  const page = await pages.at("pixels.html");
  const before = await pages.number("pixels");
  await drag(page, handle(page, "Corner B"), -200, -40);
  expect(await pages.number("pixels")).toBeLessThan(before);
  const corners = (await pages.state("pixels"))["corners"] as [number, number][];
  expect(corners.flat().every((x) => Number.isInteger(4 * x)), "corners stay on the lattice").toBe(true);
  // All corners and the middle of A–C are centres of pixels.
  await pages.on("pixels.html", "#v=1&p=1.5,1.5,6.5,1.5,6.5,6.5,1.5,6.5&c=2");
  expect([await pages.number("pixels"), await digits(page, "twice"), await digits(page, "missed")]).toEqual([25, 0, 0]);
  await page.locator("input[name=rule][value=closed]").check();
  expect([await pages.number("pixels"), await digits(page, "twice")]).toEqual([36, 6]);
  await page.locator("input[name=rule][value=open]").check();
  expect([await pages.number("pixels"), await digits(page, "missed")]).toEqual([12, 4]);
  expect(await page.locator(".live.bad").count()).toBe(1);
  await page.locator("input[name=show][value=colors]").check();
  await settled(page);
  expect(await page.locator(".flat rect:not(.chosen-pixel)").count()).toBe(12);
  await handle(page, "The chosen pixel").focus();
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowDown");
  expect((await pages.state("pixels"))["pixel"]).toEqual([6, 2]);
});

test("fan: any diagonals give n − 2, a fan folds where the shape is concave, and ear clipping does not", async () => {
  const page = await pages.at("fan.html");
  expect(await pages.number("fan")).toBe(0);
  for (let cut = 1; cut <= 4; cut++) {
    await page.locator(".panel .buttons").first().locator("button:not(.made)").nth(cut % 2).or(page.locator(".panel .buttons").first().locator("button:not(.made)").first()).first().click();
    await settled(page);
  }
  expect(await pages.number("fan")).toBe(5);
  expect(await page.locator(".live.good").count()).toBe(1);
  // In the figure: a press on a cut undoes it.
  await page.locator(".diagonal .cut").first().click({ force: true });
  expect(await pages.number("fan")).toBeLessThan(5);
  await page.getByRole("button", { name: "an arrow" }).click();
  await page.locator("input[name=way][value=fan]").check();
  const folds: number[] = [];
  for (let apex = 0; apex < 7; apex++) {
    await page.locator(`input[name=apex][value='${apex}']`).check();
    folds.push(await pages.number("fan"));
  }
  expect(Math.max(...folds)).toBeGreaterThan(0);
  await page.locator("input[name=way][value=ears]").check();
  expect(await pages.number("fan")).toBe(5);
  await drag(page, handle(page, "Corner D"), -300, 0);
  expect(await pages.number("fan")).toBe(5);
});

test("cross: the area follows a corner, and swapping two turns the normal round", async () => {
  const page = await pages.at("cross.html");
  await live(page);
  const before = await pages.number("cross");
  await drag(page, handle(page, "Corner v₁"), 60, 0);
  const after = await pages.number("cross");
  expect(after).toBeGreaterThan(before + 0.1);
  const z = await digits(page, "product-2");
  await page.locator("input[name=order][value='021']").check();
  expect(await pages.number("cross")).toBe(after);
  expect(await digits(page, "product-2")).toBe(-z);
  await handle(page, "Corner v₁").focus();
  const far = (await pages.state("cross"))["corners"] as number[][];
  await page.keyboard.press("PageUp");
  await page.keyboard.press("ArrowUp");
  const moved = (await pages.state("cross"))["corners"] as number[][];
  expect(moved[2]).not.toEqual(far[2]);
  expect([moved[0], moved[1]]).toEqual([far[0], far[1]]);
  await pages.on("cross.html", "#v=1&p=-1,-1,0,0,0,0,1,1,0");
  expect(await pages.number("cross")).toBe(0);
});

test("tangent: a mirrored texture has the other hand, a collapsed one none", async () => {
  const page = await pages.at("tangent.html");
  await live(page);
  expect(await pages.number("tangent")).toBe(1);
  await page.getByRole("button", { name: "Mirror u" }).click();
  expect(await pages.number("tangent")).toBe(-1);
  const [t, b, n] = await Promise.all(["tangent", "bitangent", "normal"].map((name) => Promise.all([0, 1, 2].map((k) => digits(page, `${name}-${k}`)))));
  for (const [p, q] of [[t, b], [b, n], [n, t]]) expect(p!.reduce((sum, x, k) => sum + x * q![k]!, 0)).toBeCloseTo(0, 6);
  await drag(page, handle(page, "Corner B in the texture"), 140, 0);
  expect(await pages.number("tangent")).toBe(-1);
  // A passes B, and the texture is no longer mirrored.
  await drag(page, handle(page, "Corner A in the texture"), -140, 0);
  expect(await pages.number("tangent")).toBe(1);
  await pages.on("tangent.html", "#v=1&c=0,0,0.5,0.5,1,1");
  expect(await pages.number("tangent")).toBe(0);
});

test("patch: every point has its weight, and half the pixels take more triangles, proved", async () => {
  const page = await pages.at("patch.html");
  await live(page);
  const before = await pages.number("patch");
  await page.locator("#v").fill("0.9");
  expect(await pages.number("patch")).toBeLessThan(before);
  expect(await digits(page, "sum")).toBeCloseTo(1, 14);
  await drag(page, handle(page, "Control point P₁₁"), 0, -40);
  const { chosen, control } = (await pages.state("patch")) as { chosen: number; control: number[][] };
  expect(chosen).toBe(5);
  expect(control[5]![2]).toBeGreaterThan(1.8);
  // Another shape, and back: all points are in their places again.
  const first = (await pages.state("patch"))["control"] as number[][];
  await page.getByRole("button", { name: "spout" }).click();
  await expect.poll(async () => ((await pages.state("patch"))["control"] as number[][])[5]).not.toEqual(first[5]);
  await page.getByRole("button", { name: "a hill" }).click();
  await expect.poll(async () => ((await pages.state("patch"))["control"] as number[][])[5]![2]).toBe(1.7);
  await page.locator("input[name=show][value=triangles]").check();
  const coarse = await pages.number("patch");
  await page.locator("#pixels").focus();
  await page.keyboard.press("ArrowLeft");
  expect(await pages.number("patch")).toBeGreaterThan(1.4 * coarse);
  expect(await page.locator(".live.good").count()).toBe(1);
});

test("pull: creases make the surface follow its corner, by three eighths, two thirds and all", async () => {
  const page = await pages.at("pull.html");
  await live(page);
  expect(await pages.number("pull")).toBeCloseTo(3 / 8, 9);
  const seen: number[] = [];
  for (const other of ["B", "E", "H"]) {
    const edge = page.getByRole("switch", { name: new RegExp(`(F–${other}|${other}–F)`) });
    await edge.focus();
    await page.keyboard.press("Space");
    seen.push(await pages.number("pull"));
  }
  expect(seen[1]).toBeCloseTo(2 / 3, 9);
  expect(seen[2]).toBeCloseTo(1, 9);
  await drag(page, handle(page, "Corner F"), 30, 30);
  expect((await pages.state("pull"))["chosen"]).toBe(5);
  expect(await pages.number("pull")).toBeCloseTo(1, 9);
});

test("spline: a press adds a point; two, four or all pieces move with one", async () => {
  const page = await pages.at("spline.html");
  expect(await pages.number("spline")).toBe(4);
  const box = (await page.locator("svg.flat").boundingBox())!;
  await page.mouse.click(box.x + 0.5 * box.width, box.y + 0.12 * box.height);
  const { points, chosen } = (await pages.state("spline")) as { points: number[][]; chosen: number };
  expect([points.length, chosen]).toEqual([8, 7]);
  expect(points[7]![0]).toBeCloseTo(6, 0);
  await handle(page, "Point 4").focus();
  for (const [kind, moving, class_] of [["lines", 2, 0], ["catmull-rom", 4, 1], ["natural", 7, 2]] as const) {
    await page.locator(`input[name=kind][value=${kind}]`).check();
    expect(await pages.number("spline"), kind).toBe(moving);
    expect(await digits(page, "class")).toBe(class_);
  }
  await drag(page, handle(page, "Point 4"), 0, -50);
  expect(((await pages.state("spline"))["points"] as number[][])[3]![1]).toBeGreaterThan(3.8);
});

test("ride: the acceleration jumps on a C1 path and not on a C2 path; it plays, and calmly where motion is reduced", async () => {
  const page = await pages.at("ride.html");
  await live(page);
  expect(await pages.number("ride")).toBeGreaterThan(1);
  await page.locator("input[name=kind][value=C2]").check();
  expect(await pages.number("ride")).toBe(0);
  await drag(page, handle(page, "Point 3 of the path"), -60, 30);
  expect(await pages.number("ride")).toBe(0);
  for (const reducedMotion of ["no-preference", "reduce"] as const) {
    await page.emulateMedia({ reducedMotion });
    const before = await page.locator("#time").inputValue();
    await page.locator(".play").click();
    await page.waitForFunction((before) => document.querySelector<HTMLInputElement>("#time")!.value !== before, before);
    await page.locator(".play").click();
    await settled(page);
  }
});

test("a finger moves a point in space", async () => {
  const page = await pages.at("pull.html", { hasTouch: true, viewport: { width: 400, height: 800 } });
  await live(page);
  const reach = (await handle(page, "Corner F").locator(".reach").boundingBox())!;
  expect(Math.min(reach.width, reach.height)).toBeGreaterThanOrEqual(24);
  const touch = await page.context().newCDPSession(page);
  const at = (dx: number) => [{ x: reach.x + reach.width / 2 + dx, y: reach.y + reach.height / 2 }];
  const before = (await pages.state("pull")) as { corners: number[][]; view: unknown };
  await touch.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: at(0) });
  for (let dx = 5; dx <= 30; dx += 5) await touch.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: at(dx) });
  await touch.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  const after = (await pages.state("pull")) as { corners: number[][]; view: unknown };
  expect(after.corners[5]).not.toEqual(before.corners[5]);
  expect(after.view).toEqual(before.view);
});

test("the corners and control points of inside, weights and bernstein can be moved", async () => {
  for (const [id, name] of [["inside", "Corner B"], ["weights", "Corner B"], ["bernstein", "Control point P₂"]] as const) {
    const page = await pages.at(`${id}.html`);
    const before = await pages.number(id);
    await drag(page, handle(page, name), -90, 50);
    await handle(page, name).focus();
    await page.keyboard.press("ArrowUp");
    const state = await pages.state(id);
    expect(state, id).not.toEqual(pages.exhibits.get(id)!.defaults);
    const after = await pages.number(id);
    // Its weights alone do not depend on the points.
    if (id === "weights") expect(after).not.toBe(before);
  }
});
