// The command itself as a module for WASI: words and files in, files and what was said out. It runs in the worker, and in
// tests in Node. Every run is a new instance with a folder of its own, so no run can leave anything to the next.
import { ConsoleStdout, Directory, Fd, File, PreopenDirectory, WASI, wasi as defs } from "@bjorn3/browser_wasi_shim";

export type Files = Record<string, Uint8Array>;

export interface Outcome {
  /** 0, or what the command ends with: see `chordal --help`. */
  exit: number;
  /** The report, with --json. */
  stdout: string;
  /** Sentences, a line each. */
  stderr: string;
  /** What was not there before; names in folders have slashes. */
  made: Files;
}

export interface Progress {
  stage: string;
  percent: number;
}

/** The module trapped: out of memory or of stack, or a fault of ours. Another instance is as good as new. */
export class Trapped extends Error {}

/** Nothing to read. */
class NoInput extends Fd {
  override fd_read() {
    return { ret: defs.ERRNO_SUCCESS, data: new Uint8Array() };
  }
}

export async function run(
  module: WebAssembly.Module,
  words: readonly string[],
  files: Files,
  progressed: (progress: Progress) => void = () => undefined,
): Promise<Outcome> {
  const [out, err] = [new Said(), new Said(progressed)];
  const inputs = new Map(Object.entries(files).map(([name, bytes]) => [name, new File(bytes)]));
  const folder = new PreopenDirectory(".", new Map(inputs));
  const wasi = new WASI(["chordal", ...words], [], [new NoInput(), out.fd, err.fd, folder], { debug: false });
  const instance = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: wasi.wasiImport });
  let exit: number;
  try {
    exit = wasi.start(instance as Parameters<WASI["start"]>[0]);
  } catch (error) {
    throw new Trapped([err.text, String(error)].filter(Boolean).join("\n"));
  }
  const made: Files = {};
  collect(folder.dir, "", (name, file) => {
    if (inputs.get(name) !== file) made[name] = file.data;
  });
  return { exit, stdout: out.text, stderr: err.text, made };
}

function collect(folder: Directory, prefix: string, take: (name: string, file: File) => void): void {
  for (const [name, entry] of folder.contents) {
    if (entry instanceof Directory) collect(entry, `${prefix}${name}/`, take);
    else if (entry instanceof File) take(prefix + name, entry);
  }
}

/** What is written to a stream. Progress is no text: a carriage return, the stage, the percentage. */
class Said {
  text = "";
  private readonly decoder = new TextDecoder();
  readonly fd = new ConsoleStdout((bytes) => {
    const said = this.decoder.decode(bytes, { stream: true });
    const progress = this.progressed && /^\r(.+) (\d+)$/.exec(said);
    if (progress) this.progressed!({ stage: progress[1]!, percent: Number(progress[2]) });
    else this.text += said;
  });
  constructor(private readonly progressed?: (progress: Progress) => void) {}
}
