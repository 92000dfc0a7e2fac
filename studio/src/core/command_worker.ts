// Runs the command in a worker, one run after the other, each in its own instance. To cancel a run, the worker is
// terminated.
import { type Files, type Outcome, type Progress, Trapped, run } from "./command";

export interface Order {
  id: number;
  module: WebAssembly.Module;
  words: readonly string[];
  files: Files;
}

export type Reply =
  | { id: number; progress: Progress }
  | { id: number; outcome: Outcome }
  | { id: number; trapped: string };

addEventListener("message", ({ data: { id, module, words, files } }: MessageEvent<Order>) => {
  const reply = (message: Reply, buffers: Transferable[] = []) => postMessage(message, { transfer: buffers });
  run(module, words, files, (progress) => reply({ id, progress })).then(
    (outcome) => {
      // Outputs may share a buffer, and a buffer is transferred once.
      const buffers = new Set(Object.values(outcome.outputs).map((bytes) => bytes.buffer as ArrayBuffer));
      reply({ id, outcome }, [...buffers]);
    },
    (error: unknown) => reply({ id, trapped: error instanceof Trapped ? error.message : String(error) }),
  );
});
