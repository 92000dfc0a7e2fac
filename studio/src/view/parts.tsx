// Small parts that several views use: a number with its full digits, a choice between a few values, a slider.
import { type ComponentChildren, createContext } from "preact";
import { useContext } from "preact/hooks";

/** Put before ids and names of controls, so that several figures can be in one page. */
export const Scope = createContext("");

/** A formatted number, with all its digits in `value` for programs. */
export function Figure({ name, value, children }: { name: string; value: number | null; children: ComponentChildren }) {
  return (
    <data class="number" data-name={name} value={value === null ? "" : String(value)}>
      {children}
    </data>
  );
}

interface RowProps {
  name: string;
  label: ComponentChildren;
  value: number | null;
  class?: string;
  children: ComponentChildren;
}

/** A line of a list of numbers: what it is, and the number. */
export const Row = ({ name, label, value, class: kind, children }: RowProps) => (
  <div class={kind}>
    <dt>{label}</dt>
    <dd>
      <Figure name={name} value={value}>
        {children}
      </Figure>
    </dd>
  </div>
);

interface ChoiceProps<V extends string | number> {
  name: string;
  legend: string;
  value: V;
  options: readonly { value: V; label: ComponentChildren; extra?: ComponentChildren }[];
  choose(value: V): void;
  class?: string;
}

/** A choice of one among a few. Radio buttons, because keyboards and assistive technology support them. */
export function Choice<V extends string | number>({ name, legend, value, options, choose, class: kind }: ChoiceProps<V>) {
  const scope = useContext(Scope);
  return (
    <fieldset class={`choice ${kind ?? ""}`}>
      <legend>{legend}</legend>
      <div class="options">
        {options.map((option) => (
          <label key={option.value}>
            <input type="radio" name={scope + name} value={option.value} checked={option.value === value} onChange={() => choose(option.value)} />
            <span>
              {option.label}
              {option.extra}
            </span>
          </label>
        ))}
      </div>
    </fieldset>
  );
}

/** What is shown is spoken, unless it is no text or has to be said in other words. */
type Shown = { shown: string; spoken?: string } | { shown: ComponentChildren; spoken: string };

type SliderProps = Shown & {
  id: string;
  label: string;
  low: number;
  high: number;
  step?: number;
  value: number;
  choose(value: number): void;
};

export function Slider({ id: ownId, label, shown, spoken, low, high, step = 1, value, choose }: SliderProps) {
  const id = useContext(Scope) + ownId;
  return (
    <div class="slider">
      <label for={id}>{label}</label>
      <output for={id}>{shown}</output>
      <input
        id={id}
        type="range"
        min={low}
        max={high}
        step={step}
        value={value}
        aria-valuetext={spoken ?? String(shown)}
        onInput={(event) => choose(Number(event.currentTarget.value))}
      />
    </div>
  );
}
