// Long lists that stand open on a wide screen, and are folded on a narrow one: without script they are open on both.

/** As in narrow.css. */
const NARROW = "(width < 48rem)";

export function folds(): void {
  const narrow = matchMedia(NARROW);
  for (const list of document.querySelectorAll<HTMLDetailsElement>("details[data-fold]")) {
    const fit = () => {
      // An address may lead into it.
      list.open = !narrow.matches || list.querySelector(":target") !== null;
    };
    narrow.addEventListener("change", fit);
    fit();
  }
}
