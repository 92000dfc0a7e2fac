// Builds the notebook viewer into one script, which the Python package contains: a page with a mesh needs no other file.
//
//   node scripts/notebook.mjs
import { readFile, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "vite";

const root = join(dirname(fileURLToPath(import.meta.url)), "..");
const results = await build({
  root,
  configFile: false,
  logLevel: "warn",
  build: {
    write: false,
    target: "es2022",
    reportCompressedSize: false,
    lib: { entry: join(root, "src/notebook/main.ts"), formats: ["iife"], name: "chordal", fileName: "viewer" },
  },
});
const [{ output }] = [results].flat();
const licence = await readFile(join(root, "node_modules/three/LICENSE"), "utf8");
const head = `/* Chordal's viewer, with three.js:\n${licence.trim()}\n*/\n`;
// The script is inlined in a page, so it must not contain an end tag.
const script = head + output[0].code.replaceAll("</script", "<\\/script");
await writeFile(join(root, "../python/chordal/viewer.js"), script);
console.log(`studio: the viewer of notebooks is in python/chordal/viewer.js, ${Math.round(script.length / 1000)} kB`);
