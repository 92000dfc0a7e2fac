// The workbench's shelf, what it asks for in place, exports of the proved mesh, and files that carry their script.
import { mkdtempSync, readFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, describe, expect, test, vi } from "vitest";
import { run } from "../../src/core/command";
import { ROOT, Site, digits, settled } from "./site";
import { PATIENCE, Workbenches, commandModule, faults, line, panel, small, text, write } from "./workbench_page";

vi.setConfig(PATIENCE);

const folder = mkdtempSync(join(tmpdir(), "chordal-shelf-"));
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

async function saved(page: Page, act: () => Promise<unknown>): Promise<{ name: string; bytes: Buffer }> {
  const [download] = await Promise.all([page.waitForEvent("download"), act()]);
  const path = join(folder, download.suggestedFilename());
  await download.saveAs(path);
  return { name: download.suggestedFilename(), bytes: readFileSync(path) };
}

const script = (page: Page) => page.locator(".cm-content").textContent();
const names = (page: Page) => page.locator(".shelf-title b").allTextContents();

describe("the shelf", () => {
  test("keeps a script under its name, through changes, a reload, a copy, and a deletion that is undone", async () => {
    const { page, errors } = await pages.open();
    // Without a picker of files, saving is a download.
    await page.evaluate(() => delete (window as { showSaveFilePicker?: unknown }).showSaveFilePicker);
    expect(await page.locator(".shelf-place").textContent()).toContain("Not kept");
    await page.locator("[data-shelf=keep]").click();
    const name = page.getByLabel("Name", { exact: true });
    await name.fill("my ball");
    await name.press("Enter");
    expect(await page.locator(".certificate .proved").count(), "nothing is proved again for a name").toBe(1);
    await write(page, "sphere(3)");
    await settled(page);
    expect(await page.locator(".shelf-place").textContent()).toContain("changes that no file has");
    const file = await saved(page, () => page.keyboard.press("Control+s"));
    expect([file.name, file.bytes.toString()]).toEqual(["my ball.star", "sphere(3)"]);
    await expect.poll(() => page.locator(".shelf-place").textContent()).toContain("Saved to a file");
    await write(page, "sphere(4)");
    await settled(page);
    await page.goto(page.url().replace(/#.*/, ""));
    await page.waitForSelector("html[data-ready]");
    await expect.poll(() => script(page)).toContain("sphere(4)");
    expect(await page.getByLabel("Name", { exact: true }).inputValue()).toBe("my ball");
    await page.locator("[data-shelf=open]").click();
    await page.getByRole("button", { name: "Duplicate my ball" }).click();
    await expect.poll(() => names(page)).toEqual(["my ball 2", "my ball"]);
    await page.getByRole("button", { name: "Delete my ball", exact: true }).click();
    await expect.poll(() => names(page)).toEqual(["my ball 2"]);
    await page.locator("[data-shelf=restore]").click();
    await expect.poll(() => names(page)).toEqual(["my ball 2", "my ball"]);
    await page.keyboard.press("Escape");
    expect(await page.locator("dialog[open]").count()).toBe(0);
    expect(faults(errors)).toEqual([]);
  });

  test("keeps a name that is being typed while the page is drawn anew", async () => {
    const { page } = await pages.open();
    await page.locator("[data-shelf=keep]").click();
    const name = page.getByLabel("Name", { exact: true });
    await name.click();
    await name.fill("half a na");
    // Every step of a run draws the page anew, as does a turn of the picture.
    const before = await page.locator(".triad").innerHTML();
    await page.locator(".scene").evaluate((scene) => {
      for (const deltaY of [100, -300]) scene.dispatchEvent(new WheelEvent("wheel", { deltaY, clientX: 900, clientY: 400 }));
      for (const key of ["5", "7"]) scene.dispatchEvent(new KeyboardEvent("keydown", { key }));
    });
    await expect.poll(() => page.locator(".triad").innerHTML()).not.toBe(before);
    expect(await name.inputValue()).toBe("half a na");
    await name.press("End");
    await name.pressSequentially("me");
    await name.press("Enter");
    await expect.poll(() => line(page)).toContain("'half a name.star'");
    // What was not entered is dropped by Escape.
    await name.fill("another");
    await name.press("Escape");
    expect(await name.inputValue()).toBe("half a name");
  });

  test("is not changed by a script from an address, and shows all examples with pictures", async () => {
    const { page } = await pages.open();
    await page.locator("[data-shelf=keep]").click();
    await page.goto(page.url().replace(/#.*/, "").replace(/workbench.*/, await small("box(1, 2, 3)")));
    await page.reload();
    await page.waitForSelector("html[data-ready]");
    await expect.poll(() => script(page)).toContain("box(1, 2, 3)");
    await write(page, "box(3, 2, 1)");
    await settled(page);
    await page.locator("[data-shelf=open]").click();
    await page.locator(".shelf-title").first().click();
    await expect.poll(() => script(page)).toContain("sphere(1)");
    await page.locator("[data-shelf=open]").click();
    const pictures = page.locator(".shelf-examples img");
    expect(await pictures.count()).toBe(13);
    await pictures.last().scrollIntoViewIfNeeded();
    await expect.poll(() => pictures.evaluateAll((all) => all.every((one) => (one as HTMLImageElement).naturalWidth === 240))).toBe(true);
    await page.locator("[data-example=block]").click();
    await expect.poll(() => script(page)).toContain("A drilled block");
    expect(await page.locator("[data-shelf=keep]").count()).toBe(1);
  });

  test("is not needed for the script that was changed last, which is there again without an address", async () => {
    const { page } = await pages.open();
    await write(page, "box(7, 1, 1)");
    await settled(page);
    expect(await page.locator(".shelf-place").textContent()).toContain("the next script replaces it");
    await page.goto("about:blank");
    await page.goto(`${site.base}workbench.html`);
    await page.waitForSelector("html[data-ready]");
    await expect.poll(() => script(page)).toBe("box(7, 1, 1)");
    // An address comes before it.
    await page.goto("about:blank");
    await page.goto(site.base + (await small("sphere(2)")));
    await page.waitForSelector("html[data-ready]");
    await expect.poll(() => script(page)).toBe("sphere(2)");
  });

  test("says so if the browser keeps nothing", async () => {
    const visit = await site.visit(await small(), {
      prepare: (page) => page.addInitScript(() => Object.defineProperty(window, "localStorage", { get: () => { throw new DOMException("no", "SecurityError"); } })),
    });
    await visit.page.waitForSelector("html[data-ready]");
    expect(await visit.page.locator(".shelf-bar .fault").textContent()).toContain("does not let the page keep anything");
    await visit.page.context().close();
  });
});

describe("an export", () => {
  test("is the mesh that was proved, in every format, named after the script, and a failure is a sentence", async () => {
    const { page } = await pages.open(await small("box(2, 2, 1) - cylinder(0.5, 2)"));
    await panel(page, "export");
    const glb = await saved(page, () => page.locator("[data-export=glb]").click());
    expect(glb.name).toBe("bracket.glb");
    const files: Record<string, Uint8Array> = { "bracket.glb": glb.bytes };
    for (const format of ["3mf", "stl", "ply", "obj"]) {
      const { name, bytes } = await saved(page, () => page.locator(`[data-export="${format}"]`).click());
      expect(name).toBe(`bracket.${format}`);
      await expect.poll(() => page.locator(".export [role=status]").first().textContent()).toContain(`bracket.${format}: `);
      files[name] = bytes;
    }
    const facts = async (name: string) => {
      const { stdout } = await run(module, ["inspect", name, "--json"], files);
      const { inspection, certificate } = JSON.parse(stdout);
      return { box: inspection.box, triangles: certificate.output.triangles, found: inspection.found?.certificate };
    };
    const first = await facts("bracket.glb");
    expect(first.triangles).toBe(await digits(page, "triangles"));
    for (const format of ["3mf", "stl", "ply", "obj"]) {
      const { box, triangles, found } = await facts(`bracket.${format}`);
      expect([box, triangles], format).toEqual([first.box, first.triangles]);
      // The certificate is that of the mesh, if the format can hold one.
      if (format !== "stl") expect(found.bound, format).toEqual(first.found.bound);
    }
    // An option that only tiles have is for them; the mesh is made without it, and the page says so.
    const options = page.locator(".options-more input");
    await page.locator(".options-more summary").click();
    await options.fill("--at 47,8");
    await options.press("Enter");
    await settled(page);
    expect(await page.locator(".messages").textContent()).toContain("--at is no option of a mesh");
    const tiles = await saved(page, () => page.locator("[data-export=tiles]").click());
    expect([tiles.name, tiles.bytes.subarray(0, 2).toString()]).toEqual(["bracket-tiles.zip", "PK"]);
    // A run that fails ends with a sentence and without a file, whatever it has written until then.
    let count = 0;
    page.on("download", () => (count += 1));
    await options.fill("--at 470,8");
    await options.press("Enter");
    await settled(page);
    await page.locator("[data-export=tiles]").click();
    await expect.poll(() => page.locator(".export .fault").textContent()).toMatch(/bracket-tiles\.zip was not written\. .*470/);
    expect(count).toBe(0);
  });
});

describe("a file", () => {
  test("that carries its script is opened as that, proved again, and can be shown itself", async () => {
    const source = "r = param('r', 0.4)\nbox(2, 2, 1) - cylinder(r, 2)\n";
    const words = ["mesh", "plate.star", "--set", "r=0.5", "--tol", "1%"];
    const made = await run(module, [...words, "-o", "plate.glb"], { "plate.star": text(source) });
    const again = await run(module, ["convert", "plate.glb", "plate.3mf", "--keep-certificate"], made.outputs);
    expect([made.exit, again.exit, again.stderr]).toEqual([0, 0, ""]);
    const { page, errors } = await pages.open();
    for (const [name, bytes] of Object.entries({ ...made.outputs, ...again.outputs })) {
      await page.locator(".inputs input[type=file]").setInputFiles({ name, mimeType: "", buffer: Buffer.from(bytes) });
      await expect.poll(() => page.locator(".carried").textContent()).toContain(`${name} carries its script`);
      await expect.poll(() => page.locator(".carried").textContent()).toContain("Every claim of the file was proved again");
      await settled(page);
      expect(await script(page)).toContain("box(2, 2, 1)");
      expect(await line(page)).toMatch(/^chordal mesh plate\.star --set r=0\.5 --tol 0\.0/);
    }
    await page.getByRole("button", { name: "Show plate.3mf itself" }).click();
    await settled(page);
    expect(await line(page)).toContain("chordal mesh plate.3mf");
    expect(faults(errors)).toEqual([]);
  });

  test("that a script reads is asked for in place, and so are a text and a height", async () => {
    const { page } = await pages.open(await small('mesh("part.stl")'));
    await expect.poll(() => page.locator(".ask").textContent()).toContain("part.stl");
    const { outputs } = await run(module, ["mesh", "a.star", "--tol", "1%", "-o", "a.stl"], { "a.star": text("box(1, 2, 3)") });
    await page.locator(".ask input[type=file]").setInputFiles({ name: "other.stl", mimeType: "", buffer: Buffer.from(outputs["a.stl"]!) });
    await settled(page);
    expect(await page.locator(".ask, .fault").count()).toBe(0);
    expect(await digits(page, "triangles")).toBeGreaterThan(0);
    await page.locator(".inputs input[type=file]").setInputFiles({
      name: "square.svg",
      mimeType: "image/svg+xml",
      buffer: Buffer.from('<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0H10V10H0Z"/></svg>'),
    });
    await page.locator("[data-ask=raise]").click();
    await settled(page);
    expect(await line(page)).toContain("--extrude 1");
  });

  test("that a kept script was given is there after a reload, and may be dropped", async () => {
    const { page } = await pages.open(await small('extrude(text("HI", "font.ttf", 0.01), 1)'));
    await page.locator(".ask").waitFor();
    await page.locator("[data-shelf=keep]").click();
    // The field of the files that are opened, which a drop fills as well: the font has another name.
    await page.locator(".inputs input[type=file][multiple]").setInputFiles(join(ROOT, "../tests/parts/block.ttf"));
    await settled(page);
    expect([await page.locator(".ask, .fault").count(), await script(page)]).toEqual([0, 'extrude(text("HI", "font.ttf", 0.01), 1)']);
    const before = await digits(page, "triangles");
    await page.reload();
    await page.waitForSelector("html[data-ready]");
    await settled(page);
    expect([await page.locator(".ask, .fault").count(), await digits(page, "triangles")]).toEqual([0, before]);
  });

  test("of samples has a slider for its level, with the range of the values", async () => {
    const { outputs } = await run(module, ["bake", "a.star", "--cells", "16", "-o", "a.nrrd"], { "a.star": text("sphere(1)") });
    const { page } = await pages.open();
    await page.locator(".inputs input[type=file]").setInputFiles({ name: "a.nrrd", mimeType: "", buffer: Buffer.from(outputs["a.nrrd"]!) });
    const slider = page.locator("#iso");
    await slider.waitFor();
    expect(await page.locator(".ask").textContent()).toMatch(/The samples are from .+ to .+\. Suggested: 0\./);
    await settled(page);
    await slider.focus();
    await page.keyboard.press("ArrowRight");
    await settled(page);
    expect(await line(page)).toMatch(/--iso 0\.\d+/);
  });
});

test("parts that only touch are named with their place, their lines and a cure", async () => {
  const { page } = await pages.open(await small("a = sphere(1)\nb = move(sphere(1), 2, 0, 0)\na | b"));
  const finding = page.locator(".touching");
  await finding.waitFor();
  expect(await finding.textContent()).toMatch(/Parts made in lines 1 and 2 touch at \(1, 0, 0\) without overlapping\. Let them overlap/);
  await finding.locator("[data-go]").click();
});
