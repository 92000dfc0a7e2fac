// The bench in the address, compressed: a script or another small file, its values, options and budget. What is larger, or is
// made of several files, has no link.
import { BUDGET, type Bench, type BudgetKind, isNumber } from "./document";

interface Packed {
  /** Of what may change between versions. */
  v: 1;
  name: string;
  /** The text of a script, or of another small text file. */
  text?: string;
  /** The bytes of a small file that is no text, in base64. */
  bytes?: string;
  budget: Bench["budget"];
  set: Bench["set"];
  options: string;
}

/** Longer links are cut off by some programs that pass them on. */
const MOST = 24_000;
/** A text of more than this is no script that anybody wrote. */
const MOST_TEXT = 400_000;
/** Of the same length in base64, with room for what stands beside it. */
const MOST_FILE = 290_000;

export async function pack(of: Bench): Promise<string | null> {
  const { name, files, budget, set, options, combine, before } = of;
  const bytes = files[name];
  // What a link would not bring back is not in one.
  const isWhole = Object.keys(files).length === 1 && !combine && before.length === 0;
  if (!bytes || bytes.length > MOST_FILE || !isWhole || !NAME.test(name) || options.length > MOST_OPTIONS) return null;
  const read = new TextDecoder("utf-8", { ignoreBOM: true });
  const content = isText(bytes) ? { text: read.decode(bytes) } : { bytes: binary(bytes) };
  const packed: Packed = { v: 1, name, ...content, budget, set, options };
  const squeezed = await through(new TextEncoder().encode(JSON.stringify(packed)), new CompressionStream("deflate-raw"));
  const coded = btoa(String.fromCharCode(...squeezed.slice(0, MOST))).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "");
  return squeezed.length > MOST ? null : coded;
}

/** The bench of a link; `null` where it is none, or damaged. */
export async function unpack(coded: string): Promise<Bench | null> {
  try {
    const squeezed = Uint8Array.from(atob(coded.replace(/-/g, "+").replace(/_/g, "/")), (c) => c.charCodeAt(0));
    const bytes = await through(squeezed, new DecompressionStream("deflate-raw"), MOST_TEXT);
    return read(JSON.parse(new TextDecoder("utf-8", { fatal: true }).decode(bytes)));
  } catch {
    return null;
  }
}

const isRecord = (value: unknown): value is Record<string, unknown> => typeof value === "object" && value !== null && !Array.isArray(value);
const KINDS: readonly BudgetKind[] = ["tol", "px", "triangles"];
/** No folder, and nothing that hides. */
const NAME = /^[^/\\.][^/\\]{0,80}$/;
const SHORT = 80;
const MOST_OPTIONS = 800;

function read(value: unknown): Bench | null {
  if (!isRecord(value) || value["v"] !== 1) return null;
  const { name, text, bytes, budget, set, options } = value;
  if (typeof name !== "string" || !NAME.test(name)) return null;
  const binary = typeof bytes === "string" ? unbinary(bytes) : null;
  const content = typeof text === "string" ? new TextEncoder().encode(text) : binary;
  if (!content) return null;
  const wanted = isRecord(budget) ? budget : {};
  const word = (key: string, usual: string) => {
    const found = wanted[key];
    return typeof found === "string" && found.length <= SHORT ? found : usual;
  };
  const by = KINDS.find((kind) => kind === wanted["by"]) ?? BUDGET.by;
  const values = Object.entries(isRecord(set) ? set : {}).filter(
    (pair): pair is [string, string] => typeof pair[1] === "string" && pair[1].length <= SHORT && isNumber(pair[1]),
  );
  return {
    name,
    files: { [name]: content },
    budget: { by, tol: word("tol", BUDGET.tol), px: word("px", BUDGET.px), triangles: word("triangles", BUDGET.triangles) },
    set: Object.fromEntries(values),
    combine: null,
    options: typeof options === "string" && options.length <= MOST_OPTIONS ? options : "",
    before: [],
  };
}

function isText(bytes: Uint8Array): boolean {
  try {
    return !new TextDecoder("utf-8", { fatal: true }).decode(bytes).includes("\0");
  } catch {
    return false;
  }
}

/** A letter for each byte, in pieces that a call takes as its arguments. */
function binary(bytes: Uint8Array): string {
  let letters = "";
  for (let at = 0; at < bytes.length; at += PIECE) letters += String.fromCharCode(...bytes.subarray(at, at + PIECE));
  return btoa(letters);
}
const PIECE = 8192;

const unbinary = (coded: string): Uint8Array => Uint8Array.from(atob(coded), (c) => c.charCodeAt(0));

/** What comes out of a stream; refused beyond a length, so that a small link cannot become gigabytes. */
async function through(bytes: Uint8Array, stream: GenericTransformStream, most = Infinity): Promise<Uint8Array> {
  const reader = new Blob([bytes as BlobPart]).stream().pipeThrough(stream as ReadableWritablePair<Uint8Array, Uint8Array>).getReader();
  const pieces: Uint8Array[] = [];
  let length = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    length += value.length;
    if (length > most) throw new RangeError("too long");
    pieces.push(value);
  }
  const all = new Uint8Array(length);
  let at = 0;
  for (const piece of pieces) {
    all.set(piece, at);
    at += piece.length;
  }
  return all;
}
