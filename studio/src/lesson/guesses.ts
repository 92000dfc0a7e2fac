// A prediction before the reveal: the answer and the figure's number are shown after a guess, or to those who ask for them.

/** A guess this near, as a share of the answer, is close. Chosen: a factor of a fifth is what an eye can tell. */
const CLOSE = 0.2;

/** Sent to a guess's element when its answer is shown. */
export const REVEALED = "revealed";

export function guesses(): void {
  for (const guess of document.querySelectorAll<HTMLElement>(".guess")) {
    const form = guess.querySelector("form")!;
    const verdict = guess.querySelector<HTMLElement>(".verdict")!;
    const details = guess.querySelector("details")!;
    form.hidden = false;
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const said = event.submitter instanceof HTMLButtonElement && event.submitter.value;
      const text = said || form.querySelector("input")!.value;
      verdict.textContent = verdict.dataset[judged(guess, text)]!.replace("{guess}", labelOf(form, text));
      for (const option of form.querySelectorAll<HTMLButtonElement>("button[value]")) option.setAttribute("aria-pressed", String(option.value === text));
      details.open = true;
    });
    details.addEventListener("toggle", () => {
      if (!details.open || "revealed" in guess.dataset) return;
      guess.dataset["revealed"] = "1";
      guess.dispatchEvent(new Event(REVEALED, { bubbles: true }));
    });
  }
}

function judged(guess: HTMLElement, text: string): "right" | "wrong" | "close" | "far" {
  const answer = guess.dataset["answer"]!;
  if (guess.dataset["kind"] === "choice") return text === answer ? "right" : "wrong";
  return Math.abs(Number(text) - Number(answer)) <= CLOSE * Number(answer) ? "close" : "far";
}

/** The words of an option, or the number. */
const labelOf = (form: HTMLFormElement, text: string) =>
  form.querySelector(`button[value="${CSS.escape(text)}"]`)?.textContent ?? text;
