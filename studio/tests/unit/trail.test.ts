// Which changes become a step of the browser's history, and which are written into the current one.
import { expect, test } from "vitest";
import { Trail } from "../../src/state/trail";

function startTrail(start = "") {
  const calls: string[] = [];
  const trail = new Trail({ push: (to) => calls.push(`push ${to}`), replace: (to) => calls.push(`replace ${to}`) }, start);
  return { trail, calls };
}

test("each kind of change is a step, and a run of the same changes is one", () => {
  const { trail, calls } = startTrail();
  trail.touch(["segments", "before"]);
  trail.write("n=7", 1000);
  trail.touch(["segments", "before"]);
  trail.write("n=8", 1800);
  trail.touch(["spacing"]);
  trail.write("n=8&s=f", 2200);
  trail.touch(["spacing"]);
  trail.write("n=8", 9000);
  expect(calls).toEqual(["push n=7", "replace n=8", "push n=8&s=f", "push n=8"]);
});

test("language and theme are no steps, and an unchanged state is not written", () => {
  const { trail, calls } = startTrail("n=7");
  trail.touch(["segments"]);
  trail.write("n=7", 0);
  trail.touch(["language"]);
  trail.write("n=7&l=zh", 5000);
  expect(calls).toEqual(["replace n=7&l=zh"]);
});

test("after going back, the next change is a new step", () => {
  const { trail, calls } = startTrail();
  trail.touch(["segments"]);
  trail.write("n=7", 1000);
  trail.arrive("");
  trail.touch(["segments"]);
  trail.write("n=5", 1100);
  expect(calls).toEqual(["push n=7", "push n=5"]);
});
