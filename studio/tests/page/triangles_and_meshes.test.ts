// The exhibits of the lesson's first two parts: each number changes as the exhibit claims, by mouse, touch and keys.
import { afterAll, afterEach, beforeAll, expect, test } from "vitest";
import type { Vec3 } from "../../src/viewer/layers";
import { type View, dot, towardsEye } from "../../src/viewer/view";
import { ExhibitPages, drag, grip, live } from "./exhibit_page";
import { digits, isLong, settled } from "./site";

let pages: ExhibitPages;
beforeAll(async () => {
  pages = await ExhibitPages.open();
});
afterEach(() => expect(pages.errors).toEqual([]));
afterAll(() => pages.close());

test("quad: lifting D by mouse and keys moves the number and the middle; three corners stay at zero", async () => {
  const page = await pages.at("quad.html");
  await live(page);
  const before = await pages.number("quad");
  await drag(page, grip(page), 0, 60);
  const after = await pages.number("quad");
  expect(after).toBeLessThan(before - 0.1);
  expect(await digits(page, "rise")).toBeCloseTo(after / 2, 12);
  await grip(page).focus();
  await page.keyboard.press("ArrowUp");
  await page.keyboard.press("Shift+ArrowUp");
  expect(await pages.number("quad")).toBeCloseTo(after + 0.11, 2);
  expect(await grip(page).getAttribute("aria-valuetext")).toContain("units");
  await page.locator("input[name=corners][value='3']").check();
  await grip(page).focus();
  for (const key of ["PageUp", "ArrowDown", "End", "Home"]) {
    await page.keyboard.press(key);
    expect(await pages.number("quad")).toBe(0);
  }
});

test("quad: a horizontal stroke of a finger turns the figure, two keys turn it back", async () => {
  const page = await pages.at("quad.html", { hasTouch: true, viewport: { width: 400, height: 800 } });
  await live(page);
  const box = (await page.locator(".scene").boundingBox())!;
  const touch = await page.context().newCDPSession(page);
  const at = (dx: number) => [{ x: box.x + 60 + dx, y: box.y + 40 }];
  await touch.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: at(0) });
  for (let dx = 10; dx <= 100; dx += 10) await touch.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: at(dx) });
  await touch.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  const turned = (await pages.state("quad"))["view"] as { azimuth: number; elevation: number };
  expect(turned.azimuth).toBeLessThan(-80);
  await page.locator(".scene").focus();
  await page.keyboard.press("Home");
  expect((await pages.state("quad"))["view"]).toEqual((pages.exhibits.get("quad")!.defaults as { view: unknown }).view);
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("+");
  const near = (await pages.state("quad"))["view"] as { distance: number; azimuth: number };
  expect(near.distance).toBeLessThan(6);
  expect(near.azimuth).not.toBe(turned.azimuth);
});

test("inside: the point is inside exactly where all three signs agree, and clockwise they are all negative", async () => {
  const page = await pages.at("inside.html");
  expect(await pages.number("inside")).toBe(3);
  await drag(page, grip(page), -250, 0);
  expect(await pages.number("inside")).toBeLessThan(3);
  expect(await page.locator(".live .meaning").textContent()).toContain("outside");
  await pages.on("inside.html", "#v=1&w=cw");
  expect(await pages.number("inside")).toBe(0);
  expect(await page.locator(".live .meaning").textContent()).toContain("is inside");
  for (const i of [0, 1, 2]) expect(await digits(page, `edge-${i}`)).toBeLessThan(0);
  // At a corner two edge functions are exactly zero.
  await pages.on("inside.html", "#v=1&p=2,1.4");
  expect([await digits(page, "edge-1"), await digits(page, "edge-2")]).toEqual([0, 0]);
  expect(await page.locator(".live .meaning").textContent()).toContain("On an edge");
});

test("weights: the smallest is positive inside and negative outside, they sum to one; four corners have two colours", async () => {
  const page = await pages.at("weights.html");
  expect(await pages.number("weights")).toBeGreaterThan(0.2);
  await grip(page).focus();
  const seen: number[] = [];
  for (const key of ["ArrowLeft", "PageDown", "Shift+ArrowUp", "PageUp", "Home"]) {
    await page.keyboard.press(key);
    const smallest = await pages.number("weights");
    seen.push(smallest);
    const weights = await Promise.all([0, 1, 2].map((k) => digits(page, `weight-0-${k}`)));
    expect(Math.min(...weights)).toBe(smallest);
    expect(await digits(page, "sum-0")).toBeCloseTo(1, 14);
    expect(await page.locator(".live.good").count()).toBe(smallest < 0 ? 0 : 1);
  }
  expect(Math.max(...seen)).toBeGreaterThan(0.2);
  expect(Math.min(...seen)).toBeLessThan(-0.1);
  // At a corner its own weight is one, and the others are zero.
  await page.evaluate(() => (location.hash = "#v=1&p=1.4,1.1"));
  expect(await pages.number("weights")).toBe(0);
  expect(await page.locator(".live .meaning").textContent()).toContain("On an edge");
  await page.locator("input[name=corners][value='4']").check();
  await pages.on("weights.html", "#v=1&c=4&p=6,4");
  const gap = await pages.number("weights");
  expect(gap).toBeGreaterThan(0.3);
  const differences = await Promise.all(
    [0, 1, 2].map(async (k) => Math.abs((await digits(page, `color-0-${k}`)) - (await digits(page, `color-1-${k}`)))),
  );
  expect(Math.max(...differences)).toBeCloseTo(gap, 12);
});

test("weights: the browser's blend at a point is the core's colour", async () => {
  const page = await pages.on("weights.html", "#v=1&p=8,3");
  const shown = await page.locator("svg.flat").screenshot();
  const box = (await page.locator("svg.flat").boundingBox())!;
  // Beside the probe and its lines; the core gets the same point.
  const place = [4.4, 2.2] as const;
  const { question, defaults } = pages.exhibits.get("weights")!;
  const answer = pages.core.ask("exhibit", { exhibit: "weights", ...question({ ...(defaults as object), probe: place }) }) as {
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
  const page = await pages.at("indexed.html");
  await live(page);
  for (const storage of ["indexed", "unindexed"]) {
    await page.locator(`input[name=storage][value=${storage}]`).check();
    for (const stop of isLong ? ["0", "6", "12"] : ["0", "6"]) {
      await page.locator("#triangles").fill(stop);
      const bytes = await pages.number("indexed");
      const n = await digits(page, "triangles");
      const vertices = await digits(page, "vertices");
      const each = await digits(page, "per-vertex");
      // Three corners a triangle, divided by the vertices.
      expect(vertices * each).toBeCloseTo(3 * n, 6);
      expect(bytes).toBe(storage === "indexed" ? 12 * vertices + 6 * n : 36 * n);
    }
  }
  expect(await digits(page, "ring")).toBeGreaterThan(3);
});

test("index: a pressed vertex is marked, the address keeps it, and a button marks others", async () => {
  const page = await pages.at("indexed.html");
  await live(page);
  const marked = async () => {
    const state = await pages.state("indexed");
    const { vertex, mesh } = pages.core.ask("exhibit", { exhibit: "indexed", ...pages.exhibits.get("indexed")!.question(state) }) as {
      vertex: { row: number; at: Vec3; faces: number[] };
      mesh: { indices: Uint32Array };
    };
    const faces = Array.from({ length: mesh.indices.length / 3 }, (_, face) => face);
    return { near: state["near"] as Vec3, vertex, users: faces.filter((face) => mesh.indices.subarray(3 * face, 3 * face + 3).includes(vertex.row)) };
  };
  const first = await marked();
  const box = (await page.locator(".scene").boundingBox())!;
  // On the belly, right of the marked one.
  await page.mouse.click(box.x + 0.55 * box.width, box.y + 0.66 * box.height);
  await settled(page);
  const second = await marked();
  expect(second.vertex.row).not.toBe(first.vertex.row);
  expect(second.near.map((x) => Math.round(1e3 * x))).toEqual(second.vertex.at.map((x) => Math.round(1e3 * x)));
  expect(second.vertex.faces).toEqual(second.users);
  expect(await digits(page, "ring")).toBe(second.users.length);
  await page.getByRole("button", { name: "Mark the next one" }).click();
  await settled(page);
  expect((await marked()).vertex.row).toBe(second.vertex.row + 1);
});

test("normals: a cube has 24 vertices below 90°, 8 above; a smooth ball needs no additional vertices", async () => {
  const page = await pages.at("normals.html");
  await live(page);
  const slider = page.locator("#crease");
  expect(await pages.number("normals")).toBe(24);
  await slider.fill("89");
  expect(await pages.number("normals")).toBe(24);
  await slider.focus();
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowRight");
  expect(await pages.number("normals")).toBe(8);
  await page.locator("input[name=shape][value=ball]").check();
  expect(await pages.number("normals")).toBe(162);
  await slider.fill("0");
  expect(await pages.number("normals")).toBe(960);
  expect(await digits(page, "positions")).toBe(162);
});

test("culling: a pressed triangle is turned over, breaks three edges and leaves a hole, which is invisible from behind", async () => {
  const page = await pages.at("culling.html#v=1&f=");
  await live(page);
  expect(await pages.number("culling")).toBe(0);
  const box = (await page.locator(".scene").boundingBox())!;
  await page.mouse.click(box.x + box.width / 2 + 4, box.y + box.height / 2 + 3);
  await settled(page);
  expect(await pages.number("culling")).toBe(1);
  expect(await digits(page, "inconsistent")).toBe(3);
  const { flipped } = (await pages.state("culling")) as { flipped: number[] };
  expect(flipped.length).toBe(1);
  await drag(page, page.locator(".scene"), 440, 0, 20);
  expect(await pages.number("culling")).toBe(0);
  expect(await digits(page, "back-share")).toBeGreaterThan(0.35);
  await page.getByRole("button", { name: "Turn all of them over" }).click();
  await page.getByRole("button", { name: "Turn it over" }).click();
  await settled(page);
  expect(await digits(page, "inconsistent")).toBe(0);
});

test("culling: the sentence describes the picture for any turned triangles, culled or painted", async () => {
  const all = Array.from({ length: 80 }, (_, i) => i);
  const page = await pages.on("culling.html", "#v=1");
  const said = async (flipped: readonly number[], backs: string) => {
    await page.evaluate((hash) => (location.hash = hash), `#v=1&f=${flipped.join()}&b=${backs}`);
    const holes = await pages.number("culling");
    const [label, meaning] = await Promise.all(
      [".live h2", ".live .meaning"].map(async (what) => (await page.locator(what).textContent())!),
    );
    const volume = await page.locator('[data-name="volume"]').getAttribute("value");
    expect(label!.startsWith(backs === "culled" ? "Holes" : "Backs"), backs).toBe(true);
    return { holes, meaning: meaning!, volume: volume ? Number(volume) : null, disagree: await digits(page, "inconsistent") };
  };
  const front = { culled: /left (a hole|holes)/, painted: /orange/ };
  const none = { culled: /leaves out the far half/, painted: /none shows/ };
  const far = { culled: /far side/, painted: /far side/ };
  const out = { culled: /inside out: culling/, painted: /inside out: every/ };
  for (const backs of ["culled", "painted"] as const) {
    const whole = await said([], backs);
    expect([whole.holes, whole.disagree]).toEqual([0, 0]);
    expect(whole.meaning).toMatch(none[backs]);
    expect(whole.volume).toBeGreaterThan(3);
    const turned = await said(all, backs);
    expect(turned.disagree).toBe(0);
    expect(turned.holes).toBeGreaterThan(20);
    expect(turned.meaning).toMatch(out[backs]);
    expect(turned.volume).toBe(-whole.volume!);
    // One that faces the eye, and one that does not; then all but one.
    const ways = [[47], [0], [20], all.slice(1)];
    const some = [];
    // In `make test` two of them with painted backs.
    for (const way of isLong || backs === "culled" ? ways : ways.slice(0, 2)) some.push(await said(way, backs));
    for (const { holes, meaning, volume, disagree } of some) {
      expect(meaning).toMatch(holes ? front[backs] : far[backs]);
      expect([volume, disagree]).toEqual([null, 3]);
    }
    expect(new Set(some.map(({ holes }) => Math.min(holes, 1))).size).toBe(2);
  }
});

test("doctor: the offered buttons repair every mesh", async () => {
  const page = await pages.at("doctor.html");
  const patients = ["hole", "seam", "crack", "flipped", "branch", "double"];
  // Every second one in `make test`, from the seam on.
  for (const patient of patients.filter((_, k) => isLong || k % 2 === 1)) {
    await page.locator(`input[name=patient][value=${patient}]`).check();
    await settled(page);
    expect(await pages.number("doctor"), patient).toBeGreaterThan(0);
    const cure = page.locator(".findings li > button").first();
    for (let i = 0; (await cure.count()) > 0; i++) {
      expect(i, patient).toBeLessThan(4);
      await cure.click();
      await settled(page);
    }
    expect(await pages.number("doctor"), patient).toBe(0);
    expect(await digits(page, "closed")).toBe(1);
    expect(await digits(page, "volume")).toBeGreaterThan(3);
    await page.getByRole("button", { name: "Take the last one back" }).click();
    await settled(page);
  }
});

/** The view in the address. */
const viewOf = async (id: string) => (await pages.state(id))["view"] as View;

test("doctor: every place is listed, and choosing one turns the view to it", async () => {
  const page = await pages.at("doctor.html#v=1&p=flipped");
  const places = page.locator(".places");
  let faced = 0;
  for (const list of await places.all()) {
    const buttons = list.getByRole("button");
    const n = await buttons.count();
    expect(n).toBeGreaterThan(0);
    await buttons.last().click();
    await settled(page);
    expect(await buttons.last().getAttribute("aria-pressed")).toBe("true");
    // The chosen place is on the near side of the ball about the origin.
    const { places: found } = ((await answer("flipped")) as { findings: { places: Vec3[][] }[] }).findings[faced]!;
    expect(n).toBe(found.length);
    const middle = [0, 1, 2].map((k) => found.at(-1)!.reduce((sum, p) => sum + p[k]! / found.at(-1)!.length, 0)) as unknown as Vec3;
    expect(dot(towardsEye(await viewOf("doctor")), middle), String(middle)).toBeGreaterThan(0.9 * Math.hypot(...middle));
    faced += 1;
  }
  expect(faced).toBeGreaterThan(0);
});
const answer = async (patient: string) => pages.core.ask("exhibit", { exhibit: "doctor", patient, cures: [] });
