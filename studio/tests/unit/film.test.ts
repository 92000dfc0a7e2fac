// The film of segment numbers: every stop once, to the end, from the start again, and stopped at once.
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { Film } from "../../src/state/film";
import { STOPS } from "../../src/state/state";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

function film() {
  const shown: number[] = [];
  let ends = 0;
  const made = new Film((n) => shown.push(n), () => (ends += 1));
  return { film: made, shown, ends: () => ends };
}

test("it shows every stop from where it stands, once, and ends", () => {
  const { film: played, shown, ends } = film();
  played.start(6);
  expect(played.isPlaying).toBe(true);
  vi.runAllTimers();
  expect(shown).toEqual(STOPS.filter((n) => n >= 6));
  expect([played.isPlaying, ends()]).toEqual([false, 1]);
});

test("from the last stop it begins at the first", () => {
  const { film: played, shown } = film();
  played.start(128);
  vi.runAllTimers();
  expect(shown).toEqual(STOPS);
});

test("stopped it shows nothing more, and says so once", () => {
  const { film: played, shown, ends } = film();
  played.start(1);
  vi.advanceTimersByTime(1200);
  played.stop();
  played.stop();
  const seen = shown.length;
  vi.runAllTimers();
  expect([shown.length, ends()]).toEqual([seen, 1]);
  expect(seen).toBeGreaterThan(1);
  expect(seen).toBeLessThan(5);
});
