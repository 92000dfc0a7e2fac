// Links the modules of the pages from one compiled library. A module has the exports that its page or its exhibits ask, and the
// linker leaves out what they do not use: compiling takes minutes, each of these links a third of a second.
//
//   node scripts/link.mjs libchordal_wasm.a    writes wasm/chordal.wasm, wasm/exhibits.wasm and wasm/exhibits/*.wasm
//   node scripts/link.mjs chordal_wasm.wasm    copies one module with all exports to each of these names
//
// Tests copy: their module is compiled for another target, and which of its exports a page asks is the same there.
import { execFileSync } from "node:child_process";
import { copyFile, mkdir, readFile, readdir, rm } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const root = join(dirname(fileURLToPath(import.meta.url)), "..");
const exhibitsOf = JSON.parse(await readFile(join(root, "src/exhibits/modules.json"), "utf8"));
const source = process.argv[2];
if (!source) throw new Error("link.mjs needs the compiled library, an archive or a module");

/** What every module exports. */
const ALWAYS = ["alloc", "free", "exit", "bytes", "bytes_len", "report", "report_len", "error", "error_len", "release"];
const WIDGET = ["study", "ladder", "seam"];
/** What is asked only while pages are written: the lesson's table. */
const WRITTEN = ["rivals"];
const exhibits = (ids) => ids.map((id) => `exhibit_${id}`);
const modules = {
  "chordal.wasm": WIDGET,
  "exhibits.wasm": [...WIDGET, ...exhibits([...Object.values(exhibitsOf).flat(), ...WRITTEN])],
  ...Object.fromEntries(Object.entries(exhibitsOf).map(([name, ids]) => [`exhibits/${name}.wasm`, exhibits(ids)])),
};

/** The linker that comes with the compiler. */
async function linker() {
  const rustc = (...what) => execFileSync("rustc", what, { encoding: "utf8", cwd: root }).trim();
  const host = /host: (.*)/.exec(rustc("-vV"))[1];
  return join(rustc("--print", "sysroot"), "lib/rustlib", host, "bin/rust-lld");
}

const out = join(root, "wasm");
await mkdir(join(out, "exhibits"), { recursive: true });
// What is no longer in the table is not left behind.
for (const name of await readdir(join(out, "exhibits"))) {
  if (!(`exhibits/${name}` in modules)) await rm(join(out, "exhibits", name));
}
if (source.endsWith(".wasm")) {
  for (const name of Object.keys(modules)) await copyFile(source, join(out, name));
} else {
  const lld = await linker();
  // As rustc links a module: the stack comes first, so that one that overflows traps instead of writing over data.
  const flags = ["-flavor", "wasm", "--no-entry", "--gc-sections", "-O2", "--strip-all", "-z", "stack-size=1048576", "--stack-first"];
  for (const [name, exports] of Object.entries(modules)) {
    const named = [...ALWAYS, ...exports].map((symbol) => `--export=chordal_${symbol}`);
    execFileSync(lld, [...flags, ...named, source, "-o", join(out, name)], { stdio: "inherit" });
  }
}
