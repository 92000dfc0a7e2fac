// Runs the command in a worker, one run after the other, each in its own instance. To cancel a run, the worker is
// terminated.
import { type Crew, type Files, type Outcome, type Progress, Trapped, alone, run } from "./command";

export interface Order {
  id: number;
  module: WebAssembly.Module;
  words: readonly string[];
  files: Files;
  /** Where workers may share memory: whose threads the run may start. */
  crew?: Crew | undefined;
}

export type Reply =
  | { id: number; progress: Progress }
  /** With the bytes of the run's memory, which is dropped. */
  | { id: number; outcome: Outcome; bytes: number }
  | { id: number; trapped: string };

addEventListener("message", ({ data: { id, module, words, files, crew = alone() } }: MessageEvent<Order>) => {
  const reply = (message: Reply, buffers: Transferable[] = []) => postMessage(message, { transfer: buffers });
  run(module, words, files, (progress) => reply({ id, progress }), crew).then(
    (outcome) => {
      // Outputs may share a buffer, and a buffer is transferred once.
      const buffers = new Set(Object.values(outcome.outputs).map((bytes) => bytes.buffer as ArrayBuffer));
      reply({ id, outcome, bytes: crew.memory.buffer.byteLength }, [...buffers]);
    },
    (error: unknown) => reply({ id, trapped: error instanceof Trapped ? error.message : String(error) }),
  );
});
