// The shapes of a page as it was written, for its scene to show until its viewer is there: to draw thousands of them again would
// keep the reader waiting.
let kept: Element | null = null;

export function keepShapes(page: Element): void {
  kept = page.querySelector(".scene > svg > g");
}

/** What was kept, once. */
export function takeShapes(): Element | null {
  const shapes = kept;
  kept = null;
  return shapes;
}
