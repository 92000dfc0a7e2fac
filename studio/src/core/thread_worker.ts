// Carries threads of the command: one run after the other, each with the instance and the slot that the run has here. A worker
// whose threads do not end is terminated with its run.
import { type Progress, runThreads } from "./command";

/** What a run hands to the workers of its threads. */
export interface ThreadOrder {
  module: WebAssembly.Module;
  memory: WebAssembly.Memory;
  slots: WebAssembly.Memory;
  count: number;
  slot: number;
}

/** A thread has ended the run; or it got on; or the run is over, and the worker is free for the next. */
export type ThreadReply = { trapped: string } | { progress: Progress } | "free";

addEventListener("message", ({ data: order }: MessageEvent<ThreadOrder>) => {
  const reply = (message: ThreadReply) => postMessage(message);
  runThreads(order, (progress) => reply({ progress })).then(
    () => reply("free"),
    (error: unknown) => reply({ trapped: error instanceof Error ? error.message : String(error) }),
  );
});
