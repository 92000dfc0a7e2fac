// The exhibits of the lesson's third part: each number changes as the exhibit claims, by mouse and keys.
import { afterAll, beforeAll, expect, test } from "vitest";
import { ExhibitPages, drag, grip } from "./exhibit_page";
import { digits, settled } from "./site";

let pages: ExhibitPages;
beforeAll(async () => {
  pages = await ExhibitPages.open();
});
afterAll(() => pages.close());

test("bernstein: between the ends no weight is negative, beyond them one is; they always sum to one", async () => {
  const page = await pages.at("bernstein.html");
  const before = (await pages.state("bernstein"))["t"] as number;
  await drag(page, grip(page), 60, -20);
  expect((await pages.state("bernstein"))["t"]).toBeGreaterThan(before + 0.03);
  for (const form of ["arch", "wave", "loop"]) {
    await page.locator(`input[name=form][value=${form}]`).check();
    for (const [t, isInside] of [["0", true], ["0.5", true], ["1", true], ["-0.1", false], ["1.2", false]] as const) {
      await page.locator("#t").fill(t);
      const smallest = await pages.number("bernstein");
      expect(smallest >= 0, `${form} ${t}`).toBe(isInside);
      expect(await digits(page, "sum")).toBeCloseTo(1, 14);
      expect(await page.locator(".live.good").count()).toBe(isInside ? 1 : 0);
    }
  }
  await grip(page).focus();
  await page.keyboard.press("Home");
  expect(await pages.number("bernstein")).toBeLessThan(-1);
  expect(await digits(page, "weight-1")).toBeLessThan(0);
  expect(pages.errors).toEqual([]);
});
