// The workbench after mistakes and from near: the page says to which input the mesh belongs, and promises nothing wrong.
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, expect, test, vi } from "vitest";
import { ROOT, Site, axeFindings, digits, isLong, settled } from "./site";
import { PATIENCE, Workbenches, line, panel, small, write } from "./workbench_page";

vi.setConfig(PATIENCE);

let site: Site;
let pages: Workbenches;
beforeAll(async () => {
  site = await Site.open();
  pages = new Workbenches(site);
});
afterEach((context) => pages.close(context));
afterAll(() => site.close());

const certificate = (page: Page) => page.locator(".certificate").textContent();
const exportsOf = (page: Page) => page.locator("[data-export]").evaluateAll((all) => all.map((one) => (one as HTMLButtonElement).disabled));

test("a typing mistake leaves the previous shape, proved and marked as old", async () => {
  const { page } = await pages.open();
  const before = await digits(page, "triangles");
  await page.locator(".cm-content").click();
  await page.keyboard.press("Control+End");
  // Key by key: the texts in between are shapes, too, and get drafts.
  await page.keyboard.type(" | box(3, 1, 1)", { delay: 30 });
  await expect.poll(() => digits(page, "triangles")).not.toBe(before);
  await page.keyboard.type(" - (");
  await page.locator(".fault").waitFor();
  await settled(page);
  expect(await digits(page, "triangles")).not.toBe(before);
  expect(await certificate(page)).toContain("the last valid shape");
  expect(await certificate(page)).not.toContain("is running");
  expect(await page.locator(".certificate .big.old").textContent()).toMatch(/^off by at most/);
  expect(await page.locator(".messages .outdated").count()).toBe(1);
  expect(await page.locator(".fault").textContent()).toContain("Line 1");
  await write(page, "sphere(1)");
  await settled(page);
  expect([await page.locator(".fault, .messages .outdated").count(), await page.locator(".certificate .big.proved").count()]).toEqual([0, 1]);
});

test("an emptied script has no green certificate and nothing to export, with a message", async () => {
  const { page } = await pages.open(await small("sphere(1)", ".zh"));
  expect(new Set(await exportsOf(page))).toEqual(new Set([false]));
  await page.locator(".cm-content").click();
  await page.keyboard.press("Control+a");
  await page.keyboard.press("Delete");
  await page.locator(".fault").waitFor();
  await settled(page);
  expect(await page.locator(".certificate .proved").count()).toBe(0);
  expect(await certificate(page)).toContain("上一个成功的形状");
  expect(new Set(await exportsOf(page))).toEqual(new Set([true]));
  expect(await page.locator(".export").textContent()).toContain("没有可导出的");
  await panel(page, "change");
  expect(await page.getByRole("button", { name: "按一个像素生成各层次" }).isDisabled()).toBe(true);
  expect(await axeFindings(page)).toEqual([]);
  await write(page, "sphere(2)");
  await settled(page);
  expect(new Set(await exportsOf(page))).toEqual(new Set([false]));
});

test("a cancelled proof leaves a draft with a message", async () => {
  const { page } = await pages.open();
  await page.locator(".budget input[type=text]").fill("0.0001%");
  await page.keyboard.press("Enter");
  await page.locator(".status .draft").waitFor();
  await page.locator(".status").getByRole("button", { name: "Stop" }).click();
  await settled(page);
  expect(await certificate(page)).toContain("its proof failed or was stopped");
});

/** The page's data on a level: its error in pixels, the distance for one pixel, and the current distance. */
async function level(page: Page): Promise<{ pixels: number; from: number | null; away: number }> {
  const panel = page.locator("#panel-change .panel", { has: page.locator("#distance") });
  const text = (await panel.textContent())!;
  const [, pixels] = /which is at most ([\d.]+) px from here/.exec(text)!;
  const from = /at most one pixel beyond a distance of ([\d.]+)/.exec(text)?.[1];
  return { pixels: Number(pixels), from: from ? Number(from) : null, away: Number(await panel.locator("output").textContent()) };
}

test("levels show their error in pixels from here, and are built for the current view", async () => {
  // In `make test` the input is small.
  const { page } = await pages.open(isLong ? "workbench.html" : undefined);
  await panel(page, "change");
  const make = async () => {
    await page.getByRole("button", { name: "Build levels for one pixel" }).click();
    await page.locator("#distance").waitFor();
    await settled(page);
  };
  await make();
  expect((await level(page)).pixels).toBeLessThanOrEqual(1);
  await page.locator("#distance").focus();
  await page.keyboard.press("Home");
  await expect.poll(async () => (await level(page)).pixels).toBeGreaterThan(1.5);
  const near = await level(page);
  expect(near.from).toBeGreaterThan(near.away);
  // Nearer, an error is more pixels.
  expect((near.pixels * near.away) / near.from!).toBeCloseTo(1, 1);
  await page.getByRole("button", { name: "Back to the mesh" }).click();
  await make();
  const levelHere = await level(page);
  expect(levelHere.away).toBeCloseTo(near.away, 1);
  expect([levelHere.pixels <= 1, levelHere.from]).toEqual([true, null]);
});

test("the view of the worst place does not lead to a hundred times the triangles", async () => {
  const { page } = await pages.open(await small("(box(2, 1, 1) | box(1, 2, 0.5)) - cylinder(0.3, 3)"));
  await page.locator('input[name=budget][value="px"]').check({ force: true });
  await expect.poll(() => line(page)).toContain("--px 1 --view");
  await settled(page);
  const [before, far] = [await digits(page, "triangles"), await distance(page)];
  expect(await page.locator(".budget").textContent()).toContain("from here or farther");
  await panel(page, "certificate");
  await page.getByRole("button", { name: "Go to the worst place" }).click();
  await settled(page);
  // The eye is nearer than that, and the page says so.
  expect(await page.locator(".budget").textContent()).toContain("you are nearer");
  expect(await distance(page)).toBeGreaterThan(far / 4);
  expect(await digits(page, "triangles")).toBeLessThan(4 * before);
  expect(await page.locator(".fault").count()).toBe(0);
});

test("after growth to ten times the size the view is reset, from the same side", async () => {
  const { page } = await pages.open(await small("box(2, 1, 1)"));
  await page.locator('input[name=budget][value="px"]').check({ force: true });
  await expect.poll(() => line(page)).toContain("--px 1 --view");
  await settled(page);
  const before = await distance(page);
  await write(page, "box(20, 10, 10)");
  await settled(page);
  await expect.poll(async () => (await distance(page)) / before).toBeCloseTo(10, 1);
  expect(await page.locator(".budget").textContent()).toContain("from here or farther");
  // If the shape grows a little, the view is kept, and the eye is nearer.
  await write(page, "box(22, 10, 10)");
  await expect.poll(async () => (await distance(page)) / before).toBeLessThan(10);
});

const distance = async (page: Page) => Number(/dist=([\d.]+)/.exec((await line(page))!)![1]);

test("a file has no place on the shelf, its attributes are in the certificate, and its link restores it", async () => {
  const { page } = await pages.open();
  const picker = page.locator(".inputs input[type=file]");
  await picker.setInputFiles(join(ROOT, "../tests/web/painted.gltf"));
  await expect.poll(() => line(page)).toContain("painted.gltf");
  await page.locator(".budget input[type=text]").fill("5%");
  await page.keyboard.press("Enter");
  await settled(page);
  expect(await page.locator("[data-shelf=keep], [data-shelf=save]").count()).toBe(0);
  const facts = page.locator(".certificate .facts");
  expect(await facts.locator('[data-attribute="normal"]').textContent()).toMatch(/^Normals, measured error[\d.]+°$/);
  expect(await facts.locator('[data-attribute="texcoord 0"]').textContent()).toMatch(/^Texture coordinates, measured error0\.\d+$/);
  // Any small file has a link.
  const stl = Buffer.alloc(84 + 50);
  stl.writeUInt32LE(1, 80);
  [0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0].forEach((value, k) => stl.writeFloatLE(value, 84 + 4 * k));
  await picker.setInputFiles({ name: "one.stl", mimeType: "model/stl", buffer: stl });
  await settled(page);
  await page.waitForFunction(() => location.hash.startsWith("#s="));
  expect(await page.locator(".line").textContent()).toContain("The address of this page contains the shape");
  const address = page.url();
  // The note is about the number of files, not their size.
  await picker.setInputFiles([
    { name: "one.obj", mimeType: "text/plain", buffer: Buffer.from("mtllib one.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n") },
    { name: "one.mtl", mimeType: "text/plain", buffer: Buffer.from("newmtl a\n") },
  ]);
  await settled(page);
  await expect.poll(() => page.locator(".line").textContent()).toContain("only a single small file");
  await pages.close();
  const other = await pages.open(address.slice(address.indexOf("workbench.html")));
  await expect.poll(() => digits(other.page, "triangles")).toBe(1);
});
