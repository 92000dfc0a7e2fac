// The command's module in a page: fetched and compiled when it is first needed, once for all workers of the page.
import { Crews, type ThreadWorkerLike, threadsOfPage } from "./crew";
import { Jobs, type WorkerLike } from "./jobs";

const file = new URL("../../wasm/command.wasm", import.meta.url);

let compiled: Promise<WebAssembly.Module> | undefined;
/** Compiles the module once; after a failure the next call tries again. */
function module(): Promise<WebAssembly.Module> {
  compiled ??= fetch(file).then(async (response) => {
    if (!response.ok) throw new Error(`${response.status}`);
    // Not compileStreaming, because it requires a media type that some hosts do not send.
    return WebAssembly.compile(await response.arrayBuffer());
  });
  compiled.catch(() => (compiled = undefined));
  return compiled;
}

const worker = (): WorkerLike => new Worker(new URL("./command_worker.ts", import.meta.url), { type: "module" });
const threadWorker = (): ThreadWorkerLike => new Worker(new URL("./thread_worker.ts", import.meta.url), { type: "module" });

/** The lanes of a page, in which it runs the command, or another module. Without a list the runs of all lanes have threads. */
export function commandJobs<Name extends string>(threaded?: readonly Name[], of = module): Jobs<Name> {
  const threads = threadsOfPage();
  const crews = threads > 1 ? new Crews(threadWorker, threads - 1) : undefined;
  return new Jobs<Name>(of, worker, crews, (name) => threaded?.includes(name) ?? true);
}
