// The slider's stops, the grid, and the frame between units and pixels.
import { expect, test } from "vitest";
import { MOST_SEGMENTS, STOPS, onGrid, stopOf } from "../../src/state/state";
import { Frame } from "../../src/view/frame";

test("the slider stops at every small number, and reaches the end", () => {
  expect(STOPS.slice(0, 24)).toEqual(Array.from({ length: 24 }, (_, i) => i + 1));
  expect(STOPS.at(-1)).toBe(MOST_SEGMENTS);
  STOPS.forEach((n, i) => expect(stopOf(n)).toBe(i));
  expect(STOPS[stopOf(33)]).toBeOneOf([32, 34]);
});

test("a point stays inside the drawing, on the grid", () => {
  expect(onGrid([-3, 99])).toEqual([0, 6]);
  expect(onGrid([1.23456, 2.99999])).toEqual([1.23, 3]);
});

test("a frame maps back and forth", () => {
  for (const width of [280, 360, 720, 1234]) {
    const frame = new Frame(width);
    const [x, y] = frame.from(frame.to([3.25, 1.5]));
    expect(x).toBeCloseTo(3.25, 12);
    expect(y).toBeCloseTo(1.5, 12);
    expect(frame.to([0, 6])[1]).toBeLessThan(frame.to([0, 0])[1]);
  }
});
