// Builds the page into dist/page: first what the browser runs, then the text and the still figures of the HTML files,
// which the core itself draws.
//
//   node scripts/build.mjs
import { readFile, rm, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { build } from "vite";

const root = join(dirname(fileURLToPath(import.meta.url)), "..");
const wasm = join(root, "wasm/chordal.wasm");
const pages = { "index.html": "en", "zh.html": "zh" };
const PLACE = "<!--figure and text, written at build time-->";

await build({ root, logLevel: "warn" });

const cache = join(root, "node_modules/.prerender");
await build({
  root,
  logLevel: "warn",
  build: { ssr: "src/prerender.tsx", outDir: cache, emptyOutDir: true, rollupOptions: { input: "src/prerender.tsx" } },
});
const { Core, still } = await import(pathToFileURL(join(cache, "prerender.js")).href);
const core = await Core.load(await readFile(wasm));
for (const [file, language] of Object.entries(pages)) {
  const path = join(root, "dist/page", file);
  const html = await readFile(path, "utf8");
  if (!html.includes(PLACE)) throw new Error(`${file} has no place for the text`);
  await writeFile(path, html.replace(PLACE, () => still(core, language)));
}
await rm(cache, { recursive: true });
console.log("studio: the page is in studio/dist/page");
