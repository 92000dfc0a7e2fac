// A box above the tables of a long page: it leaves the rows that contain all typed words, or whose heading does. In a
// page of formats a paragraph that begins with a bold name, with what follows it, is a row as well. Without scripts the page is
// complete.
(() => {
  const article = document.querySelector("article.md-content__inner");
  /** So many rows are more than one sees at once. */
  const LEAST = 40;
  if (!article || article.querySelectorAll("tbody tr").length < LEAST) return;

  /** The page in order: its headings, and what is shown or hidden as one. */
  const blocks = [];
  let heading;
  for (const element of article.children) {
    const level = /^H([2-4])$/.exec(element.tagName)?.[1];
    const isNamed = element.tagName === "P" && element.firstChild?.nodeName === "STRONG";
    const rows = element.querySelectorAll("tbody tr");
    if (level) heading = element;
    if (level) blocks.push({ level: Number(level), elements: [element], entries: [] });
    else if (rows.length) blocks.push({ heading, elements: [element], entries: [...rows] });
    else if (isNamed) blocks.push({ heading, elements: [element], entries: [], isNamed });
    else if (blocks.at(-1)?.isNamed) blocks.at(-1).elements.push(element);
    else if (element.tagName !== "H1") blocks.push({ elements: [element], entries: [], isText: true });
  }
  const isChinese = document.documentElement.lang.startsWith("zh");
  const box = document.createElement("p");
  box.className = "filter";
  const label = document.createElement("label");
  label.append(isChinese ? "筛选 " : "Find in the tables ");
  const input = Object.assign(document.createElement("input"), { type: "search" });
  label.append(input);
  const count = document.createElement("output");
  box.append(label, count);
  const first = article.querySelector("h2");
  first ? first.before(box) : article.prepend(box);

  const text = (element) => element.textContent.toLowerCase();
  function filter() {
    const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
    const has = (parts) => words.every((word) => parts.some((part) => part && text(part).includes(word)));
    let shown = 0;
    // From the end, so that a heading knows whether anything below it is shown.
    const isBelow = [];
    for (const block of blocks.toReversed()) {
      const { level, heading, elements, entries, isText } = block;
      if (level) {
        const isShown = !words.length || isBelow.some(Boolean);
        elements[0].hidden = !isShown;
        isBelow.length = 0;
        isBelow.push(isShown && level > 2);
        continue;
      }
      const kept = entries.length ? entries.filter((row) => !(row.hidden = !has([heading, row]))) : [];
      const isKept = !words.length || kept.length > 0 || (!entries.length && !isText && has(elements));
      for (const element of elements) element.hidden = !isKept;
      shown += entries.length ? kept.length : isKept && !isText ? 1 : 0;
      isBelow.push(isKept);
    }
    count.textContent = words.length ? (isChinese ? `${shown} 项` : `${shown} found`) : "";
  }
  input.addEventListener("input", filter);
})();
