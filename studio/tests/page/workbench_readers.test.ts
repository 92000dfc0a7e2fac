// The workbench for every reader: without script, on a phone, in both languages, in dark and light.
import { afterAll, afterEach, beforeAll, expect, test, vi } from "vitest";
import { Site, axeFindings, isLong, settled } from "./site";
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

test.each([
  ["workbench.html", "needs JavaScript and WebAssembly"],
  ["workbench.zh.html", "需要 JavaScript 和 WebAssembly"],
])("%s without script says what it needs, and the line that does the same", async (file, words) => {
  const { page } = await site.visit(file, { javaScriptEnabled: false });
  const note = page.locator("noscript .note");
  expect(await note.isVisible()).toBe(true);
  expect(await note.textContent()).toContain(words);
  expect(await note.locator("code[lang=en]").textContent()).toBe("chordal mesh bracket.star --tol 0.5% -o bracket.glb");
  await page.context().close();
  // With script there is no such note; in `make test` only in one language.
  if (!isLong && file.includes(".zh")) return;
  const live = await pages.open(await small("sphere(1)", file.includes(".zh") ? ".zh" : ""));
  expect(await live.page.locator("noscript").count()).toBe(0);
});

/** A tetrahedron without a face, and an unused vertex. */
const SICK = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 5 5 5\nf 1 3 2\nf 1 2 4\nf 2 3 4\n";

/** Each language and each theme once; in `make test-long` every pair. */
const LOOKS = [
  ["workbench.html", "light", 1366],
  ["workbench.zh.html", "dark", 360],
  ["workbench.html", "dark", 360],
  ["workbench.zh.html", "light", 1366],
] as const;

const looks = LOOKS.slice(0, isLong ? 4 : 2);
test.each(looks)("%s fits and has no findings, %s and %i wide", async (file, colorScheme, width) => {
  const { page, errors } = await pages.open(file, { colorScheme, viewport: { width, height: 768 } });
  const fits = () => page.evaluate(() => document.documentElement.scrollWidth);
  expect(await fits()).toBeLessThanOrEqual(width);
  expect(await axeFindings(page)).toEqual([]);
  // Parts that only a file has: findings, repairs, and another picture beside the mesh.
  const picker = page.locator(".inputs input[type=file]");
  await picker.setInputFiles({ name: "sick.obj", mimeType: "text/plain", buffer: Buffer.from(SICK) });
  await page.locator('[data-panel="findings"]').waitFor();
  for (const name of ["findings", "beside", "change", "export", "certificate", "input"] as const) {
    await panel(page, name);
    await settled(page);
    expect(await fits()).toBeLessThanOrEqual(width);
    expect(await axeFindings(page), name).toEqual([]);
  }
  expect(faults(errors)).toEqual([]);
});

test("findings are in the page's language, and English texts are marked", async () => {
  const { page } = await pages.open(await small("sphere(1)", ".zh"));
  const picker = page.locator(".inputs input[type=file]");
  await picker.setInputFiles({ name: "sick.obj", mimeType: "text/plain", buffer: Buffer.from(SICK) });
  await page.locator(".findings li").nth(1).waitFor();
  const findings = await page.locator(".findings").textContent();
  const sentences = ["3 条边界边", "曲面到此为止", "显示 3 处", "修复：补孔", "1 个未使用的顶点"];
  expect(sentences.filter((words) => !findings!.includes(words))).toEqual([]);
  // Latin letters must be marked as English, or be code in a sentence.
  const unmarked = await page.locator(".findings").evaluate((panel) => {
    const copy = panel.cloneNode(true) as Element;
    for (const marked of copy.querySelectorAll("[lang=en]")) marked.remove();
    return copy.textContent!.replace(/`[^`]*`/g, "");
  });
  expect(unmarked).not.toMatch(/[A-Za-z]{2,}/);
  // A sentence that has no translation, after what its code says.
  await picker.setInputFiles({ name: "a.npy", mimeType: "application/octet-stream", buffer: Buffer.from("nothing") });
  const fault = page.locator("p.fault [lang=en]");
  await expect.poll(() => fault.textContent()).toMatch(/\w{4,}/);
  expect(await page.locator("p.fault").textContent()).toContain("错误： 文件开头的标记不对。");
});

test("a mistake in a script is reported in the page's language, also in the editor", async () => {
  const { page } = await pages.open(await small("sphere(1)", ".zh"));
  await write(page, "box(1, 2");
  await expect.poll(() => page.locator(".cm-problemText").first().textContent()).toContain("语法错误：这里应为符号“)”");
  expect(await page.locator("p.fault").textContent()).toContain("第 1 行： 语法错误：");
  expect(await page.locator(".cm-problemText[lang], p.fault [lang]").count()).toBe(0);
  // The script's own words stay as they are, in their language.
  await write(page, 'fail("it hums")');
  await expect.poll(() => page.locator(".cm-problemText[lang=en]").first().textContent()).toBe("it hums");
  await write(page, 'fail("太薄")');
  await expect.poll(() => page.locator(".cm-problemText").first().textContent()).toBe("太薄");
  expect(await page.locator(".cm-problemText[lang]").count()).toBe(0);
});
