// Runs of the command in a page, for the tests of its threads.
import type { Outcome } from "../../../src/core/command";
import { commandJobs } from "../../../src/core/command_module";
import type { Stopped } from "../../../src/core/jobs";

/** What a run gave; files in base 64, since long arrays take seconds to the test. */
interface Ran {
  exit: number;
  stdout: string;
  stderr: string;
  outputs: Record<string, string>;
  /** The threads that the run has started beside its own. */
  started: number;
  milliseconds: number;
  /** The largest memory that a run has had. */
  bytes: number;
}

declare global {
  var ran: (words: string[], files: Record<string, string>) => Promise<Ran>;
  /** As `ran`, but cancelled as soon as it says how far it is. Why it ended. */
  var cancelled: (words: string[], files: Record<string, string>) => Promise<string>;
  /** Runs another module. Why it ended. */
  var ended: (module: string) => Promise<string>;
}

const decoded = (base64: string) => Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
const encoded = (bytes: Uint8Array) => {
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  return btoa(text);
};
const given = (files: Record<string, string>) => Object.fromEntries(Object.entries(files).map(([name, base64]) => [name, decoded(base64)]));

let slots: WebAssembly.Memory | undefined;
let memory: WebAssembly.Memory | undefined;
const { postMessage } = Worker.prototype;
Worker.prototype.postMessage = function (order: { slots?: WebAssembly.Memory; memory?: WebAssembly.Memory }) {
  ({ slots = slots, memory = memory } = order);
  return postMessage.call(this, order);
};

const jobs = commandJobs<"job">();
globalThis.ran = async (words, files) => {
  slots = memory = undefined;
  const start = performance.now();
  const outcome: Outcome = await jobs.run("job", words, given(files));
  const milliseconds = performance.now() - start;
  const outputs = Object.fromEntries(Object.entries(outcome.outputs).map(([name, bytes]) => [name, encoded(bytes)]));
  // The second word is the number of the thread that was started last.
  const started = slots ? new Int32Array((slots as WebAssembly.Memory).buffer)[1]! : 0;
  const bytes = (memory as WebAssembly.Memory | undefined)?.buffer.byteLength ?? 0;
  return { ...outcome, outputs, started, milliseconds, bytes };
};
globalThis.cancelled = async (words, files) => {
  try {
    await jobs.run("job", words, given(files), () => jobs.cancel("job"));
    return "came to its end";
  } catch (error) {
    return (error as Stopped).why;
  }
};
globalThis.ended = async (module) => {
  const others = commandJobs<"job">(undefined, () => WebAssembly.compile(decoded(module)));
  try {
    await others.run("job", [], {});
    return "came to its end";
  } catch (error) {
    return `${(error as Stopped).why}: ${(error as Stopped).message}`;
  }
};
