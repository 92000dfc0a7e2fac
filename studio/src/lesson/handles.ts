// Numbers of the text that are handles, and words that set a figure. A number is dragged sideways, or moved by the arrow keys, and
// follows its figure if that is moved there.
import type { Placed } from "./live";

/** Pixels of a drag for one step. */
const PIXELS = 6;

export function handles(figures: readonly Placed[]): void {
  const byId = new Map(figures.map((figure) => [figure.id, figure]));
  for (const number of document.querySelectorAll<HTMLElement>("[data-handle]")) {
    const figure = byId.get(number.dataset["handle"]!);
    if (figure) handle(number, figure);
  }
  for (const words of document.querySelectorAll<HTMLElement>("[data-set]")) {
    const figure = byId.get(words.dataset["set"]!);
    if (!figure) continue;
    const button = document.createElement("button");
    Object.assign(button, { type: "button", className: "set-of", textContent: words.textContent });
    button.addEventListener("click", () => void figure.set(JSON.parse(words.dataset["to"]!) as object));
    words.replaceWith(button);
  }
}

function handle(number: HTMLElement, figure: Placed): void {
  const { field, low, high, step, unit, shown, name } = number.dataset as Record<string, string>;
  const [least, most, by] = [Number(low), Number(high), Number(step)];
  const texts = shown ? (JSON.parse(shown) as string[]) : undefined;
  let value = Number(number.dataset["value"]);
  number.setAttribute("role", "slider");
  number.tabIndex = 0;
  number.setAttribute("aria-label", name!);
  number.setAttribute("aria-valuemin", low!);
  number.setAttribute("aria-valuemax", high!);

  function show(newest: number): void {
    value = newest;
    const text = texts ? (texts[Math.round((value - least) / by)] ?? "") : String(value) + unit;
    number.textContent = text;
    number.setAttribute("aria-valuenow", String(value));
    number.setAttribute("aria-valuetext", text);
  }
  function choose(wanted: number): void {
    // In whole steps, without the noise of binary fractions.
    const stepped = Number((least + Math.round((wanted - least) / by) * by).toFixed(6));
    const next = Math.min(Math.max(stepped, least), most);
    if (next === value) return;
    show(next);
    void figure.set({ [field!]: next });
  }
  show(value);
  figure.followers.push((state) => typeof state[field!] === "number" && state[field!] !== value && show(state[field!] as number));

  number.addEventListener("keydown", (event) => {
    const moves: Record<string, number> = {
      ArrowLeft: value - by,
      ArrowDown: value - by,
      ArrowRight: value + by,
      ArrowUp: value + by,
      PageDown: value - 10 * by,
      PageUp: value + 10 * by,
      Home: least,
      End: most,
    };
    const wanted = moves[event.key];
    if (wanted === undefined || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    choose(wanted);
  });
  number.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    event.preventDefault();
    number.focus({ preventScroll: true });
    number.setPointerCapture(event.pointerId);
    const [start, from] = [event.clientX, value];
    const abort = new AbortController();
    number.addEventListener("pointermove", (now) => choose(from + Math.round((now.clientX - start) / PIXELS) * by), abort);
    for (const end of ["pointerup", "pointercancel"]) number.addEventListener(end, () => abort.abort(), abort);
  });
}
