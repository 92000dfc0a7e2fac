// The reader's hands on the workbench's picture: it turns with inertia, the wheel zooms to what is under the pointer, and the
// page never scrolls. Figures of exhibits use src/viewer/controls.ts instead, which leaves the wheel to their page.
import type { Camera, Vec3, View } from "../../viewer";
import { minus, plus, projector, shifted, turned } from "../../viewer/view";

export interface Hands {
  /** The point of the shape under a pixel. */
  under(x: number, y: number): Vec3 | undefined;
  /** The pointer rests or moves over the picture; without a place it has left. */
  hover(x?: number, y?: number): void;
  /** A key that is not the camera's. Returns whether it meant something. */
  key(event: KeyboardEvent): boolean;
}

/** The smallest and largest distance as shares of that at home: there single precision ends, and the shape is a dot. */
const RANGE = [1e-6, 1e3] as const;
/** A pointer that moved fewer pixels than this is a press, not a drag. */
const STILL = 5;
/** Pixels for a press of an arrow key. */
const STEP = 25;
/** What a turn keeps of its speed in a millisecond after it was let go, and the speed in pixels a millisecond at which it ends. */
const INERTIA = { keeps: 0.995, ends: 0.02 };
/** A pointer that rested so long before it was let go does not go on, in milliseconds. */
const RESTED = 100;

/** The views by number, in degrees. */
export const SIDES = {
  front: { azimuth: -90, elevation: 0 },
  back: { azimuth: 90, elevation: 0 },
  left: { azimuth: 180, elevation: 0 },
  right: { azimuth: 0, elevation: 0 },
  top: { azimuth: -90, elevation: 90 },
  bottom: { azimuth: -90, elevation: -90 },
  corner: { azimuth: -45, elevation: 35.264 },
} as const;
export type Side = keyof typeof SIDES;
export const SIDE_NAMES = Object.keys(SIDES) as readonly Side[];

/** The whole shape from the same direction. */
export const fitted = (view: View, home: View): View => ({ ...view, target: home.target, distance: home.distance });

/** Nearer to a point, or farther from it, which stays under its pixel. */
export function zoomedTo(view: View, point: Vec3, factor: number, home: View): View {
  const within = Math.min(Math.max(view.distance * factor, RANGE[0] * home.distance), RANGE[1] * home.distance);
  const by = within / view.distance;
  return { ...view, distance: within, target: plus(point, minus(view.target, point), by) };
}

/** Listens on the picture until the returned function is called. */
export function orbit(element: HTMLElement, camera: Camera, hands: Hands): () => void {
  const abort = new AbortController();
  const { signal } = abort;
  const fingers = new Map<number, readonly [number, number]>();
  let [travelled, frame] = [0, 0];
  /** Of the last moves, for inertia: pixels a millisecond. */
  let [speed, last]: [readonly [number, number], number] = [[0, 0], 0];

  const place = (event: MouseEvent): readonly [number, number] => {
    const box = element.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  /** The point under a pixel, or beside the shape the point at the depth of the target. */
  const pointAt = (x: number, y: number): Vec3 => {
    const [view, size] = [camera.view(), camera.size()];
    const found = hands.under(x, y);
    if (found) return found;
    const at = projector(view, size);
    const [cx, cy] = at.to(view.target);
    return shifted(view, size, cx - x, cy - y).target;
  };
  const zoom = (x: number, y: number, factor: number) => camera.look(zoomedTo(camera.view(), pointAt(x, y), factor, camera.home));
  const middle = (): readonly [number, number] => {
    const [x, y] = projector(camera.view(), camera.size()).to(camera.view().target);
    return [x, y];
  };
  const rest = () => {
    cancelAnimationFrame(frame);
    frame = 0;
  };
  const glide = () => {
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) return;
    let before = performance.now();
    const step = (now: number) => {
      const ms = Math.min(now - before, 50);
      before = now;
      camera.look(turned(camera.view(), speed[0] * ms, speed[1] * ms));
      const kept = INERTIA.keeps ** ms;
      speed = [speed[0] * kept, speed[1] * kept];
      frame = Math.hypot(...speed) > INERTIA.ends ? requestAnimationFrame(step) : 0;
    };
    frame = requestAnimationFrame(step);
  };

  const down = (event: PointerEvent) => {
    if (event.pointerType === "mouse" && event.button > 2) return;
    rest();
    element.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (fingers.size === 1) travelled = 0;
    speed = [0, 0];
  };
  const move = (event: PointerEvent) => {
    const before = fingers.get(event.pointerId);
    if (!before) return hands.hover(...place(event));
    const now = [event.clientX, event.clientY] as const;
    const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
    const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
    fingers.set(event.pointerId, now);
    travelled += Math.hypot(dx, dy);
    if (travelled < STILL) return;
    if (other) {
      const apart = (p: readonly [number, number]) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
      const box = element.getBoundingClientRect();
      zoom((now[0] + other[0]) / 2 - box.left, (now[1] + other[1]) / 2 - box.top, apart(before) / apart(now));
      // The middle between two fingers moves half as far as the one that moved.
      camera.look(shifted(camera.view(), camera.size(), dx / 2, dy / 2));
      return;
    }
    const shifts = event.shiftKey || (event.pointerType === "mouse" && (event.buttons & 6) !== 0);
    if (shifts) return camera.look(shifted(camera.view(), camera.size(), dx, dy));
    camera.look(turned(camera.view(), dx, dy));
    const ms = Math.max(event.timeStamp - last, 1);
    last = event.timeStamp;
    speed = [0.5 * (speed[0] + dx / ms), 0.5 * (speed[1] + dy / ms)];
  };
  const up = (event: PointerEvent) => {
    const was = fingers.get(event.pointerId);
    fingers.delete(event.pointerId);
    if (!was || event.type !== "pointerup" || fingers.size) return;
    if (travelled < STILL) {
      if (event.button === 0) camera.tap?.(...place(event));
    } else if (event.timeStamp - last < RESTED && Math.hypot(...speed) > INERTIA.ends && !event.shiftKey) {
      glide();
    }
  };
  const wheel = (event: WheelEvent) => {
    event.preventDefault();
    rest();
    // A wheel counts in lines or pixels; two fingers on a touch pad, which browsers report as Ctrl, in tenths of that.
    const pixels = event.deltaY * (event.deltaMode === 1 ? 16 : 1) * (event.ctrlKey ? 5 : 1);
    zoom(...place(event), Math.exp(Math.max(-300, Math.min(300, pixels)) / 500));
  };
  const twice = (event: MouseEvent) => {
    const point = hands.under(...place(event));
    if (point) camera.look({ ...camera.view(), target: point });
  };
  const key = (event: KeyboardEvent) => {
    if (event.target !== element || event.altKey || event.ctrlKey || event.metaKey) return;
    rest();
    const view = camera.view();
    const by = (dx: number, dy: number) => camera.look(event.shiftKey ? shifted(view, camera.size(), dx, dy) : turned(view, -dx, -dy));
    const side = SIDE_NAMES[Number(event.key) - 1];
    if (event.key === "ArrowLeft") by(STEP, 0);
    else if (event.key === "ArrowRight") by(-STEP, 0);
    else if (event.key === "ArrowUp") by(0, -STEP);
    else if (event.key === "ArrowDown") by(0, STEP);
    else if (event.key === "+" || event.key === "=") zoom(...middle(), 0.9);
    else if (event.key === "-") zoom(...middle(), 1 / 0.9);
    else if (event.key === "Home") camera.look({ ...camera.home, ...(view.isParallel ? { isParallel: true } : {}) });
    else if (side) camera.look({ ...fitted(view, camera.home), ...SIDES[side] });
    else if (!hands.key(event)) return;
    event.preventDefault();
  };
  const on = <K extends keyof HTMLElementEventMap>(type: K, listen: (event: HTMLElementEventMap[K]) => void, passive = true) =>
    element.addEventListener(type, listen, { signal, passive });
  on("pointerdown", down);
  on("pointermove", move);
  on("pointerup", up);
  on("pointercancel", up);
  on("pointerleave", () => hands.hover());
  // Not passive, since a passive listener cannot keep the browser from scrolling or zooming the page.
  on("wheel", wheel, false);
  on("dblclick", twice);
  on("keydown", key, false);
  on("contextmenu", (event) => event.preventDefault(), false);
  return () => {
    rest();
    abort.abort();
  };
}

