// The film of segment numbers: shows every stop once, to the end, then from the start again, and stops at once.
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { Film } from "../../src/state/film";
import { STOPS } from "../../src/state/state";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

function startFilm() {
  const shown: number[] = [];
  let ends = 0;
  const film = new Film((n) => shown.push(n), () => (ends += 1));
  return { film, shown, ends: () => ends };
}

test("it shows every later stop once, and ends", () => {
  const { film, shown, ends } = startFilm();
  film.start(6);
  expect(film.isPlaying).toBe(true);
  vi.runAllTimers();
  expect(shown).toEqual(STOPS.filter((n) => n >= 6));
  expect([film.isPlaying, ends()]).toEqual([false, 1]);
});

test("at the last stop it starts again from the first", () => {
  const { film, shown } = startFilm();
  film.start(128);
  vi.runAllTimers();
  expect(shown).toEqual(STOPS);
});

test("after a stop it shows nothing more, and reports its end once", () => {
  const { film, shown, ends } = startFilm();
  film.start(1);
  vi.advanceTimersByTime(1200);
  film.stop();
  film.stop();
  const seen = shown.length;
  vi.runAllTimers();
  expect([shown.length, ends()]).toEqual([seen, 1]);
  expect(seen).toBeGreaterThan(1);
  expect(seen).toBeLessThan(5);
});
