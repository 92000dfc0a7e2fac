// Runs Khronos' validator on glTF files, with their external files: no error, no warning, no truncated message.
//
//   node validate.mjs a.glb b.gltf …
import { readFile } from "node:fs/promises";
import { dirname, join, normalize } from "node:path";
import validator from "gltf-validator";

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error("usage: node validate.mjs FILE.glb|FILE.gltf …");
  process.exit(2);
}

/** The validator's messages on one file, as lines; empty if there are none. */
async function complaints(file) {
  const format = file.endsWith(".gltf") ? "gltf" : "glb";
  const externalResourceFunction = async (uri) => {
    const path = normalize(decodeURIComponent(uri));
    if (path.startsWith("..") || path.startsWith("/")) throw new Error(`'${uri}' is no file beside it`);
    return new Uint8Array(await readFile(join(dirname(file), path)));
  };
  const options = { uri: file, format, maxIssues: 100, writeTimestamp: false, externalResourceFunction };
  const report = await validator.validateBytes(new Uint8Array(await readFile(file)), options);
  const { numErrors, numWarnings, truncated, messages } = report.issues;
  const severities = ["error", "warning", "info", "hint"];
  const lines = messages
    // The validator does not treat a missing file as an error.
    .filter((message) => message.severity <= 1 || message.code.startsWith("IO_"))
    .map((m) => `${file}: ${severities[m.severity]} ${m.code} at ${m.pointer ?? `byte ${m.offset}`}: ${m.message}`);
  if (truncated || lines.length < numErrors + numWarnings) lines.push(`${file}: and more`);
  return lines;
}

let failed = false;
for (const file of files) {
  const lines = await complaints(file).catch((error) => [`${file}: ${error.message ?? error}`]);
  lines.forEach((line) => console.error(line));
  failed ||= lines.length > 0;
  if (lines.length === 0) console.log(`${file}: clean`);
}
process.exit(failed ? 1 : 0);
