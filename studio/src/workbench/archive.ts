// Packs files into one archive in a worker, so that the page stays responsive. fflate's own workers are created from text,
// which the page's content security policy forbids.
import { zipSync } from "fflate";
import type { Files } from "../core/command";

/** The earliest date of the ZIP format. Constant, so that the same files give the same bytes. */
const DAY = new Date(1980, 0, 1);

addEventListener("message", ({ data }: MessageEvent<Files>) => {
  const bytes = zipSync(data, { level: 6, mtime: DAY });
  postMessage(bytes, { transfer: [bytes.buffer] });
});
