// The judge of the bench refuses what is beyond a limit, and what is worse than a known miss.
import { expect, test } from "vitest";
import { KNOWN, type Misses, judged } from "../bench/judge";

const known: Misses = {
  draft: { gear: { value: 300, why: "it is large" } },
  frames: { slow: { value: 20, why: "it is deep" } },
  live: { big: { value: 500, why: "it has much" } },
};

test("a value within its limit is right, and one beyond it is wrong", () => {
  expect(judged("draft", "bracket", 150, known)).toEqual({ isMiss: false });
  expect(judged("draft", "bracket", 151, known)).toEqual({ isMiss: true, wrong: "bracket, draft: 151 ms, beyond the limit of 150 ms" });
  expect(judged("frames", "ball", 60, known)).toEqual({ isMiss: false });
  expect(judged("frames", "ball", 59, known).wrong).toContain("beyond the limit of 60 /s");
  expect(judged("draft", "bracket", Number.NaN, known).wrong).toContain("not measured");
  expect(judged("proof", "bracket", -180, known).wrong).toContain("not measured");
});

test("a known miss may stay, with a margin, but not get worse", () => {
  expect(judged("draft", "gear", 300, known)).toEqual({ isMiss: true, note: "gear, draft: 300 ms for 150 ms, a known miss: it is large" });
  expect(judged("draft", "gear", 370, known).wrong).toBeUndefined();
  expect(judged("draft", "gear", 380, known)).toEqual({ isMiss: true, wrong: "gear, draft: 380 ms, worse than the known miss of 300 ms" });
  expect(judged("frames", "slow", 17, known).wrong).toBeUndefined();
  expect(judged("frames", "slow", 15, known).wrong).toContain("worse");
  // Bytes are the same on every machine.
  expect(judged("live", "big", 501, known).wrong).toContain("worse");
});

test("a known miss that is better, or none any more, is said", () => {
  expect(judged("draft", "gear", 200, known).note).toContain("is better than the known miss of 300 ms");
  expect(judged("draft", "gear", 140, known)).toEqual({ isMiss: false, note: "gear, draft: 140 ms holds the limit of 150 ms now: take it off the list of misses" });
  expect(judged("frames", "slow", 40, known).note).toContain("is better");
  expect(judged("live", "big", 450, known).note).toContain("is better");
});

test("every known miss is one, and says why", () => {
  for (const [what, misses] of Object.entries(KNOWN)) {
    for (const [of, { value, why }] of Object.entries(misses)) {
      expect(judged(what as keyof typeof KNOWN, of, value).isMiss, `${of}, ${what}`).toBe(true);
      expect(why, `${of}, ${what}`).toMatch(/\w+ \w+/);
    }
  }
});
