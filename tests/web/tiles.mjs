// Tilesets in 3d-tiles-renderer: it must show the tiles that the formula requires, each in its box and without cracks.
//
//   node tiles.mjs [--closed | --cracks] FOLDER …
//
// --closed means that the shapes have no border, so that background inside a silhouette is a crack. With --cracks there have to
// be cracks: so the test itself is tested. PICTURES=FOLDER keeps the pictures.
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { judgeAll } from "./tiles/judge.mjs";

const root = fileURLToPath(new URL(".", import.meta.url));
await judgeAll("three", {
  folders: { "/modules/": join(root, "node_modules"), "/pages/": join(root, "tiles") },
  page: "/pages/three.html",
});
