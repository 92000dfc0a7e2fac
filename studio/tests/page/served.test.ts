// The page as served by `chordal studio`, and its size.
import { spawn, spawnSync, type ChildProcess } from "node:child_process";
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import { afterAll, beforeAll, expect, test } from "vitest";
import { Core } from "../../src/core/module";
import type { Cubic } from "../../src/core/types";
import { hasOwnModules } from "./bytes";
import { DIST, Site, WASM } from "./site";

const command = process.env["CHORDAL"] ?? join(DIST, "../../../target/release/chordal");
let site: Site;
let studio: ChildProcess;
let link: string;

beforeAll(async () => {
  site = await Site.open();
  studio = spawn(command, ["studio"], { stdio: ["ignore", "pipe", "inherit"] });
  link = await new Promise((found, failed) => {
    let output = "";
    studio.stdout!.on("data", (text) => {
      output += text;
      const url = /http:\S+/.exec(output);
      if (url && output.includes("\n")) found(url[0]);
    });
    studio.on("error", failed);
    studio.on("exit", (code) => failed(new Error(`chordal studio ended with ${code}`)));
  });
});
afterAll(async () => {
  studio?.kill();
  await site?.close();
});

test("the link opens the page, which runs under the server's strict policy; it works once", async () => {
  const context = await site.browser.newContext({ locale: "en-GB" });
  const page = await context.newPage();
  const errors: string[] = [];
  page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  page.on("pageerror", (error) => errors.push(String(error)));
  const response = (await page.goto(link))!;
  expect(response.headers()["content-security-policy"]).toContain("default-src 'none'");
  expect(page.url()).toBe(new URL("/lesson.html", link).href);
  await page.waitForSelector("html[data-ready]");
  expect(await page.locator("h1").textContent()).toContain("teapot");
  expect(errors).toEqual([]);
  expect(await page.evaluate(() => document.cookie), "scripts do not see the cookie").toBe("");
  // Pages served with no-store are not cached: they are only for the holder of the cookie, while the command runs.
  expect(await page.evaluate(async () => (await fetch("service-worker.js")).headers.get("cache-control"))).toBe("no-store");
  expect(await page.evaluate(async () => (await navigator.serviceWorker.getRegistrations()).length)).toBe(0);
  await page.reload();
  await page.waitForSelector("html[data-ready]");
  await page.goto(new URL("/quad.html", link).href);
  await page.waitForSelector('html[data-settled] .scene[data-viewer="webgl"]');
  await page.goto(new URL("/exhibits.zh.html", link).href);
  expect(await page.locator(".cards a").count()).toBeGreaterThan(6);
  expect(errors).toEqual([]);

  const stranger = await site.browser.newContext();
  expect((await (await stranger.newPage()).goto(link))!.status()).toBe(403);
  expect((await stranger.request.get(new URL("/", link).href)).status()).toBe(403);
  await context.close();
  await stranger.close();
});

test("the page's module and the command give the same points, bit for bit", async () => {
  const core = await Core.load(readFileSync(WASM));
  const seed = 1 + Math.floor(Math.random() * 1e9);
  let state = seed;
  const random = () => (state = (state * 48271) % 2147483647) / 2147483647;
  const folder = mkdtempSync(join(tmpdir(), "chordal-studio-"));
  for (let i = 0; i < 12; i++) {
    const control = Array.from({ length: 4 }, () => [random() * 10, random() * 6]) as unknown as Cubic;
    const segments = 1 + Math.floor(random() * 128);
    const file = join(folder, "curve.svg");
    const [a, b, c, d] = control.map((point) => point.join(" "));
    writeFileSync(file, `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 6"><path fill="none" d="M${a}C${b} ${c} ${d}"/></svg>`);
    const answer = core.ask("study", { control, segments, other: segments, pixels_per_unit: 70, pixels: 1, t: 0, near: 1 });
    for (const spacing of ["even", "fewest"] as const) {
      const run = spawnSync(command, ["mesh", file, "--segments", String(segments), "--spacing", spacing, "-o", "-", "--to", "json", "-q"]);
      const mesh = JSON.parse(run.stdout.toString());
      expect(mesh.polylines[0].points, `seed ${seed}`).toEqual(answer[spacing].points);
      expect(mesh.report.certificate.bound.at_most, `seed ${seed}`).toBe(answer[spacing].bound.at_most);
    }
  }
  rmSync(folder, { recursive: true });
});

// The wheel contains them, beside twice as much, and has at most 20 MB: modules that share much are to be one.
test("all pages together weigh less than ten megabytes, compressed, without the command", () => {
  const entries = readdirSync(DIST, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
  // Only the workbench loads the command.
  const files = entries.filter(({ name }) => !/^command-.*\.wasm$/.test(name));
  expect(entries.length - files.length).toBe(1);
  const weight = (path: string) => gzipSync(readFileSync(path), { level: 9 }).length;
  const all = files.reduce((sum, entry) => sum + weight(join(entry.parentPath, entry.name)), 0);
  console.log(`all pages: ${files.length} files, ${Math.round(all / 1000)} kB compressed`);
  // The tests have one module of exhibits, which every page shares; the pages have one for each kind of question.
  expect(all).toBeLessThan(hasOwnModules ? 9_500_000 : 8_000_000);
});

test("the page asks no other host for anything", () => {
  const all: string[] = [];
  for (const entry of readdirSync(DIST, { recursive: true, withFileTypes: true })) {
    if (!/\.(html|js|css)$/.test(entry.name)) continue;
    const text = readFileSync(join(entry.parentPath, entry.name), "utf8");
    const hosts = [...text.matchAll(/https?:\/\/([\w.-]+)/g)].map((match) => match[1]);
    // The names of the SVG and MathML vocabularies look like addresses, but are not fetched.
    all.push(...hosts.map(String));
    expect(hosts.filter((host) => host !== "www.w3.org"), entry.name).toEqual([]);
    // A library checks whether this exists; it is never fetched.
    expect(text).not.toMatch(/new SharedArrayBuffer/);
  }
  // Addresses are seen where there are some.
  expect(all.length).toBeGreaterThan(50);
});
