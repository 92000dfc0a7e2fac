// Whether an asset looks the same after a verb: three.js renders both from several sides, and the pixels are compared.
//
//   node looks.mjs [--other] BEFORE AFTER …
//
// With --other the two have to look different: so the test itself is tested. PICTURES=FOLDER keeps the pictures.
import { mkdir } from "node:fs/promises";
import { basename, dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { withPage } from "./browser.mjs";

const root = fileURLToPath(new URL(".", import.meta.url));
const [WIDTH, HEIGHT] = [480, 360];
/** The largest difference of a channel, of 255, that counts as equal. Chosen: a step of shading that few see side by side. */
const STEP = 12;
/** The share of the covered pixels that may differ. Measured: up to 1.5 %, along borders of triangles, charts and the shape. */
const SHARE = 0.03;
/** Directions from the middle of the shape to the eye. */
const ABOUT = [
  [0.3, 0.4, 1],
  [1, 0.2, -0.3],
  [-0.7, 0.5, 0.6],
  [0.1, -1, 0.2],
  [-0.4, 0.9, -0.8],
];

/** The share of the pixels covered by either picture that differ in colour, and the number of covered pixels. */
function difference(a, b) {
  let [covered, differing] = [0, 0];
  for (let i = 0; i < a.length; i += 4) {
    if (a[i + 3] === 0 && b[i + 3] === 0) continue;
    covered += 1;
    differing += [0, 1, 2, 3].some((k) => Math.abs(a[i + k] - b[i + k]) > STEP) ? 1 : 0;
  }
  return { covered, share: differing / Math.max(covered, 1) };
}

const wantOther = process.argv.includes("--other");
const [before, ...afters] = process.argv.slice(2).filter((arg) => !arg.startsWith("--"));
if (afters.length === 0) {
  console.error("usage: node looks.mjs [--other] BEFORE AFTER …");
  process.exit(2);
}
const files = [before, ...afters].map((file) => resolve(file));
const folders = { "/modules/": join(root, "node_modules"), "/pages/": join(root, "looks") };
files.forEach((file, i) => (folders[`/${i}/`] = dirname(file)));
const bad = [];
const served = { folders, address: "/pages/three.html", viewport: { width: WIDTH, height: HEIGHT } };
const troubles = await withPage(served, async (page) => {
  const pictures = [];
  for (const [i, file] of files.entries()) {
    await page.evaluate((url) => window.open_model(url), `/${i}/${basename(file)}`);
    const views = [];
    for (const [k, direction] of ABOUT.entries()) {
      views.push(Buffer.from(await page.evaluate((direction) => window.look(direction), direction), "base64"));
      if (process.env.PICTURES) {
        await mkdir(process.env.PICTURES, { recursive: true });
        await page.screenshot({ path: join(process.env.PICTURES, `${i}-${basename(file)}-${k}.png`) });
      }
    }
    pictures.push(views);
  }
  for (const [i, file] of files.entries()) {
    if (i === 0) continue;
    const found = pictures[i].map((view, k) => difference(pictures[0][k], view));
    const worst = Math.max(...found.map(({ share }) => share));
    const least = Math.min(...found.map(({ covered }) => covered));
    console.log(`${basename(file)}: at most ${(100 * worst).toFixed(2)} % of the pixels of a view differ, at least ${least} are covered`);
    if (least < 1000) bad.push(`${basename(file)}: a view shows next to nothing`);
    if (worst > SHARE !== wantOther) bad.push(`${basename(file)} looks ${wantOther ? "the same as" : "other than"} ${basename(files[0])}`);
  }
});
[...bad, ...troubles].forEach((line) => console.error(line));
process.exit(bad.length + troubles.length > 0 ? 1 : 0);
