// The six cards: one turns only after something is written on it.

/** A word or two; chosen so that a space does not turn a card. */
const LEAST = 3;

export function cards(): void {
  for (const card of document.querySelectorAll<HTMLElement>("[data-card]")) {
    const front = card.querySelector<HTMLElement>(".front")!;
    const [text, button] = [front.querySelector("textarea")!, front.querySelector("button")!];
    const details = card.querySelector("details")!;
    front.hidden = false;
    details.hidden = true;
    text.addEventListener("input", () => {
      button.disabled = text.value.trim().length < LEAST;
    });
    button.addEventListener("click", () => {
      details.hidden = false;
      details.open = true;
      card.dataset["turned"] = "1";
      button.hidden = true;
      details.querySelector("summary")!.focus();
    });
  }
}
