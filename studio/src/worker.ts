// Runs the core in a worker: loads the module once, answers one call after the other.
import { Broken, Core, Refused } from "./core/module";
import type { Call, Reply } from "./core/types";

const file = new URL("../wasm/chordal.wasm", import.meta.url);

async function load(): Promise<Core> {
  const response = await fetch(file);
  if (!response.ok) throw new Broken(`${response.status}`);
  // Not instantiateStreaming, because it requires a media type that some hosts do not send.
  return Core.load(await response.arrayBuffer());
}

const loading = load();
// Every question reports the failure; this only prevents an unhandled rejection before the first one.
loading.catch(() => undefined);

addEventListener("message", (event: MessageEvent<Call>) => {
  void answer(event.data).then((reply) => postMessage(reply));
});

async function answer({ id, kind, question }: Call): Promise<Reply> {
  try {
    const core = await loading;
    return { id, answer: core.ask(kind, question as never) };
  } catch (error) {
    const message = error instanceof Error ? error.message : String(error);
    return error instanceof Refused ? { id, refused: message } : { id, broken: message };
  }
}
