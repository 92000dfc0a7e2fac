// Camera control by mouse, touch and keys, on any element. One finger turns (a vertical stroke still scrolls the page), two
// fingers zoom and pan; the wheel zooms if the picture has the focus, or with Ctrl.
import { type Size, type View, shifted, turned, zoomed } from "./view";

export interface Camera {
  view(): View;
  size(): Size;
  /** The view that the Home key restores. */
  home: View;
  look(view: View): void;
  /** Called after a press without a drag, with pixels from the upper left. */
  tap?(x: number, y: number): void;
}

/** The smallest and largest distance, as multiples of the distance at home. */
const RANGE = [0.25, 4] as const;
/** A pointer that moved fewer pixels than this is a press, not a drag. */
const STILL = 5;
/** The drag, in pixels, to which one key press corresponds. */
const STEP = { usual: 25, small: 5 } as const;

/** Listens on an element until the returned function is called. */
export function control(element: HTMLElement, camera: Camera): () => void {
  const abort = new AbortController();
  const { signal } = abort;
  const fingers = new Map<number, readonly [number, number]>();
  let travelled = 0;
  const range = () => RANGE.map((share) => share * camera.home.distance) as unknown as [number, number];
  const zoom = (factor: number) => camera.look(zoomed(camera.view(), factor, range()));

  const down = (event: PointerEvent) => {
    if (event.pointerType === "mouse" && event.button > 2) return;
    element.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    // Not for a second finger, or the last one to be lifted after a zoom would tap.
    if (fingers.size === 1) travelled = 0;
  };
  const move = (event: PointerEvent) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY] as const;
    const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
    const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
    fingers.set(event.pointerId, now);
    travelled += Math.hypot(dx, dy);
    if (other) {
      const distanceToOther = (p: readonly [number, number]) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
      // The middle between two fingers moves half as far as the one that moved.
      camera.look(shifted(zoomed(camera.view(), distanceToOther(before) / distanceToOther(now), range()), camera.size(), dx / 2, dy / 2));
    } else if (travelled >= STILL) {
      const shifts = event.shiftKey || (event.pointerType === "mouse" && event.buttons > 1);
      camera.look(shifts ? shifted(camera.view(), camera.size(), dx, dy) : turned(camera.view(), dx, dy));
    }
  };
  const up = (event: PointerEvent) => {
    const was = fingers.get(event.pointerId);
    fingers.delete(event.pointerId);
    if (!was || event.type !== "pointerup" || fingers.size || travelled >= STILL || event.button !== 0) return;
    const box = element.getBoundingClientRect();
    camera.tap?.(event.clientX - box.left, event.clientY - box.top);
  };
  const wheel = (event: WheelEvent) => {
    if (!event.ctrlKey && !event.metaKey && document.activeElement !== element) return;
    event.preventDefault();
    zoom(Math.exp(event.deltaY / 600));
  };
  const key = (event: KeyboardEvent) => {
    if (event.target !== element || event.altKey || event.ctrlKey || event.metaKey) return;
    const step = STEP.usual;
    const by = (dx: number, dy: number) =>
      camera.look(event.shiftKey ? shifted(camera.view(), camera.size(), dx, dy) : turned(camera.view(), -dx, -dy));
    switch (event.key) {
      case "ArrowLeft":
        by(step, 0);
        break;
      case "ArrowRight":
        by(-step, 0);
        break;
      case "ArrowUp":
        by(0, -step);
        break;
      case "ArrowDown":
        by(0, step);
        break;
      case "+":
      case "=":
        zoom(0.9);
        break;
      case "-":
        zoom(1 / 0.9);
        break;
      case "Home":
        camera.look(camera.home);
        break;
      default:
        return;
    }
    event.preventDefault();
  };
  // The right button shifts the view.
  const menu = (event: Event) => event.preventDefault();
  element.addEventListener("pointerdown", down, { signal });
  element.addEventListener("pointermove", move, { signal });
  element.addEventListener("pointerup", up, { signal });
  element.addEventListener("pointercancel", up, { signal });
  // Not passive, since a passive listener cannot keep the page from scrolling.
  element.addEventListener("wheel", wheel, { signal, passive: false });
  element.addEventListener("keydown", key, { signal });
  element.addEventListener("contextmenu", menu, { signal });
  return () => abort.abort();
}
