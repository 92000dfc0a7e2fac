// The way in for a shape of the reader's own. All of it is loaded when it is asked for, when a file is dropped on the page, or
// when this browser keeps a shape.
import type { Guide } from "./guide";
import { isMarked } from "./mark";

export function own(): void {
  const begin = document.querySelector<HTMLElement>("[data-own-begin]");
  if (!begin) return;
  let guide: Promise<Guide> | undefined;
  const load = () => {
    guide ??= import("./guide").then(({ Guide }) => Guide.start());
    // Without a network the next press tries again.
    guide.catch(() => (guide = undefined));
    return guide;
  };
  begin.hidden = false;
  begin.querySelector("button")!.addEventListener("click", () => void load().then((ready) => ready.open()));
  const hasFiles = (event: DragEvent) => event.dataTransfer?.types.includes("Files") ?? false;
  // Else the browser leaves the page for the file.
  document.addEventListener("dragover", (event) => hasFiles(event) && event.preventDefault());
  document.addEventListener("drop", (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    const files = [...event.dataTransfer!.files];
    void load().then((ready) => ready.take(files));
  });
  if (isMarked()) void load();
}
