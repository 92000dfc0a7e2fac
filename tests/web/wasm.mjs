// The WASM module meshes the same shape to the same bytes as the native command: patches and fields to GLB, curves to JSON.
//
//   node wasm.mjs chordal_wasm.wasm native.glb patches.bpt [budget]
//
// native.glb, or native.json for curves, is the output of `chordal mesh patches.bpt --tol BUDGET -o native.glb`; the default
// budget is 0.001. Other budgets are given as the module's options, as in '{"triangles": 1000}'.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { basename, extname } from "node:path";

const [wasmFile, nativeFile, patchFile, budget = "0.001"] = process.argv.slice(2);
if (!patchFile) {
  console.error("usage: node wasm.mjs MODULE.wasm NATIVE.glb PATCHES [BUDGET]");
  process.exit(2);
}

const module = await WebAssembly.compile(await readFile(wasmFile));
// The module that is shipped has no imports. The one for WASI, which is faster to build, imports its standard library's.
const imports = WebAssembly.Module.imports(module);
const isOwn = ({ module, name }) => module === "wasi_snapshot_preview1" || ["wasi.thread-spawn", "env.memory"].includes(`${module}.${name}`);
assert.ok(imports.every(isOwn), "the module asks for nothing from outside");
// Every import is refused except random numbers, which only seed hash tables and so affect no byte.
const refuse = ({ name }) => [name, name === "random_get" ? () => 0 : () => assert.fail(`the module calls ${name}`)];
const wasi_snapshot_preview1 = Object.fromEntries(imports.map(refuse));
const wasi = { "thread-spawn": () => assert.fail("the module starts a thread") };
const env = { memory: new WebAssembly.Memory({ initial: 2 ** 9, maximum: 2 ** 16, shared: true }) };
const { exports: chordal } = await WebAssembly.instantiate(module, { wasi_snapshot_preview1, wasi, env });
chordal._initialize?.();

/** Copies bytes into the module. */
function give(bytes) {
  const at = chordal.chordal_alloc(bytes.length);
  // A new view each time: growing memory detaches the old one.
  new Uint8Array(chordal.memory.buffer, at, bytes.length).set(bytes);
  return [at, bytes.length];
}

/** Copies bytes out of the module. */
function take(at, length) {
  return Buffer.from(new Uint8Array(chordal.memory.buffer, at, length));
}

/** Calls the module as its documentation describes. */
function mesh(input, options) {
  const given = give(input);
  const said = give(new TextEncoder().encode(typeof options === "string" ? options : JSON.stringify(options)));
  const outcome = chordal.chordal_mesh(...given, ...said);
  const result = {
    exit: chordal.chordal_exit(outcome),
    bytes: take(chordal.chordal_bytes(outcome), chordal.chordal_bytes_len(outcome)),
    report: take(chordal.chordal_report(outcome), chordal.chordal_report_len(outcome)).toString(),
    error: take(chordal.chordal_error(outcome), chordal.chordal_error_len(outcome)).toString(),
  };
  chordal.chordal_release(outcome);
  chordal.chordal_free(...given);
  chordal.chordal_free(...said);
  return result;
}

const patches = await readFile(patchFile);
const native = await readFile(nativeFile);
const limits = budget.startsWith("{") ? JSON.parse(budget) : { tol: budget };
const options = { name: basename(patchFile), to: extname(nativeFile).slice(1), ...limits };

const made = mesh(patches, options);
assert.equal(made.error, "");
assert.equal(made.exit, 0);
assert.ok(made.bytes.length > 0, "there is a file");
if (!made.bytes.equals(native)) {
  const at = made.bytes.findIndex((byte, i) => byte !== native[i]);
  console.error(`the files differ from byte ${at} of ${made.bytes.length} (WASM) and ${native.length} (native)`);
  process.exit(1);
}

// The certificate of the call must be the one in the file.
const inFile = {
  glb: () => JSON.parse(native.subarray(20, 20 + native.readUInt32LE(12)).toString()).asset.extras.chordal,
  json: () => JSON.parse(native.toString()).report.certificate,
};
assert.deepEqual(JSON.parse(made.report), inFile[options.to]());

// The module still works after each call, good or bad. Its memory stops growing once each kind of call has run some twenty
// times: how far it grows depends on where the first calls find room (300 calls were tried).
const pages = () => chordal.memory.buffer.byteLength;
const callAll = () => {
  assert.ok(mesh(patches, options).bytes.equals(native), "every call gives the same bytes");
  const cut = mesh(patches.subarray(0, 200), options);
  assert.equal(cut.exit, 3);
  assert.match(cut.error, /./);
  assert.equal(mesh(patches, { ...options, tol: "-1" }).exit, 2);
  assert.equal(mesh(patches, "no JSON").exit, 2);
};
for (let i = 0; i < 40; i++) callAll();
const before = pages();
for (let i = 0; i < 40; i++) callAll();
assert.equal(pages(), before, "memory does not grow from call to call");

console.log(`${basename(nativeFile)}: the same ${native.length} bytes from WASM`);
