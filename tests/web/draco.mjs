// Checks the decoded values of the Draco streams in chordal-io's tests against the decoder of three.js.
//
//   node draco.mjs draco_streams.json
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { readFileSync } from "node:fs";
import vm from "node:vm";

const path = createRequire(import.meta.url).resolve("three/examples/jsm/libs/draco/gltf/draco_decoder.js");
// The decoder is a script for pages that sets a global name, but files of its package are modules.
const page = { console, performance, TextDecoder, URL, self: { location: { href: "file:///" } }, window: {} };
vm.runInNewContext(`${readFileSync(path, "utf8")}\nthis.factory = DracoDecoderModule;`, page);
const draco = await page.factory({});
const rows = JSON.parse(await readFile(process.argv[2], "utf8"));
const bytes = (text) => new Uint8Array(Buffer.from(text, "base64"));

/** The bytes that a call of the decoder writes. */
function written(n, fill) {
  const at = draco._malloc(n);
  fill(at);
  const found = Buffer.from(new Uint8Array(draco.HEAPF32.buffer, at, n).slice());
  draco._free(at);
  return found;
}

let failed = rows.length === 0;
for (const row of rows) {
  const stream = new Int8Array(bytes(row.stream));
  const decoder = new draco.Decoder();
  const mesh = new draco.Mesh();
  const status = decoder.DecodeArrayToMesh(stream, stream.length, mesh);
  const wrong = (what) => {
    console.error(`${row.name}: ${what}`);
    failed = true;
  };
  if (!status.ok()) {
    wrong(status.error_msg());
    continue;
  }
  const n_corners = 12 * mesh.num_faces();
  const corners = written(n_corners, (at) => decoder.GetTrianglesUInt32Array(mesh, n_corners, at));
  if (!corners.equals(bytes(row.indices))) wrong("other triangles");
  for (const [name, { id, values }] of Object.entries(row.attributes)) {
    const attribute = decoder.GetAttributeByUniqueId(mesh, id);
    const is_color = name.startsWith("COLOR");
    const kind = is_color ? draco.DT_UINT8 : draco.DT_FLOAT32;
    const n = mesh.num_points() * attribute.num_components() * (is_color ? 1 : 4);
    const get = (at) => decoder.GetAttributeDataArrayForAllPoints(mesh, attribute, kind, n, at);
    if (!written(n, get).equals(bytes(values))) wrong(`another ${name}`);
  }
}
if (!failed) console.log(`${rows.length} streams of Draco: as three.js decodes them`);
process.exit(failed ? 1 : 0);
