// Takes the screenshot of the page for the README: docs/pictures/studio.png.
//
//   node scripts/picture.mjs [FILE [ADDRESS [WIDTH [HEIGHT [SCHEME]]]]]
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { dirname, extname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const root = join(dirname(fileURLToPath(import.meta.url)), "..");
const [file = join(root, "../docs/pictures/studio.png"), address = "", width = "1120", height = "960", colorScheme = "light"] =
  process.argv.slice(2);
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css" };

const server = createServer(async (request, response) => {
  const name = new URL(request.url, "http://x").pathname.slice(1) || "index.html";
  response.setHeader("content-type", TYPES[extname(name)] ?? "application/octet-stream");
  response.end(await readFile(join(root, "dist/page", name)).catch(() => ""));
});
await new Promise((done) => server.listen(0, "127.0.0.1", done));
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--enable-unsafe-swiftshader"],
});
const full = height === "full";
const page = await browser.newPage({
  viewport: { width: Number(width), height: full ? 800 : Number(height) },
  colorScheme,
  locale: "en-GB",
});
await page.goto(`http://127.0.0.1:${server.address().port}/${address}`);
await page.waitForSelector("html[data-settled]");
await page.waitForTimeout(400);
await page.screenshot({ path: file, fullPage: full });
await browser.close();
server.close();
