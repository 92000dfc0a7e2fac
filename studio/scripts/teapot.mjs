// A patch of a .bpt file as a module: `import rows from "….bpt?patch=16"` is its control points, row by row, as the file has them.
// So a figure carries sixteen points of the teapot and not all of its text, and no number of it is written down twice.
import { readFileSync } from "node:fs";

const SUFFIX = /\.bpt\?patch=(\d+)$/;

export function teapot() {
  return {
    name: "teapot",
    enforce: "pre",
    load(id) {
      const [suffix, index] = SUFFIX.exec(id) ?? [];
      if (!suffix) return null;
      const path = id.slice(0, id.indexOf("?"));
      this.addWatchFile(path);
      return `export default ${JSON.stringify(patchOf(readFileSync(path, "utf8"), Number(index)))};`;
    },
  };
}

/** The points of a patch. The text has a count, then for each patch its two degrees and its points. */
export function patchOf(text, index) {
  const numbers = text.trim().split(/\s+/).map(Number);
  let at = 1;
  for (let patch = 0; patch < numbers[0]; patch += 1) {
    const [rows, columns] = [numbers[at] + 1, numbers[at + 1] + 1];
    const point = (i, j) => numbers.slice(at + 2 + 3 * (columns * i + j), at + 5 + 3 * (columns * i + j));
    if (patch === index) return Array.from({ length: rows }, (_, i) => Array.from({ length: columns }, (_, j) => point(i, j)));
    at += 2 + 3 * rows * columns;
  }
  throw new Error(`there is no patch ${index} among ${numbers[0]}`);
}
