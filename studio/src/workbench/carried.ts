// Scripts that a GLB or 3MF carries: opened in place of the file, and the file proved again from them.
import type { Files } from "../core/command";
import type { Controller } from "./controller";
import { BUDGET, type Bench, type Budget, bench } from "./document";
import { faultOf, reportOf } from "./outcome";
import type { Certificate } from "./report";

/** A script in a certificate, as docs/schema/report.schema.json describes it. */
export interface Source {
  name: string;
  text: string;
  parameters?: Readonly<Record<string, number>>;
  files?: readonly { path: string; sha256: string; text?: string }[];
}

/** A file that was opened as the script it carries. */
export interface Carried {
  /** The bench of the file itself. */
  file: Bench;
  /** The bench of its script, as it was opened. */
  script: Bench;
  /** Whether every claim of the file was proved again from its script; `null` while that is running, or if it was stopped. */
  verdict: "re-proved" | "not re-proved" | "refuted" | null;
  isRunning: boolean;
  /** The first claim that was not proved again, in the command's words. */
  reason: string;
}

const MAY_CARRY = /\.(glb|gltf|3mf)$/i;

/** A plain file name, as the command writes it: no folder. */
const NAME = /^[^/\\.][^/\\]{0,80}\.star$/i;

/** The script that an opened file carries, with the parameters and the budget of its mesh; `null` if there is none. */
export async function carriedBy(control: Controller, file: Bench): Promise<Bench | null> {
  if (!MAY_CARRY.test(file.name)) return null;
  const run = await control.runs.runSupported("inspect", ["inspect", file.name], file.files, true);
  const { inspection } = run ? reportOf(run.outcome) : {};
  const certificate = inspection?.found?.certificate;
  const [source] = certificate?.sources ?? [];
  return source && certificate && NAME.test(source.name) ? scriptOf(await withBeside(control, file, source), source, certificate) : null;
}

/** The file with those that its script reads and does not carry, such as fonts, as far as this browser keeps them. */
async function withBeside(control: Controller, file: Bench, { files = [] }: Source): Promise<Bench> {
  const found: Files = {};
  for (const { path, sha256, text } of files) {
    const kept = text === undefined && !file.files[path] ? await control.cupboard?.withDigest(sha256) : null;
    if (kept) found[path] = kept;
  }
  return { ...file, files: { ...found, ...file.files } };
}

function scriptOf(file: Bench, source: Source, certificate: Partial<Certificate>): Bench {
  const encoder = new TextEncoder();
  // Fonts and drawings are not in the file: they may have been opened with it.
  const files: Files = { ...file.files };
  delete files[file.name];
  for (const { path, text } of source.files ?? []) if (text !== undefined) files[path] = encoder.encode(text);
  files[source.name] = encoder.encode(source.text);
  const set = Object.fromEntries(Object.entries(source.parameters ?? {}).map(([name, value]) => [name, String(value)]));
  return { ...bench(source.name, files), set, budget: budgetOf(certificate.budget ?? null) };
}

/** The budget of a certificate. Pixels need a view of one's own, so that the length that they became counts. */
function budgetOf(facts: Certificate["budget"]): Budget {
  if (facts?.length) return { ...BUDGET, by: "tol", tol: String(facts.length) };
  if (facts?.triangles) return { ...BUDGET, by: "triangles", triangles: String(facts.triangles) };
  return BUDGET;
}

/** Proves the claims of the file again, from the script that it carries. */
export async function verifyCarried(control: Controller, file: Bench, script: Bench): Promise<void> {
  const carried: Carried = { file, script, verdict: null, isRunning: true, reason: "" };
  control.change({ carried });
  // What the file does not carry, such as fonts, the script has been given.
  const { [script.name]: _, ...beside } = script.files;
  const run = await control.runs.runSupported("verify", ["verify", file.name], { ...beside, ...file.files }, true);
  if (control.state.carried !== carried) return;
  const report = run ? (reportOf(run.outcome) as { verdict?: Carried["verdict"]; claims?: { claim: string; verdict: string; reason?: string }[] }) : {};
  const open = report.claims?.find(({ verdict }) => verdict !== "re-proved");
  const reason = open ? `${open.claim}: ${open.reason ?? open.verdict}` : (run && !report.verdict && faultOf(run.outcome).text) || "";
  control.change({ carried: { ...carried, verdict: report.verdict ?? null, isRunning: false, reason } });
}
