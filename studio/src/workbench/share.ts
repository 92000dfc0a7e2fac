// The bench as a compressed link in the address: a script or another small file with its values, options and budget. A larger
// bench, or one of several files, has no link. Of a script that reads files, the link has the script, which asks for them.
import { BUDGET, type Bench, type BudgetKind, isNumber, isScript } from "./document";

interface Packed {
  /** The version of this format. */
  v: 1;
  name: string;
  /** The text of a script, or of another small text file. */
  text?: string;
  /** The bytes of a small binary file, in base64. */
  bytes?: string;
  budget: Bench["budget"];
  set: Bench["set"];
  options: string;
}

/** Some programs that pass links on cut longer ones. */
const MOST = 24_000;
/** No script is longer than this; a larger text is an attack or an accident. */
const MOST_TEXT = 400_000;
/** The largest file that base64 brings to `MOST_TEXT`, with room for the other fields. */
const MOST_FILE = 290_000;

export async function pack(bench: Bench): Promise<string | null> {
  const { name, files, budget, set, options, combine, before } = bench;
  const bytes = files[name];
  // A link must restore the whole bench, so one with further files or previous steps has none. A script asks for its files.
  const isSelfContained = (isScript(bench) || Object.keys(files).length === 1) && !combine && before.length === 0;
  if (!bytes || bytes.length > MOST_FILE || !isSelfContained || !NAME.test(name) || options.length > MOST_OPTIONS) return null;
  // A byte order mark is kept, so that the text comes back byte for byte.
  const read = new TextDecoder("utf-8", { ignoreBOM: true });
  const content = isText(bytes) ? { text: read.decode(bytes) } : { bytes: toBase64(bytes) };
  const packed: Packed = { v: 1, name, ...content, budget, set, options };
  const compressed = await through(new TextEncoder().encode(JSON.stringify(packed)), new CompressionStream("deflate-raw"));
  // Cut, because a call takes a limited number of arguments; what is longer has no link anyway.
  const encoded = btoa(String.fromCharCode(...compressed.slice(0, MOST))).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "");
  return compressed.length > MOST ? null : encoded;
}

/** The bench of a link; `null` if the link is damaged. */
export async function unpack(encoded: string): Promise<Bench | null> {
  try {
    const compressed = Uint8Array.from(atob(encoded.replace(/-/g, "+").replace(/_/g, "/")), (c) => c.charCodeAt(0));
    const bytes = await through(compressed, new DecompressionStream("deflate-raw"), MOST_TEXT);
    return read(JSON.parse(new TextDecoder("utf-8", { fatal: true }).decode(bytes)));
  } catch {
    return null;
  }
}

const isRecord = (value: unknown): value is Record<string, unknown> => typeof value === "object" && value !== null && !Array.isArray(value);
const KINDS: readonly BudgetKind[] = ["tol", "px", "triangles"];
/** A plain file name: no folder, not hidden. */
const NAME = /^[^/\\.][^/\\]{0,80}$/;
const SHORT = 80;
const MOST_OPTIONS = 800;

function read(value: unknown): Bench | null {
  if (!isRecord(value) || value["v"] !== 1) return null;
  const { name, text, bytes, budget, set, options } = value;
  if (typeof name !== "string" || !NAME.test(name)) return null;
  const decoded = typeof bytes === "string" ? fromBase64(bytes) : null;
  const content = typeof text === "string" ? new TextEncoder().encode(text) : decoded;
  if (!content) return null;
  const budgetFields = isRecord(budget) ? budget : {};
  const fieldOr = (key: string, usual: string) => {
    const value = budgetFields[key];
    return typeof value === "string" && value.length <= SHORT ? value : usual;
  };
  const by = KINDS.find((kind) => kind === budgetFields["by"]) ?? BUDGET.by;
  const values = Object.entries(isRecord(set) ? set : {}).filter(
    (pair): pair is [string, string] => typeof pair[1] === "string" && pair[1].length <= SHORT && isNumber(pair[1]),
  );
  return {
    name,
    files: { [name]: content },
    budget: { by, tol: fieldOr("tol", BUDGET.tol), px: fieldOr("px", BUDGET.px), triangles: fieldOr("triangles", BUDGET.triangles) },
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

/** A character per byte, in pieces because a call takes a limited number of arguments. */
function toBase64(bytes: Uint8Array): string {
  let letters = "";
  for (let at = 0; at < bytes.length; at += PIECE) letters += String.fromCharCode(...bytes.subarray(at, at + PIECE));
  return btoa(letters);
}
const PIECE = 8192;

const fromBase64 = (encoded: string): Uint8Array => Uint8Array.from(atob(encoded), (c) => c.charCodeAt(0));

/** Reads a whole stream. Rejects beyond `most` bytes, so that a small link cannot expand to gigabytes. */
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
  const joined = new Uint8Array(length);
  let at = 0;
  for (const piece of pieces) {
    joined.set(piece, at);
    at += piece.length;
  }
  return joined;
}
