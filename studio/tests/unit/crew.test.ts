// Who carries the threads of runs: the slots in which threads are started, and the workers that a run gets and gives back.
import { expect, test } from "vitest";
import type { Order, Reply } from "../../src/core/command_worker";
import { Crews, MOST_DROPPED_BYTES, type ThreadWorkerLike } from "../../src/core/crew";
import { Jobs, Stopped, type WorkerLike } from "../../src/core/jobs";
import { ThreadSlots } from "../../src/core/thread_slots";
import type { ThreadOrder, ThreadReply } from "../../src/core/thread_worker";

/** EAGAIN of WASI's threads. */
const NO_THREAD = -6;

class Puppet<Ordered, Replied> {
  onmessage: ((event: MessageEvent<Replied>) => void) | null = null;
  onerror: ((event: ErrorEvent) => void) | null = null;
  orders: Ordered[] = [];
  isEnded = false;
  postMessage(order: Ordered) {
    this.orders.push(order);
  }
  terminate() {
    this.isEnded = true;
  }
  reply(data: unknown) {
    this.onmessage?.({ data } as MessageEvent<Replied>);
  }
}
class Mate extends Puppet<ThreadOrder, ThreadReply> implements ThreadWorkerLike {}
class Runner extends Puppet<Order, Reply> implements WorkerLike {}

const module = {} as WebAssembly.Module;
const outcome = { exit: 0, stdout: "", stderr: "", outputs: {} };
const nextTask = () => new Promise((done) => setTimeout(done, 0));

/** A page whose machine has three cores, and its workers. */
function page() {
  const [mates, runners]: [Mate[], Runner[]] = [[], []];
  const made = <T>(all: T[], one: T) => (all.push(one), one);
  const crews = new Crews(() => made(mates, new Mate()), 2);
  const jobs = new Jobs<"proof" | "levels" | "draft">(
    () => Promise.resolve(module),
    () => made(runners, new Runner()) as WorkerLike,
    crews,
    (lane) => lane !== "draft",
  );
  return { mates, runners, jobs };
}
const answer = (runner: Runner, bytes = 1) => runner.reply({ id: runner.orders.at(-1)!.id, outcome, bytes });

test("a slot carries one thread at a time, each with a number of its own, until the run is over", () => {
  const slots = ThreadSlots.of(2);
  expect([slots.start(70), slots.start(80), slots.start(90)]).toEqual([1, 2, NO_THREAD]);
  const ran: number[][] = [];
  slots.serve(1, (id, told) => {
    ran.push([id, told]);
    expect(slots.start(90), "while it runs, the slot is taken").toBe(NO_THREAD);
    // Otherwise the slot would sleep until there is another thread.
    slots.end();
  });
  // A thread that no worker has come to before the end is of no use.
  slots.serve(0, (id, told) => ran.push([id, told]));
  expect(ran).toEqual([[2, 80]]);
});

test("a run has the free workers, and a second one beside it none", async () => {
  const { mates, runners, jobs } = page();
  void jobs.run("proof", [], {});
  void jobs.run("levels", [], {});
  await nextTask();
  expect(mates.map(({ orders }) => orders.map(({ slot, count }) => [slot, count]))).toEqual([[[0, 2]], [[1, 2]]]);
  const [proof, levels] = runners.map(({ orders }) => orders[0]!.crew);
  expect(proof).toMatchObject({ count: 2, memory: mates[0]!.orders[0]!.memory, slots: mates[0]!.orders[0]!.slots });
  expect(levels).toBeUndefined();
});

test("the workers of a run that is over carry the threads of the next one", async () => {
  const { mates, runners, jobs } = page();
  void jobs.run("proof", [], {});
  await nextTask();
  for (const mate of mates) mate.reply("free");
  answer(runners[0]!);
  void jobs.run("levels", [], {});
  await nextTask();
  expect(mates.map(({ orders }) => orders.length)).toEqual([2, 2]);
  expect(runners[1]!.orders[0]!.crew?.memory).not.toBe(runners[0]!.orders[0]!.crew!.memory);
});

test("a worker whose thread does not end with its run is replaced", async () => {
  const { mates, runners, jobs } = page();
  void jobs.run("proof", [], {});
  await nextTask();
  mates[0]!.reply("free");
  answer(runners[0]!);
  void jobs.run("proof", [], {});
  await nextTask();
  expect(mates.map(({ isEnded }) => isEnded)).toEqual([false, true, false]);
  expect(mates.map(({ orders }) => orders.length)).toEqual([2, 1, 1]);
});

test("a thread that traps ends its run with all its workers, and later runs have new ones", async () => {
  const { mates, runners, jobs } = page();
  const run = jobs.run("proof", [], {});
  await nextTask();
  mates[1]!.reply({ trapped: "unreachable" });
  await expect(run).rejects.toMatchObject({ why: "trapped", message: "unreachable" });
  expect([...mates, ...runners].every(({ isEnded }) => isEnded)).toBe(true);
  void jobs.run("proof", [], {});
  await nextTask();
  expect(mates.slice(2).map(({ orders }) => orders.length)).toEqual([1, 1]);
});

test("to cancel a run ends its threads", async () => {
  const { mates, jobs } = page();
  const run = jobs.run("proof", [], {});
  await nextTask();
  jobs.cancel("proof");
  await expect(run).rejects.toBeInstanceOf(Stopped);
  expect(mates.every(({ isEnded }) => isEnded)).toBe(true);
});

test("a quick run has no threads, and leaves those of a proof alone", async () => {
  const { mates, runners, jobs } = page();
  void jobs.run("draft", [], {}).catch(() => undefined);
  await nextTask();
  expect(mates).toEqual([]);
  void jobs.run("proof", [], {});
  await nextTask();
  void jobs.run("draft", [], {});
  await nextTask();
  expect(runners[0]!.isEnded).toBe(true);
  expect(mates.map(({ isEnded }) => isEnded)).toEqual([false, false]);
});

test("threads say how far their run is", async () => {
  const { mates, jobs } = page();
  const said: unknown[] = [];
  void jobs.run("proof", [], {}, (progress) => said.push(progress));
  await nextTask();
  mates[0]!.reply({ progress: { stage: "prove", percent: 3 } });
  expect(said).toEqual([{ stage: "prove", percent: 3 }]);
});

test("workers that have had much memory are replaced before the next run", async () => {
  const { mates, runners, jobs } = page();
  const much = { buffer: { byteLength: MOST_DROPPED_BYTES + 1 } } as WebAssembly.Memory;
  void jobs.run("proof", [], {});
  await nextTask();
  // A memory of that size would be one of this test.
  Object.assign(runners[0]!.orders[0]!.crew!, { memory: much });
  for (const mate of mates) mate.reply("free");
  answer(runners[0]!, much.buffer.byteLength);
  expect(runners[0]!.isEnded).toBe(true);
  void jobs.run("proof", [], {});
  await nextTask();
  expect(mates.map(({ isEnded }) => isEnded)).toEqual([true, true, false, false]);
  expect(mates.map(({ orders }) => orders.length)).toEqual([1, 1, 1, 1]);
});
