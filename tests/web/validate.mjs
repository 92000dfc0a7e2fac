// Khronos' validator on GLB files: no error, no warning, no message that was left out.
//
//   node validate.mjs a.glb b.glb …
import { readFile } from "node:fs/promises";
import validator from "gltf-validator";

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error("usage: node validate.mjs FILE.glb …");
  process.exit(2);
}

/** What the validator says of one file, as lines; empty when it is clean. */
async function complaints(file) {
  const options = { uri: file, format: "glb", maxIssues: 100, writeTimestamp: false };
  const report = await validator.validateBytes(new Uint8Array(await readFile(file)), options);
  const { numErrors, numWarnings, truncated, messages } = report.issues;
  const severities = ["error", "warning", "info", "hint"];
  const lines = messages
    .filter((message) => message.severity <= 1)
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
