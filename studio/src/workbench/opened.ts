// Files as an input of the command: one is the shape, the others are those to which it refers.
import type { Files } from "../core/command";
import { type Bench, bench } from "./document";

/** The largest total size of opened files. Chosen: a browser holds several copies of them in memory. */
const MOST_BYTES = 600e6;
/** Files that others refer to. */
const BESIDE = /\.(bin|mtl|png|jpe?g|webp|raw|img)$/i;

/** Reads files, of which there is at least one; or says why not. */
export async function opened(list: readonly File[]): Promise<Bench | "too-large" | "unread"> {
  const main = list.find((file) => !BESIDE.test(file.name)) ?? list[0]!;
  if (list.reduce((sum, file) => sum + file.size, 0) > MOST_BYTES) return "too-large";
  const files: Files = {};
  try {
    for (const file of list) files[nameOf(file)] = new Uint8Array(await file.arrayBuffer());
  } catch {
    // A dropped folder cannot be read.
    return "unread";
  }
  return bench(nameOf(main), files);
}

/** A file name that the command does not parse as an option. */
const nameOf = ({ name }: File): string => name.replace(/^-+/, "_");
