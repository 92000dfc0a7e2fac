// Runs the command in a worker: one run after the other, each in an instance of its own. Whoever wants to stop a run ends the
// worker.
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
      const buffers = new Set(Object.values(outcome.made).map((bytes) => bytes.buffer as ArrayBuffer));
      reply({ id, outcome }, [...buffers]);
    },
    (error: unknown) => reply({ id, trapped: error instanceof Trapped ? error.message : String(error) }),
  );
});
