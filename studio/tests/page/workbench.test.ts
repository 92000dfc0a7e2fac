// The workbench in a browser, by its tasks: write, view, prove, mend, combine, export.
import { unzipSync } from "fflate";
import { mkdtempSync, readFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, describe, expect, test, vi } from "vitest";
import { run } from "../../src/core/command";
import { split } from "../../src/workbench/document";
import { ROOT, Site, digits, settled } from "./site";
import { PATIENCE, Workbenches, commandModule, faults, line, panel, small, text, write } from "./workbench_page";

vi.setConfig(PATIENCE);

const folder = mkdtempSync(join(tmpdir(), "chordal-page-"));
let site: Site;
let pages: Workbenches;
let module: WebAssembly.Module;
beforeAll(async () => {
  site = await Site.open();
  pages = new Workbenches(site);
  module = await commandModule();
});
afterEach((context) => pages.close(context));
afterAll(() => site.close());

const open: Workbenches["open"] = (...how) => pages.open(...how);

async function saved(page: Page, what: string): Promise<Buffer> {
  await panel(page, "export");
  const [download] = await Promise.all([page.waitForEvent("download"), page.locator(`[data-export="${what}"]`).click()]);
  const path = join(folder, download.suggestedFilename());
  await download.saveAs(path);
  return readFileSync(path);
}

describe("a script", () => {
  test("is proved, has the core's number, and exports the command's file, byte for byte", async () => {
    const { page, errors } = await open();
    await write(page, "r = param('r', 0.6)\nbox(2, 2, 1) - sphere(r)\n");
    await settled(page);
    const words = ["mesh", "bracket.star", "--tol", "0.5%", "-o", "bracket.glb"];
    expect(await line(page)).toBe(`chordal ${words.join(" ")}`);
    const script = { "bracket.star": text("r = param('r', 0.6)\nbox(2, 2, 1) - sphere(r)\n") };
    const outcome = await run(module, [...words, "--json"], script);
    const { certificate } = JSON.parse(outcome.stdout);
    expect(await digits(page, "bound")).toBe(certificate.bound.at_most);
    expect(await digits(page, "triangles")).toBe(certificate.output.triangles);
    expect(Buffer.compare(await saved(page, "glb"), outcome.outputs["bracket.glb"]!)).toBe(0);
    const zip = await saved(page, "tiles");
    expect(zip.subarray(0, 2).toString()).toBe("PK");
    // A slider of its parameter: a draft while it moves, then the proof, and one step of undo.
    await page.locator("#param-r").focus();
    await page.keyboard.press("ArrowRight");
    await settled(page);
    expect(await line(page)).toContain("--set r=0.6");
    await page.getByRole("button", { name: "Undo" }).click();
    await settled(page);
    expect(await line(page)).not.toContain("--set");
    expect(faults(errors)).toEqual([]);
  });

  test("with a mistake shows its place, and the last mesh stays", async () => {
    const { page } = await open();
    const before = await digits(page, "bound");
    await page.getByLabel("Cut open").check({ force: true });
    await page.locator("#cut").waitFor();
    await write(page, "sphere(1)\nbox(1, 2");
    await page.locator(".fault").waitFor();
    expect(await page.locator(".fault").textContent()).toContain("Line 2");
    expect(await digits(page, "bound")).toBe(before);
    // A script that would run forever ends with a message, too.
    await write(page, "a = [1]\nfor i in range(60):\n    a = a + a\nsphere(1)");
    await expect.poll(() => page.locator(".fault").textContent()).toMatch(/Line [23]/);
    await write(page, "sphere(1)");
    await settled(page);
    expect(await page.locator(".fault").count()).toBe(0);
  });

  test("is restored from the address; a damaged address gives a note", async () => {
    const { page } = await open();
    await write(page, "sphere(2)  # 球");
    await settled(page);
    await page.waitForFunction(() => location.hash.startsWith("#s="));
    const address = page.url();
    // The skip link must not change the address.
    await page.locator("a.skip").focus();
    await page.keyboard.press("Enter");
    expect(page.url()).toBe(address);
    await pages.close();
    const other = await open(address.slice(address.indexOf("workbench.html")));
    await expect.poll(() => other.page.locator(".cm-content").textContent()).toContain("球");
    await pages.close();
    const damaged = await open("workbench.html#s=AAAA");
    expect(await damaged.page.locator(".note").textContent()).toContain("damaged");
  });

  test("with a pixel budget shows the line that was run, with the distance to its box", async () => {
    const { page } = await open();
    await page.locator('input[name=budget][value="px"]').check({ force: true });
    await expect.poll(() => line(page)).toContain("--px 1 --view");
    await settled(page);
    const words = split((await line(page))!).slice(1);
    // The eye is farther than two radii from the centre of the ball, and one radius less from its box.
    expect(Number(/dist=([\d.]+)/.exec(words.join(" "))![1])).toBeGreaterThan(2);
    const outcome = await run(module, [...words, "--json"], { "bracket.star": text("sphere(1)") });
    const { certificate } = JSON.parse(outcome.stdout);
    expect([await digits(page, "bound"), await digits(page, "triangles")]).toEqual([certificate.bound.at_most, certificate.output.triangles]);
  });

  test("has drafts while a number is dragged, and options of one verb do not break the others", async () => {
    const { page } = await open(await small("r = param('r', 0.6)\nbox(2, 2, 1) - sphere(r)"));
    const slider = page.locator("#param-r");
    await slider.waitFor();
    const box = (await slider.boundingBox())!;
    await page.evaluate(() => {
      const seen = new Set<string>();
      Object.assign(window, { seen });
      const big = document.querySelector(".certificate .big")!;
      new MutationObserver(() => big.classList.contains("draft") && seen.add(document.querySelector(".certificate dl")!.textContent!)).observe(
        document.querySelector(".certificate")!, { subtree: true, childList: true, characterData: true, attributes: true },
      );
    });
    const drafts = () => page.evaluate(() => (window as unknown as { seen: Set<string> }).seen.size);
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    // A drag that never rests for longer than a tenth of a second, for six seconds or until there is a draft.
    for (let i = 0; i < 60 && (await drafts()) === 0; i++) {
      await page.mouse.move(box.x + box.width * (0.5 + 0.3 * Math.sin(i / 6)), box.y + box.height / 2);
      await page.waitForTimeout(100);
    }
    expect(await drafts()).toBeGreaterThan(0);
    await page.mouse.up();
    await settled(page);
    // `inspect` does not know this option, and is run without it.
    await page.locator(".options-more summary").click();
    await page.locator(".options-more input").fill("--keep-best");
    await page.keyboard.press("Enter");
    await expect.poll(() => line(page)).toContain("--keep-best");
    await settled(page);
    expect(await page.locator(".fault").allTextContents()).toEqual([]);
    expect(await slider.count()).toBe(1);
  });

  test("that takes long is cancelled, and the page keeps working", async () => {
    const { page } = await open();
    await page.locator(".budget input[type=text]").fill("0.0001%");
    await page.keyboard.press("Enter");
    await page.locator(".status").getByRole("button", { name: "Stop" }).click({ timeout: 20_000 });
    await expect.poll(() => page.locator(".note").textContent()).toContain("Stopped");
    await page.locator(".budget input[type=text]").fill("2%");
    await page.keyboard.press("Enter");
    await settled(page);
    expect(await line(page)).toContain("--tol 2%");
  });
});

describe("a file", () => {
  const SICK = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n";

  test("is opened, its defects are shown and repaired, and it is combined with another", async () => {
    const { page, errors } = await open();
    const picker = page.locator(".inputs input[type=file]");
    await picker.setInputFiles({ name: "sick.obj", mimeType: "text/plain", buffer: Buffer.from(SICK) });
    // Opened by itself, since there are defects.
    await page.locator(".findings").waitFor();
    expect(await page.locator(".findings").textContent()).toContain("3 boundary edges");
    await page.locator(".findings").getByRole("button", { name: "Show" }).click();
    await page.getByRole("button", { name: "Repair: fill holes" }).click();
    await expect.poll(() => page.locator(".findings").textContent()).toContain("sound");
    await settled(page);
    expect(await line(page)).toBe(
      "chordal mend sick.obj --fill-holes -o sick-mended.obj\nchordal mesh sick-mended.obj --tol 0.5% -o sick-mended.glb",
    );
    const block = await run(module, ["mesh", "b.star", "--tol", "1%", "-o", "b.stl"], { "b.star": text("move(box(1, 1, 1), 0.5, 0.5, 0.5)") });
    await panel(page, "change");
    const other = { name: "b.stl", mimeType: "model/stl", buffer: Buffer.from(block.outputs["b.stl"]!) };
    await page.locator(".steps-panel input[type=file]").setInputFiles(other);
    await page.locator('input[value="intersect"]').check({ force: true });
    await settled(page);
    expect(await line(page)).toContain("--intersect b.stl");
    // Two files have no link, and the link of the previous single file must not stay in the address.
    await expect.poll(() => page.evaluate(() => location.hash)).toBe("");
    expect(faults(errors)).toEqual([]);
  });

  test("is shown with its colours and pictures, beside its deviation and its shading cost", async () => {
    const { page, errors } = await open();
    const picker = page.locator(".inputs input[type=file]");
    await picker.setInputFiles(join(ROOT, "../tests/web/painted.gltf"));
    await expect.poll(() => line(page)).toContain("painted.gltf");
    await settled(page);
    // Among the saturated pixels, the shares of red and green: the file's picture and paint have both, ours have neither.
    const shot = await page.locator(".stage-column .scene").screenshot();
    const [red, green] = await page.evaluate(async (data) => {
      const image = await createImageBitmap(new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], { type: "image/png" }));
      const canvas = new OffscreenCanvas(image.width, image.height).getContext("2d")!;
      canvas.drawImage(image, 0, 0);
      const { data: dots } = canvas.getImageData(0, 0, image.width, image.height);
      const [counts, all] = [[0, 0], dots.length / 4];
      for (let i = 0; i < dots.length; i += 4) {
        for (const k of [0, 1]) if (dots[i + k]! > 2 * dots[i + 1 - k]! && dots[i + k]! > 2 * dots[i + 2]!) counts[k]! += 1 / all;
      }
      return counts;
    }, shot.toString("base64"));
    // The axes are less than a thousandth.
    expect(red).toBeGreaterThan(0.002);
    expect(green).toBeGreaterThan(0.002);
    await panel(page, "beside");
    const beside = async (what: string) => {
      await page.locator(`input[name=beside][value=${what}]`).check({ force: true });
      await page.locator(`[data-says=${what}]`).waitFor();
      return page.locator(`[data-says=${what}]`).textContent();
    };
    expect(await beside("distance")).toMatch(/0 to [\d.]+\. .* at least [\d.]+/);
    // Two nodes use the part with 189 triangles.
    expect(await beside("overshade")).toMatch(/^[\d.]+ GPU lanes per pixel; .* of 378 triangles/);
    expect(faults(errors)).toEqual([]);
  });

  test("that was opened during another's draft is not replaced by that draft", async () => {
    const { page } = await open("workbench.html");
    await page.locator("#param-width").focus();
    await page.keyboard.press("ArrowRight");
    const picker = page.locator(".inputs input[type=file]");
    await picker.setInputFiles({ name: "tetra.obj", mimeType: "text/plain", buffer: Buffer.from(`${SICK}f 1 4 3\n`) });
    await settled(page);
    await page.waitForTimeout(3000);
    expect(await digits(page, "triangles")).toBe(4);
  });

  test("that cannot be read gives one sentence", async () => {
    const { page } = await open();
    const picker = page.locator(".inputs input[type=file]");
    await picker.setInputFiles({ name: "a.stl", mimeType: "model/stl", buffer: Buffer.from("solid nothing") });
    await expect.poll(() => page.locator(".fault").textContent()).toMatch(/^Error: .{10,}/);
  });

  test("becomes an archive of tiles, even if one of them is large", async () => {
    const balls = "repeat(sphere(1), x=3, y=3, nx=3, ny=3)";
    const { page, errors } = await open(await small(balls));
    const files = unzipSync(await saved(page, "tiles"));
    const outcome = await run(module, ["lod", "bracket.star", "--px", "1", "-o", "tiles/"], { "bracket.star": text(balls) });
    expect(Object.keys(files).sort()).toEqual(Object.keys(outcome.outputs).sort());
    for (const [name, bytes] of Object.entries(outcome.outputs)) expect(Buffer.compare(files[name]!, bytes), name).toBe(0);
    // For larger files the library would use its own workers, which the page's policy blocks.
    expect(Math.max(...Object.values(files).map(({ length }) => length))).toBeGreaterThan(160_000);
    expect(faults(errors)).toEqual([]);
  });

  test("is baked into a field and meshed again, and has levels by distance", async () => {
    const { page } = await open();
    await write(page, "sphere(1)");
    await settled(page);
    await panel(page, "change");
    await page.getByRole("button", { name: "Build levels for one pixel" }).click();
    const slider = page.locator("#distance");
    await slider.waitFor();
    const shown = () => page.locator("#panel-change .panel", { has: slider }).textContent();
    await slider.focus();
    await page.keyboard.press("Home");
    await expect.poll(shown).toContain("level 1 of");
    await page.keyboard.press("End");
    await expect.poll(shown).not.toContain("level 1 of");
    await page.getByRole("button", { name: "Back to the mesh" }).click();
    await expect.poll(() => slider.count()).toBe(0);
    await page.getByLabel("Cells along the longest side").fill("24");
    await page.getByRole("button", { name: "Bake into a field" }).click();
    await expect.poll(() => line(page)).toContain("chordal bake bracket.star --cells 24 -o bracket.nrrd\nchordal mesh bracket.nrrd");
    await settled(page);
    expect(await page.locator(".certificate .proved").count()).toBe(1);
  });
});
