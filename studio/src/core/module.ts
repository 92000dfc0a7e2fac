// The WASM module behind a typed function. It runs in the worker, at build time in Node, and in the tests.
import type { AnswerOf, Kind, QuestionOf } from "./types";

interface Exports {
  memory: WebAssembly.Memory;
  chordal_alloc(length: number): number;
  chordal_free(at: number, length: number): void;
  chordal_study(at: number, length: number): number;
  chordal_ladder(at: number, length: number): number;
  chordal_seam(at: number, length: number): number;
  /** Only in the module of the exhibits. */
  chordal_exhibit(at: number, length: number): number;
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
const answer = (name: string | symbol) => () => (name === "random_get" ? 0 : NOT_SUPPORTED);
/**
 * The host of modules for WASI, which tests load: all is refused but the keys of hash tables, on which no answer
 * depends. Modules that are shipped ask for nothing.
 */
export const HOST = { wasi_snapshot_preview1: new Proxy({}, { get: (_, name) => answer(name) }) };

/** The core understood the question and refuses it, in a sentence. The module is as good as before. */
export class Refused extends Error {}

/** The module trapped, or is none of ours. It must not be called again. */
export class Broken extends Error {}

export class Core {
  private broken = false;
  private constructor(private readonly exports: Exports) {}

  static async load(bytes: BufferSource): Promise<Core> {
    try {
      const { instance } = await WebAssembly.instantiate(bytes, HOST);
      return new Core(instance.exports as unknown as Exports);
    } catch (error) {
      throw new Broken(String(error));
    }
  }

  /** Asks one question. Throws [`Refused`] or [`Broken`]. */
  ask<K extends Kind>(kind: K, question: QuestionOf<K>): AnswerOf<K> {
    if (this.broken) throw new Broken("the module trapped before");
    let outcome: Said;
    try {
      outcome = this.call(kind, new TextEncoder().encode(JSON.stringify(question)));
    } catch (error) {
      // After a trap the module's memory may be in any state.
      this.broken = true;
      throw new Broken(String(error));
    }
    if ("refused" in outcome) throw new Refused(outcome.refused);
    const { answer, arrays } = outcome;
    return JSON.parse(answer, arrays && ((_, value: unknown) => arrayOf(value, arrays))) as AnswerOf<K>;
  }

  private call(kind: Kind, question: Uint8Array): Said {
    const core = this.exports;
    const at = core.chordal_alloc(question.length);
    // Growing memory detaches every view, so each is made anew where it is used.
    new Uint8Array(core.memory.buffer, at, question.length).set(question);
    const outcome = core[`chordal_${kind}`](at, question.length);
    const bytes = (start: number, length: number) => core.memory.buffer.slice(start, start + length);
    const text = (start: number, length: number) => new TextDecoder().decode(new Uint8Array(core.memory.buffer, start, length));
    const exit = core.chordal_exit(outcome);
    const length = core.chordal_bytes_len(outcome);
    const said: Said =
      exit === 0
        ? {
            answer: text(core.chordal_report(outcome), core.chordal_report_len(outcome)),
            arrays: length ? bytes(core.chordal_bytes(outcome), length) : undefined,
          }
        : { refused: text(core.chordal_error(outcome), core.chordal_error_len(outcome)) };
    core.chordal_release(outcome);
    core.chordal_free(at, question.length);
    return said;
  }
}

/** What the module said: its sentence, or its answer with the bytes that arrays of the answer lie in. */
type Said = { refused: string } | { answer: string; arrays: ArrayBuffer | undefined };

/** `{"f32": [start, length]}` stands for numbers among the bytes. */
function arrayOf(value: unknown, arrays: ArrayBuffer): unknown {
  if (typeof value !== "object" || value === null) return value;
  if ("f32" in value) return new Float32Array(arrays, ...(value.f32 as [number, number]));
  if ("u32" in value) return new Uint32Array(arrays, ...(value.u32 as [number, number]));
  return value;
}
