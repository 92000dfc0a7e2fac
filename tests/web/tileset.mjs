// Checks a tileset against the specification. Written from its text and schemas, without code that writes tilesets.
//
//   node tileset.mjs FOLDER …        tileset.json and every content in each; validate.mjs checks the contents themselves
//
// Source: Open Geospatial Consortium, 3D Tiles Specification 1.1 (22-025r4), 2023.
import { readFile } from "node:fs/promises";
import { join, normalize } from "node:path";

const folders = process.argv.slice(2);
if (folders.length === 0) {
  console.error("usage: node tileset.mjs FOLDER …");
  process.exit(2);
}
const isObject = (x) => x !== null && typeof x === "object" && !Array.isArray(x);
const isLength = (x) => typeof x === "number" && Number.isFinite(x) && x >= 0;

/** Complaints about one tileset, one line each. */
async function complaints(folder) {
  const found = [];
  const complain = (at, what) => found.push(`${folder}${at}: ${what}`);
  const keys = (object, at, required, optional) => {
    if (!isObject(object)) return complain(at, "is no object"), false;
    required.filter((key) => !(key in object)).forEach((key) => complain(at, `has no ${key}`));
    Object.keys(object)
      .filter((key) => ![...required, ...optional, "extras", "extensions"].includes(key))
      .forEach((key) => complain(at, `has a ${key} that the specification does not know`));
    return required.every((key) => key in object);
  };
  const text = await readFile(join(folder, "tileset.json"), "utf8");
  const tileset = JSON.parse(text);
  const contents = new Set();

  const volume = (box, at) => {
    if (!Array.isArray(box) || box.length !== 12 || !box.every(Number.isFinite)) return complain(at, "is no box of 12 numbers");
    const [x, y, z] = [box.slice(3, 6), box.slice(6, 9), box.slice(9, 12)];
    const dot = (a, b) => a.reduce((sum, c, k) => sum + c * b[k], 0);
    const isSkew = (a, b) => Math.abs(dot(a, b)) > 1e-6 * Math.hypot(...a) * Math.hypot(...b);
    if (isSkew(x, y) || isSkew(y, z) || isSkew(z, x)) complain(at, "has half axes that are not perpendicular");
  };
  const uri = async (content, at) => {
    if (!keys(content, at, ["uri"], ["boundingVolume", "metadata", "group"])) return;
    const path = normalize(content.uri);
    if (typeof content.uri !== "string" || path.startsWith("..") || path.startsWith("/") || path.includes(":"))
      return complain(at, `names '${content.uri}', which is no file below the tileset`);
    contents.add(path);
    const bytes = await readFile(join(folder, path)).catch(() => undefined);
    if (!bytes) return complain(at, `names '${content.uri}', which is not there`);
    if (bytes.toString("latin1", 0, 4) !== "glTF") complain(at, `names '${content.uri}', which is no GLB`);
  };
  const tileOf = async (tile, at, parent) => {
    const optional = ["viewerRequestVolume", "refine", "transform", "content", "contents", "metadata", "implicitTiling", "children"];
    if (!keys(tile, at, ["boundingVolume", "geometricError"], optional)) return;
    if (keys(tile.boundingVolume, `${at}/boundingVolume`, ["box"], ["region", "sphere"])) volume(tile.boundingVolume.box, `${at}/boundingVolume/box`);
    if (!isLength(tile.geometricError)) complain(at, `has an error of ${tile.geometricError}`);
    if (!parent && !("refine" in tile)) complain(at, "is the root and does not say how it is refined");
    if ("refine" in tile && !["ADD", "REPLACE"].includes(tile.refine)) complain(at, `is refined by ${tile.refine}`);
    if ("content" in tile && "contents" in tile) complain(at, "has content and contents");
    if ("content" in tile) await uri(tile.content, `${at}/content`);
    for (const [i, content] of (tile.contents ?? []).entries()) await uri(content, `${at}/contents/${i}`);
    if ("children" in tile) {
      const texts = tile.children.map((child) => JSON.stringify(child));
      if (texts.length === 0 || new Set(texts).size < texts.length) complain(at, "has no children in its list, or the same twice");
      for (const [i, child] of tile.children.entries()) {
        // Beyond the specification, Chordal requires that each level is finer than its parent.
        if (!(child.geometricError < tile.geometricError)) complain(`${at}/children/${i}`, `has an error of ${child.geometricError}, not below ${tile.geometricError}`);
        await tileOf(child, `${at}/children/${i}`, tile);
      }
    } else if (tile.geometricError !== 0) complain(at, `is a leaf with an error of ${tile.geometricError}`);
  };

  const known = ["properties", "schema", "schemaUri", "statistics", "groups", "metadata", "extensionsUsed", "extensionsRequired"];
  if (!keys(tileset, "/", ["asset", "geometricError", "root"], known)) return found;
  keys(tileset.asset, "/asset", ["version"], ["tilesetVersion", "generator", "copyright"]);
  if (tileset.asset.version !== "1.1") complain("/asset", `says version ${tileset.asset.version}`);
  if (!isLength(tileset.geometricError) || !(tileset.geometricError >= tileset.root.geometricError)) complain("/", `has an error of ${tileset.geometricError}`);
  await tileOf(tileset.root, "/root", undefined);
  if (contents.size === 0) complain("/", "shows nothing");
  return found;
}

let failed = false;
for (const folder of folders) {
  const lines = await complaints(folder).catch((error) => [`${folder}: ${error.message}`]);
  lines.forEach((line) => console.error(line));
  failed ||= lines.length > 0;
  if (lines.length === 0) console.log(`${folder}: complies`);
}
process.exit(failed ? 1 : 0);
