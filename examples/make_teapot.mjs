// Writes teapot.bpt from the source text of three's TeapotGeometry.js, which holds Newell's control points as they
// were published: 32 patches of 16 indices, 306 points at most, z up. Nothing is scaled, moved, merged or rounded.
//
//   node make_teapot.mjs node_modules/three/examples/jsm/geometries/TeapotGeometry.js > teapot.bpt
import { readFileSync } from "node:fs";

const source = readFileSync(process.argv[2], "utf8");

/** The numbers between the brackets of `const name = [ … ];`; the file writes `- 1.5` with a space. */
function numbers(name) {
  const list = source.match(new RegExp(`const ${name} = \\[([^\\]]*)\\]`));
  if (!list) throw new Error(`no list '${name}' in ${process.argv[2]}`);
  const text = list[1].replace(/\/\*.*?\*\//gs, "").replace(/-\s+/g, "-");
  const words = text.split(",").map((word) => word.trim()).filter((word) => word !== "");
  for (const word of words) if (!/^-?\d+(\.\d+)?$/.test(word)) throw new Error(`'${word}' in ${name} is no number`);
  return words;
}

const indices = numbers("teapotPatches").map(Number);
const coordinates = numbers("teapotVertices");
const patches = indices.length / 16;
if (patches !== 32) throw new Error(`${patches} patches where 32 are expected`);

const lines = [String(patches)];
indices.forEach((index, corner) => {
  const point = coordinates.slice(3 * index, 3 * index + 3);
  if (point.length !== 3) throw new Error(`patch corner ${corner} names point ${index}, which is not there`);
  if (corner % 16 === 0) lines.push("3 3");
  lines.push(point.join(" "));
});
process.stdout.write(lines.join("\n") + "\n");
