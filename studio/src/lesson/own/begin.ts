// The way in for a shape of the reader's own. All of it is loaded when it is asked for, when a file is dropped on the page, or
// when this browser keeps a shape.
import type { Guide } from "./guide";
import { isMarked } from "./mark";

export function own(): void {
  const begin = document.querySelector<HTMLElement>("[data-own-begin]");
  if (!begin) return;
  let guide: Promise<Guide> | undefined;
  const load = async (act: (ready: Guide) => void) => {
    guide ??= import("./guide").then(({ Guide }) => Guide.start());
    const ready = await guide.catch(() => null);
    if (ready) act(ready);
    else begin.querySelector("[data-own-line]")!.replaceChildren(Object.assign(document.createElement("p"), { role: "alert", textContent: begin.dataset["away"] }));
  };
  begin.hidden = false;
  begin.querySelector("button")!.addEventListener("click", () => void load((ready) => ready.open()));
  const hasFiles = (event: DragEvent) => event.dataTransfer?.types.includes("Files") ?? false;
  // Else the browser leaves the page for the file.
  document.addEventListener("dragover", (event) => hasFiles(event) && event.preventDefault());
  document.addEventListener("drop", (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    const files = [...event.dataTransfer!.files];
    void load((ready) => ready.take(files));
  });
  if (isMarked()) void load(() => undefined);
}
