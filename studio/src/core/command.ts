// Runs the command as a WASI module: arguments and files in, output files and messages out. It runs in the worker, and in
// tests in Node. Every run is a new instance with its own folder, so that no run can affect the next.
import { ConsoleStdout, Directory, Fd, File, PreopenDirectory, WASI, wasi as defs } from "@bjorn3/browser_wasi_shim";

export type Files = Record<string, Uint8Array>;

export interface Outcome {
  /** The exit code: 0 is success, the others are listed by `chordal --help`. */
  exit: number;
  /** The report, with --json. */
  stdout: string;
  /** Messages, one a line. */
  stderr: string;
  /** The files that were written; names in folders have slashes. */
  outputs: Files;
}

export interface Progress {
  stage: string;
  percent: number;
}

/** The module trapped: out of memory or stack, or a bug. A new instance works again. */
export class Trapped extends Error {}

/** An empty standard input. */
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
  const [stdout, stderr] = [new Output(), new Output(progressed)];
  const inputs = new Map(Object.entries(files).map(([name, bytes]) => [name, new File(bytes)]));
  const folder = new PreopenDirectory(".", new Map(inputs));
  const wasi = new WASI(["chordal", ...words], [], [new NoInput(), stdout.fd, stderr.fd, folder], { debug: false });
  const instance = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: wasi.wasiImport });
  let exit: number;
  try {
    exit = wasi.start(instance as Parameters<WASI["start"]>[0]);
  } catch (error) {
    throw new Trapped([stderr.text, String(error)].filter(Boolean).join("\n"));
  }
  const outputs: Files = {};
  collect(folder.dir, "", (name, file) => {
    if (inputs.get(name) !== file) outputs[name] = file.data;
  });
  return { exit, stdout: stdout.text, stderr: stderr.text, outputs };
}

function collect(folder: Directory, prefix: string, add: (name: string, file: File) => void): void {
  for (const [name, entry] of folder.contents) {
    if (entry instanceof Directory) collect(entry, `${prefix}${name}/`, add);
    // A hidden file, such as the lock of a folder, is the command's own and no output.
    else if (entry instanceof File && !name.startsWith(".")) add(prefix + name, entry);
  }
}

/** Collects the text of a stream. A progress line is no text: a carriage return, the stage, the percentage. */
class Output {
  text = "";
  private readonly decoder = new TextDecoder();
  readonly fd = new ConsoleStdout((bytes) => {
    const text = this.decoder.decode(bytes, { stream: true });
    const progress = this.progressed && /^\r(.+) (\d+)$/.exec(text);
    if (progress) this.progressed!({ stage: progress[1]!, percent: Number(progress[2]) });
    else this.text += text;
  });
  constructor(private readonly progressed?: (progress: Progress) => void) {}
}
