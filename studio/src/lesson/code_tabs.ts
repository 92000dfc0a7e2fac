// Code: one language at a time, the same in the whole page, and a button that copies it. Without script both stand below each
// other, to unfold.

const KEY = "chordal code";

export function code(): void {
  const blocks = [...document.querySelectorAll<HTMLElement>(".code")];
  let chosen = remembered() ?? "py";

  function choose(language: string): void {
    chosen = language;
    for (const block of blocks) {
      for (const part of block.querySelectorAll<HTMLDetailsElement>("details")) {
        const isShown = part.dataset["code"] === chosen;
        part.hidden = !isShown;
        part.open = isShown;
      }
      for (const tab of block.querySelectorAll("[data-tab]")) tab.setAttribute("aria-pressed", String(tab.getAttribute("data-tab") === chosen));
    }
  }

  for (const block of blocks) {
    const bar = document.createElement("p");
    bar.className = "code-bar";
    bar.append(fold(block));
    for (const part of block.querySelectorAll<HTMLDetailsElement>("details")) {
      const tab = document.createElement("button");
      Object.assign(tab, { type: "button", textContent: part.querySelector("summary")!.textContent });
      tab.dataset["tab"] = part.dataset["code"]!;
      tab.addEventListener("click", () => {
        // What is above must not move under the reader's eyes.
        const before = tab.getBoundingClientRect().top;
        choose(part.dataset["code"]!);
        scrollBy(0, tab.getBoundingClientRect().top - before);
        remember(chosen);
      });
      bar.append(tab);
    }
    const copy = document.createElement("button");
    Object.assign(copy, { type: "button", className: "copy", textContent: block.dataset["copy"] });
    copy.addEventListener("click", () => {
      const text = block.querySelector(`[data-code="${chosen}"] code`)!.textContent ?? "";
      void navigator.clipboard.writeText(`${text}\n`).then(() => {
        copy.textContent = block.dataset["copied"]!;
        copy.addEventListener("blur", () => (copy.textContent = block.dataset["copy"]!), { once: true });
      });
    });
    bar.append(copy);
    block.prepend(bar);
  }
  choose(chosen);
}

/** On a narrow screen the code is folded, and this opens it; elsewhere it is not shown (narrow.css). */
function fold(block: HTMLElement): HTMLButtonElement {
  const button = document.createElement("button");
  Object.assign(button, { type: "button", className: "fold", textContent: block.dataset["fold"] });
  button.setAttribute("aria-expanded", "false");
  button.addEventListener("click", () => {
    const isOpen = block.classList.toggle("unfolded");
    button.setAttribute("aria-expanded", String(isOpen));
  });
  return button;
}

function remembered(): string | null {
  try {
    return localStorage.getItem(KEY);
  } catch {
    return null;
  }
}

function remember(language: string): void {
  try {
    localStorage.setItem(KEY, language);
  } catch {
    // Then it lasts as long as the page.
  }
}
