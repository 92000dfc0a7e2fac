// How the threads of one run get from the thread that starts them to the workers that carry them. A thread is started by a
// worker that computes, and so can neither send a message nor be sent one: it writes into memory on which the others sleep.
/** The words of a slot: its state, the number of its thread, and what the thread is told. */
const WORDS = 3;
/** A slot waits for a thread; is about to get one; has one. */
const [FREE, TAKEN, STARTED] = [0, 1, 2];
/** The words before the slots: whether the run is over, the number of the last thread. */
const [OVER, LAST_THREAD, HEAD] = [0, 1, 2];
/** EAGAIN of WASI, negative as its threads ask for it: there is no free slot. */
const NO_THREAD = -6;

export class ThreadSlots {
  private readonly words: Int32Array;
  /** With the memory of the slots, which may be of another worker. */
  constructor(
    readonly memory: WebAssembly.Memory,
    private readonly count: number,
  ) {
    this.words = new Int32Array(memory.buffer);
  }

  static of(count: number): ThreadSlots {
    return new ThreadSlots(new WebAssembly.Memory({ initial: 1, maximum: 1, shared: true }), count);
  }

  /** Gives a thread to a free slot. Any thread may call it. Returns the thread's number, or an error of WASI. */
  start(told: number): number {
    for (let slot = 0; slot < this.count; slot++) {
      const at = HEAD + WORDS * slot;
      if (Atomics.compareExchange(this.words, at, FREE, TAKEN) !== FREE) continue;
      const id = Atomics.add(this.words, LAST_THREAD, 1) + 1;
      this.words[at + 1] = id;
      this.words[at + 2] = told;
      Atomics.store(this.words, at, STARTED);
      Atomics.notify(this.words, at);
      return id;
    }
    return NO_THREAD;
  }

  /** Runs the threads that a slot is given, one after the other, until the run is over. The caller's worker sleeps between. */
  serve(slot: number, run: (id: number, told: number) => void): void {
    const at = HEAD + WORDS * slot;
    while (!Atomics.load(this.words, OVER)) {
      if (Atomics.load(this.words, at) === STARTED) {
        run(this.words[at + 1]!, this.words[at + 2]!);
        Atomics.store(this.words, at, FREE);
      } else {
        Atomics.wait(this.words, at, FREE);
      }
    }
  }

  /** Ends the run: who sleeps is woken, and no slot gets a thread any more. */
  end(): void {
    Atomics.store(this.words, OVER, 1);
    for (let slot = 0; slot < this.count; slot++) {
      const at = HEAD + WORDS * slot;
      // Only a free slot has somebody asleep.
      Atomics.compareExchange(this.words, at, FREE, TAKEN);
      Atomics.notify(this.words, at);
    }
  }
}
