// Judges a viewer's picture of a tileset: the tiles that it shows against the formula, and their silhouette against that of the
// finest tiles. Shares no code with the writer of tilesets.
import { mkdir, readFile } from "node:fs/promises";
import { basename, extname, join, resolve } from "node:path";
import { withPage } from "../browser.mjs";

export const WIDTH = 320;
export const HEIGHT = 240;
export const FOV_Y_DEG = 45;
/** Samples along a pixel; viewers draw the same picture on a larger canvas, because cracks are often less than a pixel wide. */
export const SCALE = 4;
const [COLUMNS, ROWS] = [WIDTH * SCALE, HEIGHT * SCALE];
const TAN = Math.tan((FOV_Y_DEG * Math.PI) / 360);

const sub = (a, b) => a.map((x, i) => x - b[i]);
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((x) => x / Math.hypot(...a));

/** Half the size of a tile's axis-aligned box, and the distance of a point to the box, 0 inside. */
const half = (box) => [box[3], box[7], box[11]];
const distance = (box, p) => Math.hypot(...p.map((x, k) => Math.max(Math.abs(x - box[k]) - half(box)[k], 0)));

/** A tile's error in pixels: the formula of 3D Tiles for a tile in the middle of the picture. */
const pixels = (tile, eye) => (tile.geometricError * HEIGHT) / (2 * distance(tile.boundingVolume.box, eye) * TAN);

/** The tiles that the formula requires if all are in view: down from the root until the error fits. */
export function chosen(tile, eye, target) {
  const fits = !tile.children || pixels(tile, eye) <= target;
  if (!fits) return tile.children.flatMap((child) => chosen(child, eye, target));
  return tile.content ? [tile] : [];
}

/** The position of a point in the picture; `undefined` if it is beside or behind the eye. */
function project(camera, point) {
  const forward = unit(sub(camera.target, camera.position));
  const right = unit(cross(forward, camera.up));
  const up = cross(right, forward);
  const way = sub(point, camera.position);
  const depth = dot(way, forward);
  if (depth <= 0) return undefined;
  const scale = HEIGHT / 2 / TAN / depth;
  return [WIDTH / 2 + dot(way, right) * scale, HEIGHT / 2 - dot(way, up) * scale];
}

const corners = (box) => [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [0, 1, 2].map((k) => box[k] + (i & (1 << k) ? 1 : -1) * half(box)[k]));

/** Whether the middle of a tile is in the picture, so that the tile must be shown. */
function isCentral(camera, box) {
  const at = project(camera, box.slice(0, 3));
  return at && at[0] > 0 && at[0] < WIDTH && at[1] > 0 && at[1] < HEIGHT;
}

/** A mask without the samples within `r` of one outside of it, or of the border of the picture. */
function eroded(mask, r) {
  const pass = (from, step, n, other, m) => {
    const to = new Uint8Array(from.length);
    for (let j = 0; j < m; j++)
      // The middle one of 2r + 1 consecutive samples in the mask stays.
      for (let i = 0, run = 0; i < n; i++) {
        run = from[j * other + i * step] ? run + 1 : 0;
        if (run > 2 * r) to[j * other + (i - r) * step] = 1;
      }
    return to;
  };
  return pass(pass(mask, 1, COLUMNS, COLUMNS, ROWS), COLUMNS, ROWS, 1, COLUMNS);
}

/** The number of samples at least `r` inside one silhouette that the other does not cover. */
function uncovered(inner, outer, r) {
  return eroded(inner, r).reduce((n, inside, i) => n + (inside && !outer[i] ? 1 : 0), 0);
}

/** The number of samples of one silhouette that are farther than `r` from all of the other. */
function farther(from, to, r) {
  const reach = Math.floor(r);
  let n = 0;
  for (let j = 0; j < ROWS; j++)
    for (let i = 0; i < COLUMNS; i++) {
      if (!from[j * COLUMNS + i]) continue;
      let near = to[j * COLUMNS + i];
      for (let y = Math.max(j - reach, 0); !near && y <= Math.min(j + reach, ROWS - 1); y++)
        for (let x = Math.max(i - reach, 0); !near && x <= Math.min(i + reach, COLUMNS - 1); x++)
          near = (x - i) ** 2 + (y - j) ** 2 <= r * r && to[y * COLUMNS + x];
      n += near ? 0 : 1;
    }
  return n;
}

/** Cameras around the box: at distances between the switching distances, and at them, where near tiles are finer. */
export function cameras(tileset, target) {
  const box = tileset.root.boundingVolume.box;
  const centre = box.slice(0, 3);
  const radius = Math.hypot(...half(box));
  const errors = new Set();
  const collect = (tile) => (errors.add(tile.geometricError), (tile.children ?? []).forEach(collect));
  collect(tileset.root);
  const switches = [...errors].filter((error) => error > 0).map((error) => (error * HEIGHT) / (2 * target * TAN));
  // Near enough for a visible size, and not within the box.
  const inSight = (d) => d > 1.2 * radius && d < (radius * HEIGHT) / 8;
  const view = (d, direction) => ({
    position: centre.map((c, k) => c + unit(direction)[k] * d),
    target: centre,
    up: [0, 0, 1],
    fovYDeg: FOV_Y_DEG,
  });
  const about = [
    [0.3, -1, 0.4],
    [1, 0.2, 0.1],
    [-0.6, 0.5, 0.9],
  ];
  const between = switches.flatMap((d) => [0.75 * d + radius, 1.3 * d + radius]).filter(inSight);
  const along = [
    [1, 0.1, 0.15],
    [-0.1, -1, 0.15],
    [0.15, 0.1, 1],
  ];
  const at = switches.map((d) => 1.02 * d).filter(inSight);
  return [...between.map((d, i) => view(d, about[i % about.length])), ...at.flatMap((d) => along.map((way) => view(d, way)))];
}

/**
 * Opens a viewer's page on a tileset and checks its pictures from all cameras. Returns complaints, one line each.
 *
 * @param options.isClosed whether the shape has no border, so that background within its silhouette is a crack
 * @param options.folders the folders that are served: the viewer, its page, and the tileset below /tiles/
 * @param options.page the address of the page, which has `openTileset` and `look`
 */
export async function judge({ name, folder, isClosed, folders, page: address, targets, pictures }) {
  const tileset = JSON.parse(await readFile(join(folder, "tileset.json"), "utf8"));
  const complaints = [];
  const seen = { views: 0, cracks: 0, mixed: 0, contents: new Set() };
  // GLBs of closed shapes are made one-sided, so that no back face hides a crack.
  const changed = (body, file) =>
    isClosed && extname(file) === ".glb" ? Buffer.from(body.toString("latin1").replace('"doubleSided":true', '"doubleSidex":true'), "latin1") : body;
  const served = { folders: { "/tiles/": folder, ...folders }, address: `${address}?scale=${SCALE}`, viewport: { width: WIDTH, height: HEIGHT }, changed };
  const troubles = await withPage(served, async (page) => {
    await page.evaluate((url) => window.openTileset(url), "/tiles/tileset.json");
    const look = async (camera, target) => {
      const { shown, mask } = await page.evaluate(([camera, target]) => window.look(camera, target), [camera, target]);
      return { shown: shown.map((url) => decodeURIComponent(url.replace(/^.*\/tiles\//, "").replace(/[?#].*/, ""))), mask: Uint8Array.from(Buffer.from(mask, "base64")) };
    };
    for (const target of targets)
      for (const [i, camera] of cameras(tileset, target).entries()) {
        const here = `${name}: error target ${target}, view ${i}`;
        const found = await look(camera, target);
        if (pictures) {
          await mkdir(pictures, { recursive: true });
          await page.screenshot({ path: join(pictures, `${name}-${target}-${i}.png`) });
        }
        seen.views += 1;
        const wanted = chosen(tileset.root, camera.position, target);
        const names = wanted.map((tile) => tile.content.uri);
        const extra = found.shown.filter((uri) => !names.includes(uri));
        const missing = wanted.filter((tile) => isCentral(camera, tile.boundingVolume.box) && !found.shown.includes(tile.content.uri));
        if (extra.length) complaints.push(`${here}: shows ${extra}, where the formula asks for ${names}`);
        if (missing.length) complaints.push(`${here}: does not show ${missing.map((tile) => tile.content.uri)}`);
        found.shown.forEach((uri) => seen.contents.add(uri));
        seen.mixed += new Set(wanted.map((tile) => tile.geometricError)).size > 1 ? 1 : 0;

        const outline = corners(tileset.root.boundingVolume.box).map((corner) => project(camera, corner));
        const sides = [0, 1].map((axis) => [Math.min, Math.max].map((end) => end(...outline.map((at) => at?.[axis]))));
        const covered = [];
        found.mask.forEach((is, k) => is && covered.push(k));
        if (covered.length < 20 * SCALE ** 2) complaints.push(`${here}: only ${covered.length} samples are covered`);
        if (outline.every((at) => at)) {
          const outside = covered.filter((k) => {
            const at = [(k % COLUMNS) + 0.5, Math.floor(k / COLUMNS) + 0.5].map((x) => x / SCALE);
            return sides.some(([low, high], axis) => at[axis] < low - 1 || at[axis] > high + 1);
          });
          if (outside.length) complaints.push(`${here}: ${outside.length} samples lie outside the box`);
        }
        const finest = await look(camera, 1e-9);
        // A sample that moves by the target covers samples within the diagonal of one at the new place.
        const r = target * SCALE + Math.SQRT2;
        const off = farther(finest.mask, found.mask, r) + farther(found.mask, finest.mask, r);
        if (off) complaints.push(`${here}: ${off} samples are farther than ${target} pixels from the silhouette of the finest tiles`);
        const cracks = isClosed ? uncovered(finest.mask, found.mask, Math.ceil(target + 1) * SCALE) : 0;
        seen.cracks += cracks;
        if (cracks) complaints.push(`${here}: the background shows through at ${cracks} samples (${found.shown})`);
      }
  });
  complaints.push(...troubles.map((line) => `${name}: ${line}`));
  if (seen.views === 0) complaints.push(`${name}: there is no distance to look from`);
  // If regions are refined independently, the borders between levels must have been judged, too.
  const branches = (tile) => (tile.children?.length ?? 0) > 1 || (tile.children ?? []).some(branches);
  if (branches(tileset.root) && seen.mixed === 0) complaints.push(`${name}: no view shows several levels at once`);
  return { complaints, seen: { ...seen, contents: seen.contents.size } };
}

/** Judges the folders on the command line, and exits with the result. */
export async function judgeAll(viewer, { folders, page }) {
  const flags = process.argv.slice(2).filter((arg) => arg.startsWith("--"));
  const names = process.argv.slice(2).filter((arg) => !arg.startsWith("--"));
  const wantCracks = flags.includes("--cracks");
  if (names.length === 0 || flags.some((flag) => !["--closed", "--cracks"].includes(flag))) {
    console.error(`usage: node ${basename(process.argv[1])} [--closed | --cracks] FOLDER …`);
    process.exit(2);
  }
  let failed = false;
  for (const folder of names.map((name) => resolve(name))) {
    const name = `${viewer}-${basename(folder)}`;
    const { complaints, seen } = await judge({
      name,
      folder,
      isClosed: flags.length > 0,
      folders,
      page,
      targets: wantCracks ? [8] : [1, 4],
      pictures: process.env.PICTURES,
    });
    const real = complaints.filter((line) => !wantCracks || !line.includes("shows through"));
    if (wantCracks && seen.cracks === 0) real.push(`${name}: no crack was found where there are some`);
    real.forEach((line) => console.error(line));
    failed ||= real.length > 0;
    console.log(`${name}: ${seen.views} views, ${seen.contents} contents, ${seen.mixed} views of several levels, ${seen.cracks} samples of cracks`);
  }
  process.exit(failed ? 1 : 0);
}
