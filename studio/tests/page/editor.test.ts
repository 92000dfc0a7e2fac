// The script editor in a browser, on a page of its own under the policy of the studio's pages.
import { execFileSync } from "node:child_process";
import { readFile } from "node:fs/promises";
import { extname, join } from "node:path";
import type { CDPSession, Page } from "playwright-core";
import { afterAll, beforeAll, expect, test } from "vitest";
import { build } from "vite";
import type { FunctionRow, ScriptEditor } from "../../src/workbench/editor";
import { ROOT, Site, isLong, axeFindings } from "./site";

declare global {
  var editor: ScriptEditor;
  var changes: [string, boolean][];
  var setTable: (rows: FunctionRow[], words: string[]) => Promise<void>;
}

const BLOCK = 'r = param("radius", 0.40)\nbox(20, 2, 1) - cylinder(r, -3) # 7 holes\n';
const BUILT = join(ROOT, "node_modules/.editor-page");
const TYPES: Record<string, string> = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css" };

interface Language {
  functions: (Omit<FunctionRow, "worth"> & { worth: string | null })[];
  constants: string[];
  keywords: string[];
}

let site: Site;
let rows: FunctionRow[];
let words: string[];

beforeAll(async () => {
  const root = join(ROOT, "tests/page/editor_page");
  await build({ root, configFile: false, base: "./", logLevel: "warn", build: { outDir: BUILT, emptyOutDir: true, target: "es2022", assetsInlineLimit: 0, modulePreload: false } });
  const json = execFileSync(process.env["CHORDAL"] ?? "chordal", ["language", "--json"], { encoding: "utf8" });
  const language = JSON.parse(json) as Language;
  rows = language.functions.map(({ name, usage, doc, worth }) => ({ name, usage, doc, ...(worth === null ? {} : { worth }) }));
  words = [...language.constants, ...language.keywords];
  site = await Site.open();
});

afterAll(() => site?.close());

async function open(text = BLOCK, options: Parameters<Site["visit"]>[1] & { query?: Record<string, string> } = {}): Promise<{ page: Page; errors: string[] }> {
  const { query = {}, ...rest } = options;
  const prepare = (page: Page) =>
    page.route("**/editor/**", async (route) => {
      const name = new URL(route.request().url()).pathname.split("/editor/")[1] || "index.html";
      await route.fulfill({ body: await readFile(join(BUILT, name)), contentType: TYPES[extname(name)] ?? "application/octet-stream" });
    });
  const visit = await site.visit(`editor/index.html?${new URLSearchParams({ text, ...query })}`, { ...rest, prepare });
  await visit.page.waitForFunction(() => "setTable" in window);
  await visit.page.evaluate(([table, known]) => setTable(table, known), [rows, words] as const);
  return visit;
}

const textOf = (page: Page) => page.evaluate(() => editor.text);
const changesOf = (page: Page) => page.evaluate(() => changes);
const content = (page: Page) => page.locator(".cm-content");
const numberOf = (page: Page, text: string) => page.locator(".cm-number", { hasText: text }).first();

/** Moves the cursor to a line and a column, both counted from 0. */
async function cursorTo(page: Page, line: number, column: number): Promise<void> {
  await content(page).focus();
  await page.keyboard.press("Control+Home");
  for (let k = 0; k < line; k += 1) await page.keyboard.press("ArrowDown");
  await page.keyboard.press("Home");
  for (let k = 0; k < column; k += 1) await page.keyboard.press("ArrowRight");
}

async function drag(page: Page, text: string, by: readonly number[], during: (k: number) => Promise<unknown> = async () => undefined): Promise<void> {
  const box = (await numberOf(page, text).boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (const [k, way] of by.entries()) {
    await page.mouse.move(x + way, y);
    await during(k);
  }
  await page.mouse.up();
}

test("its styles work under the pages' content security policy", async () => {
  const { page, errors } = await open();
  expect(await page.locator(".cm-scroller").evaluate((element) => getComputedStyle(element).display)).toBe("flex");
  expect(await numberOf(page, "20").evaluate((element) => getComputedStyle(element).cursor)).toBe("ew-resize");
  expect(await page.evaluate(() => document.querySelectorAll("style").length)).toBe(0);
  expect(await page.locator(".script-editor").evaluate((host) => [host.shadowRoot!.adoptedStyleSheets.length, host.shadowRoot!.querySelectorAll("style").length])).toEqual([1, 0]);
  await numberOf(page, "20").hover();
  expect(errors).toEqual([]);
});

test("a dragged number follows, notifies its page, and is one step of undo", async () => {
  const { page, errors } = await open();
  await drag(page, "20", [4, 10, 25, 24, 50]);
  const after = BLOCK.replace("20", "30");
  expect(await textOf(page)).toBe(after);
  const changes = await changesOf(page);
  expect(changes.map(([, isDragging]) => isDragging)).toEqual([...changes.slice(1).map(() => true), false]);
  expect(changes.at(-1)).toEqual([after, false]);
  expect(changes.slice(0, -1).map(([text]) => /box\((-?\d+)/.exec(text)![1])).toEqual(["22", "25", "30"]);
  await page.keyboard.press("Control+z");
  expect(await textOf(page)).toBe(BLOCK);
  await page.keyboard.press("Control+y");
  expect(await textOf(page)).toBe(after);
  // Typing before the drag is a step of its own, even directly before it at the same place.
  await page.keyboard.type("5");
  await drag(page, "305", [-50]);
  expect(await textOf(page)).toBe(BLOCK.replace("20", "295"));
  await page.keyboard.press("Control+z");
  await page.keyboard.press("Control+z");
  expect(await textOf(page)).toBe(after);
  expect(errors).toEqual([]);
});

test("Shift and Alt change the step during a drag, and decimals stay", async () => {
  const { page } = await open();
  await drag(page, "0.40", [25, 50, 75], async (k) => {
    if (k === 0) await page.keyboard.down("Shift");
    if (k === 1) await page.keyboard.up("Shift");
    if (k === 1) await page.keyboard.down("Alt");
    if (k === 2) await page.keyboard.up("Alt");
  });
  // Five steps of 0.01, five of 0.1, five of 0.001.
  expect(await textOf(page)).toBe(BLOCK.replace("0.40", "0.955"));
  await drag(page, "-3", [20]);
  expect(await textOf(page)).toContain("cylinder(r, 1)");
  await drag(page, "0.955", [25]);
  expect(await textOf(page)).toContain("0.960)");
});

test("a drag that is cancelled, or changes nothing, leaves no step of undo", async () => {
  const { page } = await open();
  await drag(page, "20", [50, 60], async (k) => k === 0 && page.keyboard.press("Escape"));
  expect(await textOf(page)).toBe(BLOCK);
  expect((await changesOf(page)).at(-1)).toEqual([BLOCK, false]);
  await drag(page, "20", [50, 0]);
  expect(await textOf(page)).toBe(BLOCK);
  expect((await changesOf(page)).at(-1)).toEqual([BLOCK, false]);
  await page.keyboard.press("Control+z");
  expect(await textOf(page)).toBe(BLOCK);
});

test("a click on a number sets the cursor, a double click selects it, and words are no handles", async () => {
  const { page } = await open();
  await numberOf(page, "20").click();
  await page.keyboard.press("Alt+ArrowUp");
  expect(await textOf(page)).toBe(BLOCK.replace("20", "21"));
  await numberOf(page, "21").dblclick();
  await page.keyboard.type("8");
  expect(await textOf(page)).toBe(BLOCK.replace("20", "8"));
  const all = await page.locator(".cm-number").allTextContents();
  expect(all).toEqual(["0.40", "8", "2", "1", "-3"]);
});

test("keys and buttons step the number at the cursor, and quick repetitions are one step of undo", async () => {
  const { page } = await open();
  await cursorTo(page, 1, 5);
  await page.keyboard.press("Alt+ArrowUp");
  await page.keyboard.press("Alt+ArrowUp");
  await page.keyboard.press("Shift+Alt+ArrowDown");
  expect(await textOf(page)).toBe(BLOCK.replace("20", "12"));
  await page.keyboard.press("Control+z");
  expect(await textOf(page)).toBe(BLOCK);
  await page.getByRole("button", { name: "One step more" }).click();
  expect(await textOf(page)).toBe(BLOCK.replace("20", "21"));
  expect(await page.locator(".cm-stepper code").textContent()).toBe("21");
  expect((await changesOf(page)).every(([, isDragging]) => !isDragging)).toBe(true);
});

test("a text set by the page does not notify it, keeps the cursor, and a slider's drag is one step of undo", async () => {
  const { page } = await open();
  await cursorTo(page, 1, 0);
  await page.evaluate(() => {
    for (const value of ["0.41", "0.5", "12"]) editor.setText(editor.text.replace(/0\.\d+/, value), true);
    editor.setText(editor.text.replace(/12/, "0.75"), false);
    // The same text again, as if a page answered a change with its own text.
    editor.setText(editor.text);
  });
  expect(await changesOf(page)).toEqual([]);
  await page.keyboard.type("#");
  const after = BLOCK.replace("0.40", "0.75");
  expect(await textOf(page)).toBe(after.replace("box", "#box"));
  await page.keyboard.press("Control+z");
  expect(await textOf(page)).toBe(after);
  await page.keyboard.press("Control+z");
  expect(await textOf(page)).toBe(BLOCK);
  await page.evaluate(() => editor.setText("sphere(1)\r\nbox(1, 1, 1)"));
  expect(await textOf(page)).toBe("sphere(1)\nbox(1, 1, 1)");
});

test("a finger drags a number horizontally, scrolls vertically, and may miss the number a little", async () => {
  const { page } = await open(BLOCK, { hasTouch: true, isMobile: true, viewport: { width: 360, height: 740 } });
  const client: CDPSession = await page.context().newCDPSession(page);
  const touch = (type: "touchStart" | "touchMove" | "touchEnd", x: number, y: number) =>
    client.send("Input.dispatchTouchEvent", { type, touchPoints: type === "touchEnd" ? [] : [{ x, y }] });
  const box = (await numberOf(page, "20").boundingBox())!;
  // Above the digits, within the reach of a finger.
  const [x, y] = [box.x + box.width / 2, box.y - 5];
  await touch("touchStart", x, y);
  for (const way of [10, 20, 30, 40, 50]) await touch("touchMove", x + way, y);
  await touch("touchEnd", 0, 0);
  expect(await textOf(page)).toBe(BLOCK.replace("20", "30"));
  expect((await changesOf(page)).at(-1)).toEqual([BLOCK.replace("20", "30"), false]);
  await touch("touchStart", x, y);
  for (const way of [10, 20, 30, 40, 50]) await touch("touchMove", x + 1, y + way);
  await touch("touchEnd", 0, 0);
  expect(await textOf(page)).toBe(BLOCK.replace("20", "30"));
  const height = await page.locator(".cm-number").first().evaluate((element) => Number.parseFloat(getComputedStyle(element, "::after").height));
  // Without the border of one pixel.
  expect(height).toBeGreaterThanOrEqual(43);
});

test("names are completed from the table, with usage and description", async () => {
  const { page } = await open("");
  await content(page).focus();
  await page.keyboard.type("gyr");
  const option = page.getByRole("option", { name: /^gyroid/ });
  await option.waitFor();
  expect(await option.textContent()).toBe("gyroid(period, level=0)");
  await page.locator(".cm-completionInfo").waitFor();
  expect(await page.locator(".cm-completionInfo").textContent()).toContain("The infinite solid on one side of the gyroid; shell() turns it into a wall. The value is: lower bound.");
  // CodeMirror ignores Enter within 75 ms after it opened the list and inserts a line instead, which is undone.
  const enter = async () => {
    await page.keyboard.press("Enter");
    const text = await textOf(page);
    if (text !== "gyr\n") return text;
    await page.keyboard.press("Backspace");
    await page.keyboard.press("Control+Space");
    await option.waitFor();
    return text;
  };
  await expect.poll(enter, { interval: 200 }).toBe("gyroid()");
  // Within the parentheses, the function's parameters come first.
  await page.keyboard.press("Control+Space");
  await page.getByRole("option").first().waitFor();
  expect(await page.getByRole("option").first().textContent()).toBe("period=parameter");
  expect(await page.locator(".cm-help b").textContent()).toBe("period");
  await page.keyboard.press("Escape");
  await page.keyboard.type("2, ");
  expect(await page.locator(".cm-help b").textContent()).toBe("level=0");
  // Not in strings, comments and numbers.
  for (const text of ['"gyr', "# gyr", "12"]) {
    await page.evaluate(() => editor.setText(""));
    await page.keyboard.type(text);
    await page.keyboard.press("Control+Space");
    await page.evaluate(() => new Promise((done) => setTimeout(done, 150)));
    expect(await page.getByRole("option").count(), text).toBe(0);
  }
});

test("a name is explained under the pointer and at the cursor", async () => {
  const { page } = await open();
  await page.getByText("cylinder").hover();
  await page.locator(".cm-tooltip-hover").waitFor();
  expect(await page.locator(".cm-tooltip-hover").textContent()).toBe("cylinder(radius, height)A cylinder along the z axis, centred on the origin. The value is: exact distance.");
  await cursorTo(page, 1, 1);
  expect(await page.locator(".cm-help").textContent()).toContain("A box with the side lengths x, y and z, centred on the origin.");
});

test("an error is marked at its place, and is reached and read without a mouse", async () => {
  const { page } = await open("a = 1\né = box(1, a)\n");
  await page.evaluate(() => editor.setErrors([{ line: 2, column: 5, message: "box() needs 'z'" }]));
  expect(await page.locator(".cm-problem").textContent()).toBe("box");
  expect(await page.locator(".cm-problemLine").textContent()).toBe("2");
  expect(await page.getByRole("status").textContent()).toBe("Line 2box() needs 'z'");
  expect(await content(page).getAttribute("aria-invalid")).toBe("true");
  await content(page).focus();
  await page.keyboard.press("F8");
  await page.keyboard.type("rounded_");
  expect(await textOf(page)).toBe("a = 1\né = rounded_box(1, a)\n");
  expect(await page.locator(".cm-problem").textContent()).toBe("box");
  await page.evaluate(() => editor.setErrors([]));
  expect(await page.getByRole("status").textContent()).toBe("");
  expect(await content(page).getAttribute("aria-invalid")).toBe("false");
  // Places that the new text does not have.
  for (const error of [{ line: 99, column: 99 }, { line: 0 }, { line: 1, column: 6 }, { line: 3 }]) {
    await page.evaluate((place) => editor.setErrors([{ ...place, message: "?" }]), error);
    expect(await page.getByRole("status").textContent()).toMatch(/^Line \d\?$/);
  }
});

test("it has a name, Tab leaves it, and axe finds nothing, in both languages and themes", async () => {
  for (const lang of ["en", "zh"]) {
    for (const theme of ["light", "dark"]) {
      // In `make test` each language has one theme.
      if (!isLong && (lang === "en") !== (theme === "light")) continue;
      const { page, errors } = await open(BLOCK, { query: { lang, theme }, viewport: { width: 360, height: 740 } });
      const field = page.getByRole("textbox", { name: lang === "zh" ? "脚本" : "Script" });
      await page.locator("#before").focus();
      await page.keyboard.press("Tab");
      expect(await field.evaluate((element) => (element.getRootNode() as ShadowRoot).activeElement === element)).toBe(true);
      await cursorTo(page, 0, 22);
      await page.evaluate(() => editor.setErrors([{ line: 2, column: 18, message: "cylinder() needs a number" }]));
      await page.keyboard.press("Control+Space");
      expect(await axeFindings(page)).toEqual([]);
      for (let k = 0; k < 4; k += 1) await page.keyboard.press("Tab");
      expect(await page.evaluate(() => document.activeElement?.id)).toBe("after");
      expect(errors).toEqual([]);
      await page.context().close();
    }
  }
});

test("dispose removes everything", async () => {
  const { page } = await open();
  await page.evaluate(() => editor.dispose());
  expect(await page.evaluate(() => document.getElementById("place")!.childElementCount)).toBe(0);
});
