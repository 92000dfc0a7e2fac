// What the export buttons write: the mesh that was proved and is shown, as it is or converted, which takes milliseconds; and
// what the command makes of the input itself, such as tiles. A run that fails is a sentence, never a file.
import type { Controller } from "./controller";
import type { Files } from "../core/command";
import { type Line, outputOf, stem } from "./document";
import { type Fault, faultOf, madeBy } from "./outcome";
import type { Shown, State } from "./state";

export const MESH_FORMATS = ["glb", "3mf", "stl", "ply", "obj"] as const;
export type MeshFormat = (typeof MESH_FORMATS)[number];

/** The state of the latest export. */
export type Exported =
  | { state: "waiting"; name: string }
  | { state: "written"; name: string; bytes: number }
  /** Without a fault the reason is that there is no proved mesh, or that the input changed before there was one. */
  | { state: "failed"; name: string; fault: Fault | null; isChanged?: true };

/** With this option a conversion that changes no coordinate keeps the certificate of the mesh. */
const KEEP_CERTIFICATE = "--keep-certificate";

/** The mesh of the current input, once its proof has ended; `null` if there is none. */
export const isProved = ({ shown, bench }: State): boolean => shown !== null && shown.bench === bench && !shown.isDraft;

/**
 * Whether a GLB of the shape has its coordinates as they are: it is always in metres with y up, so a shape in another frame is
 * turned and scaled there, and has to be meshed again for other formats.
 */
function keepsFrame({ bench, certificate: { frame } }: Shown): boolean {
  const isGltf = /\.(glb|gltf)$/i.test(bench.name);
  return isGltf || (frame.up === null && frame.metres_per_unit === null);
}

/** Writes the mesh of the current input in a format. `null` if that failed; the state says why. */
export async function exportMesh(control: Controller, format: MeshFormat): Promise<Files | null> {
  const { bench } = control.state;
  const name = outputOf(bench, `${stem(bench.name)}.${format}`);
  control.change({ exported: { state: "waiting", name } });
  // A proof may be running; the file is that of the proved mesh, as its certificate says.
  await control.until((state) => state.bench !== bench || isProved(state) || (state.ended === bench && !state.isWaiting));
  const { shown } = control.state;
  if (control.state.bench !== bench) {
    control.change({ exported: { state: "failed", name, fault: null, isChanged: true } });
    return null;
  }
  if (!shown || !isProved(control.state)) return failed(control, name, null);
  if (format === "glb") return done(control, name, { [name]: shown.bytes });
  if (!keepsFrame(shown)) return exportLine(control, control.line(name), name);
  const mesh = `${stem(bench.name)}.glb`;
  const line = ["convert", mesh, name === mesh ? `out-${name}` : name];
  const files = { [mesh]: shown.bytes };
  const kept = await convert(control, [...line, KEEP_CERTIFICATE], files);
  if (kept) return kept;
  // STL has no room for a certificate and no frame. 3MF has one, and would turn the shape.
  return format === "3mf" ? exportLine(control, control.line(name), name) : exportLine(control, line, name, files);
}

/** Runs a line whose outputs are downloaded. */
export async function exportLine(control: Controller, line: Line, name: string, files: Files = control.state.bench.files): Promise<Files | null> {
  control.change({ exported: { state: "waiting", name } });
  const run = await control.runs.runSupported("export", line, files, false);
  if (!run) {
    // Stopped, or out of memory, which the page says elsewhere.
    control.change({ exported: null });
    return null;
  }
  const outputs = madeBy(run.outcome, run.line);
  return outputs ? done(control, name, outputs) : failed(control, name, faultOf(run.outcome));
}

async function convert(control: Controller, line: Line, files: Files): Promise<Files | null> {
  const run = await control.runs.runSupported("export", line, files, false);
  // A module without the option would turn the shape of a 3MF.
  const outputs = run?.line.includes(KEEP_CERTIFICATE) ? madeBy(run.outcome, run.line) : null;
  return outputs && done(control, line[2]!, outputs);
}

function done(control: Controller, name: string, files: Files): Files {
  const bytes = Object.values(files).reduce((sum, { length }) => sum + length, 0);
  control.change({ exported: { state: "written", name, bytes } });
  return files;
}

function failed(control: Controller, name: string, fault: Fault | null): null {
  control.change({ exported: { state: "failed", name, fault } });
  return null;
}
