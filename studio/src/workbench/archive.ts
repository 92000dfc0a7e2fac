// Packs files into one archive, in a worker of its own, so that the page goes on. The library's own workers are made of text,
// which the page's policy refuses.
import { zipSync } from "fflate";
import type { Files } from "./command";

/** The first day that an archive can name: the same files make the same bytes. */
const DAY = new Date(1980, 0, 1);

addEventListener("message", ({ data }: MessageEvent<Files>) => {
  const bytes = zipSync(data, { level: 6, mtime: DAY });
  postMessage(bytes, { transfer: [bytes.buffer] });
});
