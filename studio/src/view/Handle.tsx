// A point that can be moved by finger, mouse and keyboard. For assistive technology it is a slider with a spoken value.
import type { TargetedPointerEvent } from "preact";
import type { Point } from "../core/types";
import { WORLD, onGrid } from "../state/state";
import type { Frame } from "./frame";
import { pair } from "./frame";

export type Move = (change: (at: Point) => Point) => void;

interface Props {
  name: string;
  spoken: string;
  /** Id of the text that lists the keys that move it. */
  help?: string;
  at: Point;
  frame: Frame;
  kind: "end" | "inner" | "joint";
  /** Only drawn, without interaction. */
  isStill: boolean;
  /** Applies `change` to the point's position at that time, which may be newer than `at`. */
  move: Move;
}

/** Steps of the arrow keys, in units: usual, with Shift, and of Page Up and Page Down. */
const STEP = { usual: 0.1, small: 0.01, large: 1 };

export function Handle({ name, spoken, help, at, frame, kind, isStill, move }: Props) {
  const key = (event: KeyboardEvent) => {
    const step = stepOf(event);
    if (!step) return;
    event.preventDefault();
    move((at) => onGrid(step(at)));
  };
  const dot =
    kind === "inner" ? <rect class="dot" x={-6} y={-6} width={12} height={12} rx={2} /> : <circle class="dot" r={7} />;
  const transform = `translate(${pair(frame.to(at))})`;
  if (isStill) {
    return (
      <g class={`handle ${kind}`} aria-hidden="true" transform={transform}>
        {dot}
      </g>
    );
  }
  return (
    <g
      class={`handle ${kind}`}
      role="slider"
      tabindex={0}
      aria-label={name}
      aria-valuemin={0}
      aria-valuemax={WORLD.width}
      aria-valuenow={at[0]}
      aria-valuetext={spoken}
      {...(help ? { "aria-describedby": help } : {})}
      transform={transform}
      onKeyDown={key}
      onPointerDown={(event: TargetedPointerEvent<SVGGElement>) => grab(event, at, frame, move)}
    >
      <circle class="reach" r={22} />
      {dot}
    </g>
  );
}

function stepOf(event: KeyboardEvent): ((at: Point) => Point) | undefined {
  if (event.ctrlKey || event.altKey || event.metaKey) return undefined;
  const step = event.shiftKey ? STEP.small : STEP.usual;
  const by = (dx: number, dy: number) => ([x, y]: Point): Point => [x + dx, y + dy];
  switch (event.key) {
    case "ArrowLeft":
      return by(-step, 0);
    case "ArrowRight":
      return by(step, 0);
    case "ArrowUp":
      return by(0, step);
    case "ArrowDown":
      return by(0, -step);
    case "PageUp":
      return by(0, STEP.large);
    case "PageDown":
      return by(0, -STEP.large);
    case "Home":
      return ([, y]) => [0, y];
    case "End":
      return ([, y]) => [WORLD.width, y];
    default:
      return undefined;
  }
}

function grab(event: TargetedPointerEvent<SVGGElement>, at: Point, frame: Frame, move: Move) {
  if (event.button !== 0) return;
  const grip = event.currentTarget;
  const pointAt = pointerIn(grip, frame);
  // The point keeps its offset from the finger, so that a touch alone does not move it.
  const start = pointAt(event);
  const offset = [at[0] - start[0], at[1] - start[1]] as const;
  follow(event, (now) => {
    const [x, y] = pointAt(now);
    move(() => onGrid([x + offset[0], y + offset[1]]));
  });
}

/** Turns pointer events into points of the drawing. The figure must stay in place during the drag. */
export function pointerIn(element: SVGGraphicsElement, frame: Frame): (event: PointerEvent) => Point {
  const box = (element.ownerSVGElement ?? element).getBoundingClientRect();
  const ratio = frame.width / box.width;
  return (event) => frame.from([(event.clientX - box.left) * ratio, (event.clientY - box.top) * ratio]);
}

/** Captures the pointer and follows it until it is lifted. */
export function follow(event: TargetedPointerEvent<SVGElement>, moved: (event: PointerEvent) => void) {
  const grip = event.currentTarget;
  grip.setPointerCapture(event.pointerId);
  const ofThisPointer = (handle: (event: PointerEvent) => void) => (event: Event) => {
    if ((event as PointerEvent).pointerId === pointer) handle(event as PointerEvent);
  };
  const pointer = event.pointerId;
  const step = ofThisPointer(moved);
  const end = ofThisPointer(() => {
    grip.removeEventListener("pointermove", step);
    grip.removeEventListener("pointerup", end);
    grip.removeEventListener("pointercancel", end);
  });
  grip.addEventListener("pointermove", step);
  grip.addEventListener("pointerup", end);
  grip.addEventListener("pointercancel", end);
}
