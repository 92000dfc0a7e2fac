// The page's side of the worker: the newest question wins, and a failed worker is replaced.
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { Engine, type Trouble, type WorkerLike } from "../../src/core/engine";
import type { Call, Kind, QuestionOf, Reply } from "../../src/core/types";

/** A worker that is controlled by the test. */
class Puppet implements WorkerLike {
  calls: Call[] = [];
  isTerminated = false;
  onmessage: ((event: MessageEvent<Reply>) => void) | null = null;
  onerror: ((event: ErrorEvent) => void) | null = null;
  postMessage(call: Call) {
    this.calls.push(call);
  }
  terminate() {
    this.isTerminated = true;
  }
  reply(reply: object) {
    this.onmessage?.({ data: { id: this.calls.at(-1)!.id, ...reply } } as MessageEvent<Reply>);
  }
}

let workers: Puppet[];
let answered: [Kind, unknown, unknown][];
let troubles: Trouble[];
let engine: Engine;
const question = (n: number) => ({ segments: n }) as QuestionOf<"study">;
const last = () => workers.at(-1)!;

beforeEach(() => {
  vi.useFakeTimers();
  workers = [];
  answered = [];
  troubles = [];
  const create = () => {
    workers.push(new Puppet());
    return last();
  };
  engine = new Engine(create, {
    answered: (kind, answer, question) => answered.push([kind, answer, question]),
    troubled: (trouble) => troubles.push(trouble),
  });
});
afterEach(() => vi.useRealTimers());

test("one call runs at a time, and only the newest question of a kind waits", () => {
  for (const n of [1, 2, 3, 4]) engine.ask("study", question(n));
  engine.ask("ladder", {} as never);
  expect(last().calls.map((call) => call.question)).toEqual([question(1)]);
  last().reply({ answer: "a" });
  expect(last().calls.map((call) => call.question)).toEqual([question(1), question(4)]);
  last().reply({ answer: "b" });
  expect(last().calls.at(-1)!.kind).toBe("ladder");
  expect(answered).toEqual([
    ["study", "a", question(1)],
    ["study", "b", question(4)],
  ]);
});

test("the figure under the finger comes before the plot", () => {
  engine.ask("ladder", {} as never);
  engine.ask("ladder", {} as never);
  engine.ask("seam", {} as never);
  engine.ask("study", question(1));
  for (let i = 0; i < 3; i++) last().reply({ answer: i });
  expect(last().calls.map((call) => call.kind)).toEqual(["ladder", "study", "seam", "ladder"]);
});

test("a refusal is reported and the worker goes on", () => {
  engine.ask("study", question(0));
  last().reply({ refused: "segments: from 1" });
  expect(troubles).toEqual([{ what: "refused", why: "segments: from 1" }]);
  engine.ask("study", question(1));
  last().reply({ answer: "fine" });
  expect(workers.length).toBe(1);
  expect(answered.length).toBe(1);
});

test("after a trap the worker is rebuilt and the newest question asked again", () => {
  engine.ask("study", question(1));
  engine.ask("study", question(2));
  const first = last();
  first.reply({ broken: "unreachable" });
  expect([first.isTerminated, workers.length]).toEqual([true, 2]);
  expect(troubles).toEqual([{ what: "rebuilt" }]);
  expect(last().calls.map((call) => call.question)).toEqual([question(2)]);
  // Replies of the dead worker must be ignored.
  first.reply({ answer: "late" });
  expect(answered).toEqual([]);
  last().reply({ answer: "good" });
  expect(answered).toEqual([["study", "good", question(2)]]);
});

test("a question that breaks the module is asked again", () => {
  engine.ask("study", question(7));
  last().reply({ broken: "unreachable" });
  expect(last().calls.map((call) => call.question)).toEqual([question(7)]);
});

test("a worker that does not start or does not answer is replaced", () => {
  engine.ask("study", question(1));
  last().onerror?.({} as ErrorEvent);
  expect(workers.length).toBe(2);
  vi.advanceTimersByTime(60_000);
  expect(workers.length).toBe(3);
});

test("after three failures in a row the engine gives up for good", () => {
  engine.ask("study", question(1));
  for (let i = 0; i < 3; i++) last().reply({ broken: "unreachable" });
  expect(troubles.at(-1)).toEqual({ what: "lost" });
  const n = workers.length;
  engine.ask("study", question(2));
  expect(workers.length).toBe(n);
  expect(workers.every((worker) => worker.isTerminated)).toBe(true);
});

test("an answer resets the count of failures", () => {
  for (let i = 0; i < 10; i++) {
    engine.ask("study", question(1));
    last().reply({ broken: "unreachable" });
    last().reply({ answer: i });
  }
  expect(answered.length).toBe(10);
  expect(troubles.every(({ what }) => what === "rebuilt")).toBe(true);
});

test("several figures share the worker: each has its newest question, and one that fails twice does not stop the others", () => {
  const lost: (string | undefined)[] = [];
  const keys: string[] = [];
  const shared = new Engine(
    () => {
      workers.push(new Puppet());
      return last();
    },
    {
      answered: (_, __, ___, key) => keys.push(key),
      troubled: (trouble, key) => trouble.what === "lost" && lost.push(key),
    },
  );
  const ask = (id: string, n: number) => shared.ask("exhibit", { exhibit: id, n }, id);
  ask("bad", 1);
  ask("good", 1);
  ask("good", 2);
  ask("sleepy", 1);
  expect(shared.forget("sleepy")).toBe(true);
  expect(shared.forget("sleepy")).toBe(false);
  last().reply({ broken: "trap" });
  // The others were asked before it is tried again.
  expect(last().calls.at(-1)!.question).toEqual({ exhibit: "good", n: 2 });
  last().reply({ answer: {} });
  last().reply({ broken: "trap" });
  expect(lost).toEqual(["bad"]);
  ask("good", 3);
  last().reply({ answer: {} });
  expect(keys).toEqual(["good", "good"]);
  expect(shared.isIdle).toBe(true);
});
