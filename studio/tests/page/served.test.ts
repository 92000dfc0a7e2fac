// The page as `chordal studio` serves it, and what it weighs.
import { spawn, type ChildProcess } from "node:child_process";
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import { afterAll, beforeAll, expect, test } from "vitest";
import { DIST, Site, settled } from "./site";

const command = process.env["CHORDAL"] ?? join(DIST, "../../../target/release/chordal");
let site: Site;
let studio: ChildProcess;
let link: string;

beforeAll(async () => {
  site = await Site.open();
  studio = spawn(command, ["studio"], { stdio: ["ignore", "pipe", "inherit"] });
  link = await new Promise((found, failed) => {
    let said = "";
    studio.stdout!.on("data", (text) => {
      said += text;
      const url = /http:\S+/.exec(said);
      if (url && said.includes("\n")) found(url[0]);
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
  expect(page.url()).toBe(new URL("/", link).href);
  await page.waitForSelector("html[data-ready]");
  await settled(page);
  expect(await page.locator(".headline").textContent()).toContain("6 segments");
  expect(errors).toEqual([]);
  expect(await page.evaluate(() => document.cookie), "scripts do not see the cookie").toBe("");
  await page.reload();
  await page.waitForSelector("html[data-ready]");

  const stranger = await site.browser.newContext();
  expect((await (await stranger.newPage()).goto(link))!.status()).toBe(403);
  expect((await stranger.request.get(new URL("/", link).href)).status()).toBe(403);
  await context.close();
  await stranger.close();
});

test("the page weighs less than a megabyte, compressed, all files together", () => {
  const files = readdirSync(DIST, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
  const sizes = files.map((entry) => gzipSync(readFileSync(join(entry.parentPath, entry.name)), { level: 9 }).length);
  const all = sizes.reduce((sum, size) => sum + size, 0);
  console.log(`the page: ${files.length} files, ${Math.round(all / 1000)} kB compressed`);
  expect(files.length).toBe(6);
  expect(all).toBeLessThan(1_000_000);
});

test("the page asks no other host for anything", () => {
  for (const entry of readdirSync(DIST, { recursive: true, withFileTypes: true })) {
    if (!/\.(html|js|css)$/.test(entry.name)) continue;
    const text = readFileSync(join(entry.parentPath, entry.name), "utf8");
    const hosts = [...text.matchAll(/https?:\/\/([\w.-]+)/g)].map((match) => match[1]);
    // The names of the SVG and MathML vocabularies look like addresses and are none.
    expect(hosts.filter((host) => host !== "www.w3.org"), entry.name).toEqual([]);
    expect(text).not.toContain("SharedArrayBuffer");
  }
});
