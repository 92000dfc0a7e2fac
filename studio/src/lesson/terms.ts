// A term shows its formula and gloss in place, for mouse, touch and keys. Without script its link leads to the entry at the end.

export function terms(): void {
  const card = document.createElement("div");
  card.className = "gloss";
  card.id = "gloss";
  card.setAttribute("popover", "auto");
  card.setAttribute("role", "note");
  card.tabIndex = -1;
  document.body.append(card);
  let shown: HTMLElement | null = null;

  card.addEventListener("toggle", (event) => {
    if (event.newState !== "closed" || !shown) return;
    shown.removeAttribute("aria-describedby");
    // Back to the text, unless the reader has gone elsewhere.
    if (card.contains(document.activeElement) || document.activeElement === document.body) shown.focus({ preventScroll: true });
    shown = null;
  });

  document.addEventListener("click", (event) => {
    const link = (event.target as Element).closest<HTMLAnchorElement>("a.term");
    if (!link || event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    const entry = document.getElementById(link.hash.slice(1));
    if (!entry) return;
    const isAgain = shown === link;
    card.hidePopover();
    if (isAgain) return;
    const parts = [...entry.children].map((part) => {
      const copy = document.createElement(part.tagName === "DT" ? "h4" : "p");
      copy.className = part.className;
      copy.innerHTML = part.innerHTML;
      copy.querySelector(".back")?.remove();
      return copy;
    });
    parts[0]?.classList.add("gloss-word");
    card.replaceChildren(...parts);
    shown = link;
    link.setAttribute("aria-describedby", card.id);
    card.showPopover();
    place(card, link.getBoundingClientRect());
    card.focus({ preventScroll: true });
  });
  addEventListener("scroll", () => shown && place(card, shown.getBoundingClientRect()), { passive: true });
}

/** Below the word, or above it if there is no room; within the window. */
function place(card: HTMLElement, word: DOMRect): void {
  const [margin, gap] = [8, 6];
  const { offsetWidth: width, offsetHeight: height } = card;
  const left = Math.min(Math.max(word.left, margin), innerWidth - width - margin);
  const isBelow = word.bottom + gap + height < innerHeight || word.top - gap - height < 0;
  card.style.left = `${left}px`;
  card.style.top = `${isBelow ? word.bottom + gap : word.top - gap - height}px`;
}
