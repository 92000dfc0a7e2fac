// Calls the WASM module through a typed function: in the worker, in Node at build time, and in the tests.
import type { AnswerOf, ExhibitQuestion, Kind, QuestionOf } from "./types";

/** The export that answers a question: every exhibit has its own, and a module has those of its pages. */
type AskExport = `chordal_exhibit_${string}` | `chordal_${Exclude<Kind, "exhibit">}`;
const exportOf = (kind: Kind, question: QuestionOf<Kind>): AskExport =>
  kind === "exhibit" ? `chordal_exhibit_${(question as ExhibitQuestion).exhibit}` : `chordal_${kind}`;

interface Exports {
  [ask: `chordal_exhibit_${string}`]: (address: number, length: number) => number;
  chordal_study(address: number, length: number): number;
  chordal_ladder(address: number, length: number): number;
  chordal_seam(address: number, length: number): number;
  memory: WebAssembly.Memory;
  /** Of the modules that tests load. */
  _initialize?(): void;
  chordal_alloc(length: number): number;
  chordal_free(address: number, length: number): void;
  chordal_exit(outcome: number): number;
  chordal_bytes(outcome: number): number;
  chordal_bytes_len(outcome: number): number;
  chordal_report(outcome: number): number;
  chordal_report_len(outcome: number): number;
  chordal_error(outcome: number): number;
  chordal_error_len(outcome: number): number;
  chordal_release(outcome: number): void;
}

/** ENOSYS of WASI. */
const NOT_SUPPORTED = 52;
/** EAGAIN of WASI, negative as its threads ask for it. */
const NO_THREAD = -6;
const answer = (name: string | symbol) => () => (name === "random_get" ? 0 : NOT_SUPPORTED);
/**
 * The host for the WASI modules that tests load. Every import is refused except random numbers, which only seed hash
 * tables and so affect no answer; they are left zero. The memory is as the Makefile links it, and new for each module. The
 * modules that are shipped import nothing.
 */
export const HOST = {
  wasi_snapshot_preview1: new Proxy({}, { get: (_, name) => answer(name) }),
  wasi: { "thread-spawn": () => NO_THREAD },
  get env() {
    return { memory: new WebAssembly.Memory({ initial: 2 ** 9, maximum: 2 ** 14, shared: true }) };
  },
};

/** The core understood the question and refused it with a message. The module can still be used. */
export class Refused extends Error {}

/** The module trapped, or is not a Chordal module. It must not be called again. */
export class Broken extends Error {}

export class Core {
  private isBroken = false;
  private constructor(private readonly exports: Exports) {}

  static async load(bytes: BufferSource): Promise<Core> {
    try {
      const { instance } = await WebAssembly.instantiate(bytes, HOST);
      const exports = instance.exports as unknown as Exports;
      exports._initialize?.();
      return new Core(exports);
    } catch (error) {
      throw new Broken(String(error));
    }
  }

  /** Asks one question. Throws [`Refused`] or [`Broken`]. */
  ask<K extends Kind>(kind: K, question: QuestionOf<K>): AnswerOf<K> {
    if (this.isBroken) throw new Broken("the module trapped before");
    let reply: ModuleReply;
    try {
      reply = this.call(exportOf(kind, question), new TextEncoder().encode(JSON.stringify(question)));
    } catch (error) {
      // After a trap the module's memory may be in any state.
      this.isBroken = true;
      throw new Broken(String(error));
    }
    if ("refused" in reply) throw new Refused(reply.refused);
    const { answer, arrays } = reply;
    return JSON.parse(answer, arrays && ((_, value: unknown) => arrayOf(value, arrays))) as AnswerOf<K>;
  }

  private call(name: AskExport, question: Uint8Array): ModuleReply {
    const core = this.exports;
    const address = core.chordal_alloc(question.length);
    // Growing memory detaches every view, so each view is created right before its use.
    new Uint8Array(core.memory.buffer, address, question.length).set(question);
    const outcome = core[name]!(address, question.length);
    // Copies: no browser decodes text in a shared memory, as that of the tests' modules is.
    const copy = (start: number, length: number) => new Uint8Array(core.memory.buffer, start, length).slice();
    const bytes = (start: number, length: number) => copy(start, length).buffer;
    const text = (start: number, length: number) => new TextDecoder().decode(copy(start, length));
    const exit = core.chordal_exit(outcome);
    const length = core.chordal_bytes_len(outcome);
    const reply: ModuleReply =
      exit === 0
        ? {
            answer: text(core.chordal_report(outcome), core.chordal_report_len(outcome)),
            arrays: length ? bytes(core.chordal_bytes(outcome), length) : undefined,
          }
        : { refused: text(core.chordal_error(outcome), core.chordal_error_len(outcome)) };
    core.chordal_release(outcome);
    core.chordal_free(address, question.length);
    return reply;
  }
}

/** The module's reply: an error message, or the answer as JSON and the bytes of the answer's arrays. */
type ModuleReply = { refused: string } | { answer: string; arrays: ArrayBuffer | undefined };

/** Replaces `{"f32": [start, length]}` in the JSON by the numbers at that place in the bytes. */
function arrayOf(value: unknown, arrays: ArrayBuffer): unknown {
  if (typeof value !== "object" || value === null) return value;
  if ("f32" in value) return new Float32Array(arrays, ...(value.f32 as [number, number]));
  if ("u32" in value) return new Uint32Array(arrays, ...(value.u32 as [number, number]));
  return value;
}
