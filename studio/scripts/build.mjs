// Builds the pages into dist/page: first the scripts, then the text and the still figures of the HTML files, which the core
// draws. The widget is index.html; every exhibit has a page for each language, from one template.
//
//   node scripts/build.mjs
import { createHash } from "node:crypto";
import { readFile, readdir, rm, writeFile } from "node:fs/promises";
import { dirname, join, relative } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { brotliCompressSync, constants } from "node:zlib";
import { build } from "vite";

const root = join(dirname(fileURLToPath(import.meta.url)), "..");
const out = join(root, "dist/page");
const widgets = { "index.html": "en", "zh.html": "zh" };
const PLACEHOLDER = "<!--figure and text, written at build time-->";
const ONWARD = "<!--onward, written at build time-->";
const SCRIPT = /\s*<script type="module"[^>]*><\/script>/;

await build({ root, logLevel: "warn" });

/** Builds a module that writes pages, and imports it into Node. */
async function prerender(source, name) {
  const outDir = join(cache, name);
  await build({ root, logLevel: "warn", build: { ssr: source, outDir, emptyOutDir: true, rollupOptions: { input: source } } });
  return import(pathToFileURL(join(outDir, "prerender.js")).href);
}
const cache = join(root, "node_modules/.prerender");
const { Core, still } = await prerender("src/prerender.tsx", "widget");
const { onwardFromWidget, written } = await prerender("src/exhibits/prerender.tsx", "exhibits");

const { lessons, lighter } = await prerender("src/lesson/prerender.tsx", "lesson");
const { workbenches, run } = await prerender("src/workbench/prerender.tsx", "workbench");

/** Replaces a text that must occur exactly once. */
function replaceOnce(html, old, text, what) {
  if (html.split(old).length !== 2) throw new Error(`the template has no place, or several, for ${what}`);
  return html.replace(old, () => text);
}

/** Adds the links between the two languages of a page. Not in the template: vite would copy the linked pages. */
function withAlternates(html, [en, zh]) {
  const links = [["en", en], ["zh-CN", zh]].map(([tag, file]) => `<link rel="alternate" hreflang="${tag}" href="${file}" />`);
  return replaceOnce(html, '<meta name="color-scheme"', `${links.join("\n    ")}\n    <meta name="color-scheme"`, "the other language");
}
/** The files of the pages' modules by their contents. In tests, where one module stands for all, those have two names. */
const assets = join(out, "assets");
const digest = (bytes) => createHash("sha256").update(bytes).digest("hex");
const modules = new Map();
for (const file of await readdir(assets)) {
  if (!file.endsWith(".wasm")) continue;
  const contents = digest(await readFile(join(assets, file)));
  modules.set(contents, [...(modules.get(contents) ?? []), file]);
}
/** Names the modules that a page loads, by which the service worker keeps them and no others. */
async function withModules(html, names) {
  const files = names.map(async (name) => modules.get(digest(await readFile(join(root, "wasm", name)))));
  const meta = `<meta name="chordal-modules" content="${(await Promise.all(files)).flat().join(" ")}" />`;
  return replaceOnce(html, '<meta name="color-scheme"', `${meta}\n    <meta name="color-scheme"`, "its modules");
}
const exhibitsOf = JSON.parse(await readFile(join(root, "src/exhibits/modules.json"), "utf8"));
/** The module of an exhibit; none for the list of them. */
const modulesOf = (id) => Object.keys(exhibitsOf).filter((name) => exhibitsOf[name].includes(id)).map((name) => `exhibits/${name}.wasm`);
/** The names of a page's file in both languages, from either of them. */
const inBothLanguages = (file) => [file.replace(/\.zh\.html$/, ".html"), file.replace(/(\.zh)?\.html$/, ".zh.html")];

const core = await Core.load(await readFile(join(root, "wasm/chordal.wasm")));
for (const [file, language] of Object.entries(widgets)) {
  const path = join(out, file);
  const html = replaceOnce(await readFile(path, "utf8"), PLACEHOLDER, still(core, language), "the text");
  const withOnward = replaceOnce(html, ONWARD, onwardFromWidget(), "the way on");
  await writeFile(path, await withModules(withAlternates(withOnward, Object.keys(widgets)), ["chordal.wasm"]));
}

const template = await readFile(join(out, "exhibit.html"), "utf8");
const escaped = (text) => text.replace(/&/g, "&amp;").replace(/"/g, "&quot;").replace(/</g, "&lt;");
/** A template filled with a page that was written, which loads these modules. */
async function filled(template, { file, lang, title, description, body }, modules) {
  let html = replaceOnce(template, '<html lang="en"', `<html lang="${lang}"`, "the language");
  html = replaceOnce(html, "<title>Chordal</title>", `<title>${escaped(title)}</title>`, "the title");
  html = replaceOnce(html, 'name="description" content=""', `name="description" content="${escaped(description)}"`, "the description");
  html = await withModules(replaceOnce(html, PLACEHOLDER, body, "the text"), modules);
  return withAlternates(html, inBothLanguages(file));
}
const exhibitsCore = await Core.load(await readFile(join(root, "wasm/exhibits.wasm")));
const exhibits = await written(exhibitsCore);
for (const page of exhibits) {
  const { file, id } = page;
  if (!id) {
    // The list has a still of each: heavy ones are files that load when they come near.
    const { html, files } = lighter(page.body);
    page.body = html;
    for (const { file, bytes } of files) await writeFile(join(out, file), bytes);
  }
  const html = await filled(replaceOnce(template, 'data-exhibit=""', `data-exhibit="${id}"`, "the exhibit"), page, modulesOf(id));
  // The list of exhibits has nothing interactive.
  await writeFile(join(out, file), id ? html : html.replace(SCRIPT, ""));
}
const workbenchTemplate = await readFile(join(out, "workbench.html"), "utf8");
for (const page of workbenches()) await writeFile(join(out, page.file), await filled(workbenchTemplate, page, ["command.wasm"]));
const lessonTemplate = await readFile(join(out, "lesson.html"), "utf8");
const { pages, teapot, stills } = await lessons(exhibitsCore);
const lessonModules = Object.keys(exhibitsOf).map((name) => `exhibits/${name}.wasm`);
for (const page of pages) await writeFile(join(out, page.file), await filled(lessonTemplate, page, lessonModules));
for (const { file, bytes } of [teapot, ...stills]) await writeFile(join(out, file), bytes);
// The script that switches languages needs the ids of all exhibits.
const ids = [...new Set(exhibits.map(({ id }) => id).filter(Boolean))];
const language = join(out, "language.js");
await writeFile(language, replaceOnce(await readFile(language, "utf8"), "exhibits = []", `exhibits = ${JSON.stringify(ids)}`, "the exhibits"));
await rm(join(out, "exhibit.html"));
await rm(cache, { recursive: true });

// What a page looks like where somebody links to it: a picture that the command draws, and the page's own title and
// description. A preview needs whole addresses, so CHORDAL_PAGE_URL says where the pages will be; without it they are relative.
const command = await WebAssembly.compile(await readFile(join(root, "wasm/command.wasm")));
const shape = { "teapot.bpt": await readFile(join(root, "../examples/teapot.bpt")) };
for (const [file, size] of [["preview.png", "800x420"], ["icon.png", "180x180"]]) {
  const { exit, stderr, outputs } = await run(command, ["render", "teapot.bpt", "--size", size, "-o", file], shape);
  if (exit !== 0) throw new Error(`the command cannot draw ${file}: ${stderr}`);
  await writeFile(join(out, file), outputs[file]);
}
const site = (process.env.CHORDAL_PAGE_URL ?? "").replace(/(?<=[^/])$/, "/");
for (const file of (await readdir(out)).filter((name) => name.endsWith(".html"))) {
  const html = await readFile(join(out, file), "utf8");
  const [, title] = /<title>([^<]+)<\/title>/.exec(html) ?? [];
  const [, description] = /<meta name="description" content="([^"]+)"/.exec(html) ?? [];
  if (!title || !description) throw new Error(`${file} has no title or no description`);
  const properties = { type: "website", title, description, image: `${site}preview.png`, "image:width": "800", "image:height": "420", ...(site ? { url: site + file } : {}) };
  const tags = [
    '<link rel="apple-touch-icon" href="icon.png" />',
    ...Object.entries(properties).map(([name, value]) => `<meta property="og:${name}" content="${value}" />`),
    '<meta name="twitter:card" content="summary_large_image" />',
  ];
  await writeFile(join(out, file), replaceOnce(html, "</head>", `  ${tags.join("\n    ")}\n  </head>`, "its preview"));
}

// The service worker's version changes whenever a file does.
const worker = join(out, "service-worker.js");
const files = (await readdir(out, { recursive: true, withFileTypes: true })).filter((entry) => entry.isFile());
const paths = files.map((entry) => join(entry.parentPath, entry.name)).sort();
const hash = createHash("sha256");
for (const path of paths) hash.update(relative(out, path)).update(await readFile(path));
const names = paths.map((path) => relative(assets, path)).filter((name) => !name.startsWith(".."));
const source = replaceOnce(await readFile(worker, "utf8"), '"none"', JSON.stringify(hash.digest("hex").slice(0, 16)), "the version");
await writeFile(worker, replaceOnce(source, "const ASSETS = [];", `const ASSETS = ${JSON.stringify(names)};`, "the names of assets"));

// All files in one archive, which the command contains: a line of JSON with their names and lengths, then their bytes, each
// compressed as the server sends it. The best quality takes a minute; CHORDAL_PAGE_QUALITY is from 0 to 11.
const packed = (await readdir(out, { recursive: true, withFileTypes: true }))
  .filter((entry) => entry.isFile())
  .map((entry) => join(entry.parentPath, entry.name))
  .sort();
const quality = Number(process.env.CHORDAL_PAGE_QUALITY ?? constants.BROTLI_MAX_QUALITY);
const contents = await Promise.all(packed.map(async (path) => compressed(await readFile(path))));
const list = packed.map((path, i) => [relative(out, path).replaceAll("\\", "/"), contents[i].length]);
const archive = Buffer.concat([Buffer.from(`${JSON.stringify(list)}\n`), ...contents]);
function compressed(bytes) {
  const { BROTLI_PARAM_QUALITY, BROTLI_PARAM_LGWIN, BROTLI_PARAM_SIZE_HINT, BROTLI_MAX_WINDOW_BITS } = constants;
  const params = { [BROTLI_PARAM_QUALITY]: quality, [BROTLI_PARAM_LGWIN]: BROTLI_MAX_WINDOW_BITS, [BROTLI_PARAM_SIZE_HINT]: bytes.length };
  return brotliCompressSync(bytes, { params });
}
await writeFile(join(root, "dist/page.br"), archive);
console.log(`studio: ${Math.round(archive.length / 1000)} kB of it are built into the command`);
console.log(`studio: the page is in studio/dist/page, with ${exhibits.length} of exhibits`);
