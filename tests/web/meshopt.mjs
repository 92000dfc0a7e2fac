// Checks the decoded values of the compressed streams in chordal-io's tests against the decoder of three.js.
//
//   node meshopt.mjs meshopt_streams.json
//
// A row without a filter must be identical, a filtered one equal to one unit in the last place: the extension leaves that
// open, and three.js rounds in single precision.
import { readFile } from "node:fs/promises";
import { MeshoptDecoder } from "three/examples/jsm/libs/meshopt_decoder.module.js";

await MeshoptDecoder.ready;
const rows = JSON.parse(await readFile(process.argv[2], "utf8"));
const bytes = (text) => new Uint8Array(Buffer.from(text, "base64"));

/** The numbers on which a filter works. */
function numbers({ filter, stride }, list) {
  const narrow = stride === 4;
  const type = {
    OCTAHEDRAL: narrow ? Int8Array : Int16Array,
    QUATERNION: Int16Array,
    COLOR: narrow ? Uint8Array : Uint16Array,
  }[filter];
  return new (type ?? Uint8Array)(list.buffer);
}

let failed = rows.length === 0;
for (const row of rows) {
  const said = numbers(row, bytes(row.decoded));
  const target = new Uint8Array(row.count * row.stride);
  MeshoptDecoder.decodeGltfBuffer(target, row.count, row.stride, bytes(row.stream), row.mode, row.filter);
  const found = numbers(row, target);
  const off = said.length === found.length ? Math.max(...said.map((x, i) => Math.abs(x - found[i]))) : Infinity;
  const allowed = ["NONE", "EXPONENTIAL"].includes(row.filter) ? 0 : 1;
  if (off > allowed) {
    console.error(`${row.name}: off by ${off}`);
    failed = true;
  }
}
if (!failed) console.log(`${rows.length} streams: as three.js decodes them`);
process.exit(failed ? 1 : 0);
