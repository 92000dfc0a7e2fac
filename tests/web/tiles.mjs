// Tilesets in 3d-tiles-renderer: it shows the tiles that the formula asks for, each in its box and without cracks.
//
//   node tiles.mjs [--closed | --cracks] FOLDER …
//
// --closed says that the shapes have no border, so that cracks can be told from it. With --cracks they have to be found: the
// judge is seen to fail. PICTURES=FOLDER keeps the pictures.
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { judgeAll } from "./tiles/judge.mjs";

const root = fileURLToPath(new URL(".", import.meta.url));
await judgeAll("three", {
  folders: { "/modules/": join(root, "node_modules"), "/pages/": join(root, "tiles") },
  page: "/pages/three.html",
});
