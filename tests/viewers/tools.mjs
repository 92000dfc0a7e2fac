// Tilesets through 3d-tiles-tools: it finds every tile and content, and what it writes again says the same.
//
//   node tools.mjs FOLDER …
import { spawnSync } from "node:child_process";
import { mkdtemp, readFile, readdir, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { basename, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { isDeepStrictEqual } from "node:util";

const tool = fileURLToPath(new URL("node_modules/.bin/3d-tiles-tools", import.meta.url));
const folders = process.argv.slice(2).map((folder) => resolve(folder));
if (folders.length === 0) {
  console.error("usage: node tools.mjs FOLDER …");
  process.exit(2);
}

/** Runs the program; its own words where it fails or warns. */
function run(...args) {
  const { status, stdout, stderr, error } = spawnSync(tool, args, { encoding: "utf8" });
  if (error) throw error;
  const words = `${stdout}${stderr}`;
  if (status !== 0 || /WARN|ERROR|FATAL/.test(words)) throw new Error(`3d-tiles-tools ${args.join(" ")}:\n${words}`);
}

const isGlb = (name) => name.endsWith(".glb");
const sorted = async (folder) => (await readdir(folder)).filter((name) => name === "tileset.json" || isGlb(name)).sort();

/** Packs a tileset, unpacks it, and combines what came out, which reads every tile and copies every content. */
async function complaints(folder, scratch) {
  const [packed, unpacked, combined] = ["packed.3tz", "unpacked", "combined"].map((name) => join(scratch, name));
  run("convert", "-i", folder, "-o", packed, "-f");
  run("convert", "-i", packed, "-o", unpacked, "-f");
  run("combine", "-i", unpacked, "-o", combined, "-f");
  const found = [];
  const read = async (folder) => JSON.parse(await readFile(join(folder, "tileset.json"), "utf8"));
  if (!isDeepStrictEqual(await read(unpacked), await read(folder))) found.push("the tileset is another one once it was packed");
  const again = await read(combined);
  const before = await read(folder);
  if (!isDeepStrictEqual([again.geometricError, again.root], [before.geometricError, before.root])) found.push("the tree is another one once it was read");
  const names = await sorted(unpacked);
  if (!isDeepStrictEqual(names, await sorted(folder))) found.push(`the files are ${names}`);
  for (const name of names.filter(isGlb)) run("analyze", "-i", join(unpacked, name), "-o", join(scratch, "analysis"), "-f");
  return found.map((what) => `${basename(folder)}: ${what}`);
}

let failed = false;
for (const folder of folders) {
  const scratch = await mkdtemp(join(tmpdir(), "chordal-tiles-"));
  const lines = await complaints(folder, scratch).catch((error) => [error.message]);
  await rm(scratch, { recursive: true });
  lines.forEach((line) => console.error(line));
  failed ||= lines.length > 0;
  if (lines.length === 0) console.log(`${basename(folder)}: read and written again by 3d-tiles-tools`);
}
process.exit(failed ? 1 : 0);
