// The WASM module behind a typed function. It runs in the worker, at build time in Node, and in the tests.
import type { AnswerOf, Kind, QuestionOf } from "./types";

interface Exports {
  memory: WebAssembly.Memory;
  chordal_alloc(length: number): number;
  chordal_free(at: number, length: number): void;
  chordal_study(at: number, length: number): number;
  chordal_ladder(at: number, length: number): number;
  chordal_seam(at: number, length: number): number;
  chordal_exit(outcome: number): number;
  chordal_report(outcome: number): number;
  chordal_report_len(outcome: number): number;
  chordal_error(outcome: number): number;
  chordal_error_len(outcome: number): number;
  chordal_release(outcome: number): void;
}

/** The core understood the question and refuses it, in a sentence. The module is as good as before. */
export class Refused extends Error {}

/** The module trapped, or is none of ours. It must not be called again. */
export class Broken extends Error {}

export class Core {
  private broken = false;
  private constructor(private readonly exports: Exports) {}

  static async load(bytes: BufferSource): Promise<Core> {
    try {
      const { instance } = await WebAssembly.instantiate(bytes);
      return new Core(instance.exports as unknown as Exports);
    } catch (error) {
      throw new Broken(String(error));
    }
  }

  /** Asks one question. Throws [`Refused`] or [`Broken`]. */
  ask<K extends Kind>(kind: K, question: QuestionOf<K>): AnswerOf<K> {
    if (this.broken) throw new Broken("the module trapped before");
    let outcome: { refused: string } | { answer: string };
    try {
      outcome = this.call(kind, new TextEncoder().encode(JSON.stringify(question)));
    } catch (error) {
      // After a trap the module's memory may be in any state.
      this.broken = true;
      throw new Broken(String(error));
    }
    if ("refused" in outcome) throw new Refused(outcome.refused);
    return JSON.parse(outcome.answer) as AnswerOf<K>;
  }

  private call(kind: Kind, question: Uint8Array): { refused: string } | { answer: string } {
    const core = this.exports;
    const at = core.chordal_alloc(question.length);
    // Growing memory detaches every view, so each is made anew where it is used.
    new Uint8Array(core.memory.buffer, at, question.length).set(question);
    const outcome = core[`chordal_${kind}`](at, question.length);
    const text = (start: number, length: number) => new TextDecoder().decode(new Uint8Array(core.memory.buffer, start, length));
    const exit = core.chordal_exit(outcome);
    const said =
      exit === 0
        ? { answer: text(core.chordal_report(outcome), core.chordal_report_len(outcome)) }
        : { refused: text(core.chordal_error(outcome), core.chordal_error_len(outcome)) };
    core.chordal_release(outcome);
    core.chordal_free(at, question.length);
    return said;
  }
}
