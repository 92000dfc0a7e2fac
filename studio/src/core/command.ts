// Runs the command as a WASI module: arguments and files in, output files and messages out. It runs in the worker, and in
// tests in Node. Every run is a new instance with its own memory and folder, so that no run can affect the next. A run has a
// crew where workers may share memory: each carries a thread, with an instance of its own in the memory of the run.
import { ThreadSlots } from "./thread_slots";
import type { ThreadOrder } from "./thread_worker";
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

/** The memory of a run, and the slots of its threads beside the one of the run itself. */
export interface Crew {
  memory: WebAssembly.Memory;
  slots: WebAssembly.Memory;
  count: number;
}

const PAGE_BYTES = 65_536;
/**
 * A memory at its start: half as much again as the module asks for, whose stack is 16 MiB. What it does not touch costs nothing.
 * And at most, as the Makefile links it.
 */
const [FIRST_PAGES, MOST_PAGES] = [2 ** 25 / PAGE_BYTES, 2 ** 32 / PAGE_BYTES];

/**
 * The memory of a run: all that a module can address, or as much as the browser sets aside. Shared, because so the module was
 * linked, also where no other worker may have it.
 */
export function runMemory(most = MOST_PAGES): WebAssembly.Memory {
  try {
    return new WebAssembly.Memory({ initial: FIRST_PAGES, maximum: most, shared: true });
  } catch (error) {
    // Telephones set less aside than they have.
    if (most / 2 < FIRST_PAGES) throw error;
    return runMemory(most / 2);
  }
}

/** The standard output of a thread, which has nothing to say there. */
class NoOutput extends Fd {
  override fd_write(bytes: Uint8Array) {
    return { ret: defs.ERRNO_SUCCESS, nwritten: bytes.length };
  }
}

/** A run without workers beside its own. */
export const alone = (): Crew => ({ memory: runMemory(), slots: ThreadSlots.of(0).memory, count: 0 });

export async function run(
  module: WebAssembly.Module,
  words: readonly string[],
  files: Files,
  progressed: (progress: Progress) => void = () => undefined,
  crew = alone(),
): Promise<Outcome> {
  const [stdout, stderr] = [new Output(), new Output(progressed)];
  const inputs = new Map(Object.entries(files).map(([name, bytes]) => [name, new File(bytes)]));
  const folder = new PreopenDirectory(".", new Map(inputs));
  const slots = new ThreadSlots(crew.slots, crew.count);
  // The number of threads, this one among them.
  const settings = [`RAYON_NUM_THREADS=${crew.count + 1}`];
  const wasi = new WASI(["chordal", ...words], settings, [new NoInput(), stdout.fd, stderr.fd, folder], { debug: false });
  const instance = await WebAssembly.instantiate(module, imports(wasi, crew.memory, slots));
  let exit: number;
  try {
    exit = wasi.start(instance as Parameters<WASI["start"]>[0]);
  } catch (error) {
    throw new Trapped([stderr.text, String(error)].filter(Boolean).join("\n"));
  } finally {
    slots.end();
  }
  const outputs: Files = {};
  collect(folder.dir, "", (name, file) => {
    if (inputs.get(name) !== file) outputs[name] = file.data;
  });
  return { exit, stdout: stdout.text, stderr: stderr.text, outputs };
}

/** Runs the threads of a slot until their run is over. A thread has no files; what it prints before a trap is its message. */
export async function runThreads({ module, memory, slots: shared, count, slot }: ThreadOrder, progressed: (progress: Progress) => void): Promise<void> {
  const stderr = new Output(progressed);
  const slots = new ThreadSlots(shared, count);
  const wasi = new WASI([], [], [new NoInput(), new NoOutput(), stderr.fd], { debug: false });
  const instance = await WebAssembly.instantiate(module, imports(wasi, memory, slots));
  wasi.inst = instance as Parameters<WASI["start"]>[0];
  const start = instance.exports["wasi_thread_start"] as (id: number, told: number) => void;
  try {
    slots.serve(slot, start);
  } catch (error) {
    throw new Trapped([stderr.text, String(error)].filter(Boolean).join("\n"));
  }
}

function imports(wasi: WASI, memory: WebAssembly.Memory, slots: ThreadSlots): WebAssembly.Imports {
  // A browser fills no shared memory with random bytes.
  const random_get = (address: number, length: number): number => {
    const bytes = new Uint8Array(length);
    for (let at = 0; at < length; at += MOST_RANDOM_BYTES) crypto.getRandomValues(bytes.subarray(at, at + MOST_RANDOM_BYTES));
    new Uint8Array(memory.buffer).set(bytes, address);
    return defs.ERRNO_SUCCESS;
  };
  // Workers count from when each was started, and the threads of a run have one clock.
  const clock_time_get = (_clock: number, _precision: bigint, address: number): number => {
    const milliseconds = performance.timeOrigin + performance.now();
    new DataView(memory.buffer).setBigUint64(address, BigInt(Math.round(milliseconds * 1000)) * 1000n, true);
    return defs.ERRNO_SUCCESS;
  };
  return {
    wasi_snapshot_preview1: { ...wasi.wasiImport, random_get, clock_time_get },
    wasi: { "thread-spawn": (told: number) => slots.start(told) },
    env: { memory },
  };
}

/** Defined by `crypto.getRandomValues`. */
const MOST_RANDOM_BYTES = 65_536;

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
