// The cost of a drag on a page's main thread.
import type { Locator, Page } from "playwright-core";
import { wave } from "../page/drag";

interface TraceEvent {
  name: string;
  ph: string;
  ts: number;
  dur?: number;
  tdur?: number;
  tid: number;
  pid: number;
  args: { data?: { type?: string } };
}

/** Of a drag: the number of moves, and the processor's time for each and for the longest task, in milliseconds. */
export interface DragCost {
  moves: number;
  median: number;
  p95: number;
  longest: number;
}

/** Measures the processor's time on the page's main thread for each pointer move of a drag, from a trace. */
export async function dragCost(page: Page, handle: Locator): Promise<DragCost> {
  const session = await page.context().newCDPSession(page);
  const events: TraceEvent[] = [];
  session.on("Tracing.dataCollected", ({ value }) => events.push(...(value as unknown as TraceEvent[])));
  const done = new Promise((resolve) => session.once("Tracing.tracingComplete", resolve));
  const traceConfig = { includedCategories: ["toplevel", "devtools.timeline"] };
  await wave(page, handle, () => session.send("Tracing.start", { transferMode: "ReportEvents", traceConfig }));
  await session.send("Tracing.end");
  await done;
  await page.mouse.up();
  const isMove = (event: TraceEvent) => event.name === "EventDispatch" && event.args.data?.type === "pointermove";
  const moves = events.filter(isMove).sort((a, b) => a.ts - b.ts);
  const { tid, pid } = moves[0]!;
  const isHere = (event: TraceEvent) => event.ph === "X" && event.pid === pid && event.tid === tid;
  const tasks = events.filter((event) => isHere(event) && event.name.endsWith("RunTask"));
  const [first, last] = [moves[0]!.ts, moves.at(-1)!.ts];
  // A task belongs to the newest move before its end: the move's own task began before its event.
  const cost = moves.slice(0, -1).map(() => 0);
  let longest = 0;
  for (const task of tasks) {
    const end = task.ts + task.dur!;
    if (end <= first || end > last) continue;
    const owner = moves.findLastIndex((move) => move.ts < end);
    const ms = (task.tdur ?? 0) / 1000;
    cost[owner]! += ms;
    longest = Math.max(longest, ms);
  }
  cost.sort((a, b) => a - b);
  return { moves: cost.length, median: cost[Math.floor(cost.length / 2)]!, p95: cost[Math.floor(cost.length * 0.95)]!, longest };
}
