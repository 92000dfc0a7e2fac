// Serves folders on loopback and opens a page of them in Chromium, which may request nothing else.
import { existsSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { chromium } from "playwright-core";

const TYPES = {
  ".html": "text/html",
  ".js": "text/javascript",
  ".mjs": "text/javascript",
  ".json": "application/json",
  ".glb": "model/gltf-binary",
  ".wasm": "application/wasm",
  ".css": "text/css",
};
const FLAGS = [
  "--headless",
  "--no-sandbox",
  "--disable-gpu",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--enable-unsafe-swiftshader",
];

/** Serves folders on loopback: `{ "/prefix/": "folder" }`. `changed` may change the body of a file. */
async function serve(folders, changed) {
  const server = createServer(async (request, response) => {
    const path = decodeURIComponent(new URL(request.url, "http://x").pathname);
    const prefix = Object.keys(folders).find((prefix) => path.startsWith(prefix));
    try {
      const file = normalize(join(folders[prefix], path.slice(prefix.length)));
      if (!file.startsWith(normalize(folders[prefix]))) throw new Error("outside");
      response.setHeader("content-type", TYPES[extname(file)] ?? "application/octet-stream");
      response.end(changed(await readFile(file), file));
    } catch {
      response.statusCode = 404;
      response.end();
    }
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  return server;
}

/**
 * Opens a page of these folders and passes it to `look`. Returns complaints: the page's errors, and its requests to other
 * hosts.
 *
 * @param options.folders the folders that are served
 * @param options.address the address of the page
 * @param options.viewport its width and height
 * @param options.changed maps a file's body to the one that is served
 */
export async function withPage({ folders, address, viewport, changed = (body) => body }, look) {
  const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
  if (!existsSync(executablePath)) throw new Error(`there is no chromium at ${executablePath}`);
  const server = await serve(folders, changed);
  const browser = await chromium.launch({ executablePath, args: FLAGS });
  const complaints = [];
  try {
    const page = await browser.newPage({ viewport, deviceScaleFactor: 1 });
    page.on("console", (message) => message.type() === "error" && complaints.push(`console: ${message.text()}`));
    page.on("pageerror", (error) => complaints.push(String(error)));
    const base = `http://127.0.0.1:${server.address().port}`;
    await page.route("**/*", (route) =>
      /^(blob|data):/.test(route.request().url()) || route.request().url().startsWith(`${base}/`)
        ? route.continue()
        : (complaints.push(`asked for ${route.request().url()}`), route.abort()),
    );
    await page.goto(`${base}${address}`);
    await page.waitForFunction("window.look !== undefined");
    await look(page);
  } finally {
    await browser.close();
    server.close();
  }
  return complaints;
}
