// Builds the tree and the edges of triangles beside the page.
import { type Triangles, solidOf } from "./solid";

addEventListener("message", ({ data }: MessageEvent<Triangles>) => {
  const solid = solidOf(data);
  const buffers = Object.values(solid).map((array) => (array as Uint32Array).buffer as ArrayBuffer);
  postMessage(solid, { transfer: [...new Set(buffers)] });
});
