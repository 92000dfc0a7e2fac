// What becomes a step of the browser's history, and what is written into the one that is there.
import { expect, test } from "vitest";
import { Trail } from "../../src/state/trail";

function trail(start = "") {
  const said: string[] = [];
  const made = new Trail({ push: (to) => said.push(`push ${to}`), replace: (to) => said.push(`replace ${to}`) }, start);
  return { trail: made, said };
}

test("each thing that is changed is a step, and a run of the same changes is one", () => {
  const { trail: made, said } = trail();
  made.touch(["segments", "before"]);
  made.write("n=7", 1000);
  made.touch(["segments", "before"]);
  made.write("n=8", 1800);
  made.touch(["spacing"]);
  made.write("n=8&s=f", 2200);
  made.touch(["spacing"]);
  made.write("n=8", 9000);
  expect(said).toEqual(["push n=7", "replace n=8", "push n=8&s=f", "push n=8"]);
});

test("language and theme are no steps, and what is unchanged is not written", () => {
  const { trail: made, said } = trail("n=7");
  made.touch(["segments"]);
  made.write("n=7", 0);
  made.touch(["language"]);
  made.write("n=7&l=zh", 5000);
  expect(said).toEqual(["replace n=7&l=zh"]);
});

test("after going back, the next change is a new step", () => {
  const { trail: made, said } = trail();
  made.touch(["segments"]);
  made.write("n=7", 1000);
  made.arrive("");
  made.touch(["segments"]);
  made.write("n=5", 1100);
  expect(said).toEqual(["push n=7", "push n=5"]);
});
