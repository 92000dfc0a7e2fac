// Runs the exhibits' cores in a worker: loads a module when the first of its exhibits asks, answers one call after the other.
import { Broken, Refused } from "../core/module";
import type { Call, ExhibitQuestion, Reply } from "../core/types";
import { ExhibitCores } from "./modules";

const files = import.meta.glob<string>("../../wasm/exhibits/*.wasm", { query: "?url", import: "default", eager: true });

const cores = new ExhibitCores(async (module) => {
  const response = await fetch(files[`../../wasm/exhibits/${module}.wasm`]!);
  if (!response.ok) throw new Broken(`${response.status}`);
  // Not instantiateStreaming, because it requires a media type that some hosts do not send.
  return response.arrayBuffer();
});

addEventListener("message", (event: MessageEvent<Call>) => {
  void answer(event.data).then((reply) => postMessage(reply));
});

async function answer({ id, question }: Call): Promise<Reply> {
  try {
    return { id, answer: await cores.ask(question as ExhibitQuestion) };
  } catch (error) {
    const message = error instanceof Error ? error.message : String(error);
    return error instanceof Refused ? { id, refused: message } : { id, broken: message };
  }
}
