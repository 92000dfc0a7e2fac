// The small parts that the texts of the lesson are written with: a term, a number that is a handle, a formula. They are plain
// HTML that reads without script; enhance.ts makes them work.
import type { ComponentChildren } from "preact";
import type { TermId } from "./outline";

/** A word of the field at its first use: a link to its entry at the end, which a script shows in place. */
export function Term({ id, children }: { id: TermId; children: ComponentChildren }) {
  return (
    <dfn id={`use-${id}`}>
      <a class="term" href={`#term-${id}`}>
        {children}
      </a>
    </dfn>
  );
}

/** A formula in its own line. */
export const Formula = ({ children }: { children: ComponentChildren }) => <p class="formula">{children}</p>;

interface HandleProps {
  /** The figure and the part of its state that the number changes. */
  figure: string;
  field: string;
  /** The value that stands in the text at first. */
  value: number;
  low: number;
  high: number;
  step?: number;
  /** What it is, for assistive technology. */
  name: string;
  /** Multiplies the value before it is shown, for a unit. */
  unit?: string;
  /** The text of each value from `low`, if it is not the number itself. */
  shown?: readonly string[];
}

/** A number of the text that can be dragged, or moved by the arrow keys, and changes a figure. */
export function Handle({ figure, field, value, low, high, step = 1, name, unit = "", shown }: HandleProps) {
  const text = shown ? shown[value - low] : String(value) + unit;
  return (
    <span
      class="handle-of"
      data-handle={figure}
      data-field={field}
      data-value={value}
      data-low={low}
      data-high={high}
      data-step={step}
      data-unit={unit}
      data-name={name}
      {...(shown ? { "data-shown": JSON.stringify(shown) } : {})}
    >
      {text}
    </span>
  );
}

/** Words that set a figure to a state. Without script they are words. */
export function Set({ figure, to, children }: { figure: string; to: Record<string, unknown>; children: ComponentChildren }) {
  return (
    <span class="set-of" data-set={figure} data-to={JSON.stringify(to)}>
      {children}
    </span>
  );
}
