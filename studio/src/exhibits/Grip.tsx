// A handle in a figure, for mouse, touch and keys. For assistive technology it is a slider with a spoken value.
import type { TargetedPointerEvent } from "preact";

interface GripProps {
  name: string;
  spoken: string;
  /** The value and its range, for assistive technology. */
  now: number;
  low: number;
  high: number;
  /** Its position, in the units of the SVG. */
  at: readonly [number, number];
  isStill: boolean;
  /** The only direction in which it moves, in degrees clockwise from up; shown as a double arrow. */
  along?: number;
  /** Called at the start of a drag; the returned function is called with the pointer's way since then. */
  grab(): (dx: number, dy: number) => void;
  /** Called for keys, with steps to the right and up; `Home` and `End` are −∞ and ∞. */
  step(right: number, up: number): void;
}

/** Steps of the arrow keys: usual, with Shift, and of Page Up and Page Down. */
const STEP = { usual: 1, small: 0.1, large: 10 } as const;

export function Grip({ name, spoken, now, low, high, at, isStill, along, grab, step }: GripProps) {
  const picture = (
    <>
      {along !== undefined && (
        <path class="along" d="M0-28V-13M-5-22L0-28L5-22M0 28V13M-5 22L0 28L5 22" transform={`rotate(${Math.round(along)})`} />
      )}
      <circle class="dot" r={8} />
    </>
  );
  const transform = `translate(${px(at[0])} ${px(at[1])})`;
  if (isStill) {
    return (
      <g class="grip" transform={transform} aria-hidden="true">
        {picture}
      </g>
    );
  }
  return (
    <g
      class="grip"
      role="slider"
      tabindex={0}
      aria-label={name}
      aria-valuemin={low}
      aria-valuemax={high}
      aria-valuenow={now}
      aria-valuetext={spoken}
      transform={transform}
      onKeyDown={(event) => keyed(event, step)}
      onPointerDown={(event) => follow(event, grab)}
    >
      <circle class="reach" r={24} />
      {picture}
    </g>
  );
}

function keyed(event: KeyboardEvent, step: GripProps["step"]) {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const size = event.shiftKey ? STEP.small : STEP.usual;
  const moves: Record<string, readonly [number, number]> = {
    ArrowLeft: [-size, 0],
    ArrowRight: [size, 0],
    ArrowUp: [0, size],
    ArrowDown: [0, -size],
    PageUp: [0, STEP.large],
    PageDown: [0, -STEP.large],
    Home: [-Infinity, -Infinity],
    End: [Infinity, Infinity],
  };
  const move = moves[event.key];
  if (!move) return;
  event.preventDefault();
  // The same keys turn the scene behind it.
  event.stopPropagation();
  step(...move);
}

function follow(event: TargetedPointerEvent<SVGGElement>, grab: GripProps["grab"]) {
  if (event.button !== 0) return;
  event.stopPropagation();
  const grip = event.currentTarget;
  const svg = grip.ownerSVGElement!;
  const ratio = svg.viewBox.baseVal.width / svg.getBoundingClientRect().width || 1;
  grip.setPointerCapture(event.pointerId);
  const pointer = event.pointerId;
  const start = [event.clientX, event.clientY] as const;
  const moved = grab();
  const abort = new AbortController();
  const on = (type: string, listen: (event: PointerEvent) => void) =>
    grip.addEventListener(
      type,
      (event) => (event as PointerEvent).pointerId === pointer && listen(event as PointerEvent),
      abort,
    );
  on("pointermove", (now) => moved((now.clientX - start[0]) * ratio, (now.clientY - start[1]) * ratio));
  on("pointerup", () => abort.abort());
  on("pointercancel", () => abort.abort());
}

/** Rounded to a tenth of a pixel. */
export const px = (value: number) => String(Math.round(value * 10) / 10);
