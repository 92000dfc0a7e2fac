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
  /** The radius of the area that can be grabbed; smaller where handles are close together. */
  reach?: number;
  /** Drawn smaller and paler. */
  isFaint?: boolean;
  /** The only direction in which it moves, in degrees clockwise from up; shown as a double arrow. */
  along?: number;
  /** Called at the start of a drag; the returned function is called with the pointer's way since then. */
  grab(): (dx: number, dy: number) => void;
  /** Called for keys, with steps to the right and up; `Home` and `End` are −∞ and ∞. */
  step(right: number, up: number): void;
  /** Called for Page Up and Page Down instead of `step`, with steps away from the eye. */
  deepen?(away: number): void;
  /** Called if it gets the focus, also at the start of a drag. */
  chosen?(): void;
}

/** Steps of the arrow keys: usual, with Shift, and of Page Up and Page Down. */
const STEP = { usual: 1, small: 0.1, large: 10 } as const;

export function Grip(props: GripProps) {
  const { name, spoken, now, low, high, at, isStill, reach = 24, isFaint = false, along, grab, chosen } = props;
  const picture = (
    <>
      {along !== undefined && (
        <path class="along" d="M0-28V-13M-5-22L0-28L5-22M0 28V13M-5 22L0 28L5 22" transform={`rotate(${Math.round(along)})`} />
      )}
      <circle class="dot" r={isFaint ? 6 : 8} />
    </>
  );
  const transform = `translate(${px(at[0])} ${px(at[1])})`;
  const look = isFaint ? "grip faint" : "grip";
  if (isStill) {
    return (
      <g class={look} transform={transform} aria-hidden="true">
        {picture}
      </g>
    );
  }
  return (
    <g
      class={look}
      role="slider"
      tabindex={0}
      aria-label={name}
      aria-valuemin={low}
      aria-valuemax={high}
      aria-valuenow={now}
      aria-valuetext={spoken}
      transform={transform}
      onFocus={chosen}
      onKeyDown={(event) => keyed(event, props)}
      onPointerDown={(event) => follow(event, grab)}
    >
      <circle class="reach" r={reach} />
      {picture}
    </g>
  );
}

function keyed(event: KeyboardEvent, { step, deepen }: GripProps) {
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
  if (deepen && event.key.startsWith("Page")) deepen(event.key === "PageUp" ? size : -size);
  else step(...move);
}

function follow(event: TargetedPointerEvent<SVGGElement>, grab: GripProps["grab"]) {
  if (event.button !== 0) return;
  event.stopPropagation();
  const grip = event.currentTarget;
  const svg = grip.ownerSVGElement!;
  const ratio = svg.viewBox.baseVal.width / svg.getBoundingClientRect().width || 1;
  grip.setPointerCapture(event.pointerId);
  // Not every browser focuses an element of an SVG by a touch.
  grip.focus({ preventScroll: true });
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
