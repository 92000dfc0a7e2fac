// Tilesets in CesiumJS: it shows the tiles that the formula asks for, each in its box and without cracks.
//
//   node cesium.mjs [--closed | --cracks] FOLDER …        as tests/web/tiles.mjs
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { judgeAll } from "../web/tiles/judge.mjs";

const root = fileURLToPath(new URL(".", import.meta.url));
await judgeAll("cesium", {
  folders: { "/cesium/": join(root, "node_modules/cesium/Build/CesiumUnminified"), "/pages/": root },
  page: "/pages/cesium.html",
});
