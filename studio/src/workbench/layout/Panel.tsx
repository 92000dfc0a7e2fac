// A panel that slides over the picture: at a side of a window, or as a sheet at the bottom of a phone.
import type { ComponentChildren } from "preact";
import type { Language } from "../texts";
import { type LayoutControl, type PanelName, type Side, isPhone, limitsOf, within } from "./layout";
import { LAYOUT_TEXTS } from "./texts";

interface PanelProps {
  name: PanelName;
  language: Language;
  control: LayoutControl;
  children: ComponentChildren;
}

/** Pixels for an arrow key on the edge of a panel. */
const STEP = 16;

export function Panel({ name, language, control, children }: PanelProps) {
  const words = LAYOUT_TEXTS[language];
  const isLeft = name === "input";
  return (
    <section class={`sheet ${isLeft ? "at-left" : "at-right"}`} id={`panel-${name}`} hidden={!control.isOpen(name)} aria-labelledby={`title-${name}`}>
      <div class="sheet-head">
        <h2 id={`title-${name}`}>{words.panel[name]}</h2>
        <button type="button" class="close" aria-label={`${words.close}: ${words.panel[name]}`} onClick={() => closed(name, control)}>
          ×
        </button>
      </div>
      <div class="sheet-body">{children}</div>
      <Edge name={name} label={words.resize[name]} control={control} />
    </section>
  );
}

/** Closes a panel; the focus goes to the button that opens it. */
function closed(name: PanelName, control: LayoutControl): void {
  control.toggle(name);
  document.querySelector<HTMLElement>(`[data-panel="${name}"]`)?.focus();
}

/** The edge by which a panel is made larger or smaller, by pointer or keys. */
function Edge({ name, label, control }: { name: PanelName; label: string; control: LayoutControl }) {
  const { layout, change } = control;
  const side = (): Side => (isPhone() ? "sheet" : name === "input" ? "left" : "rightWidth");
  const now = side();
  const set = (size: number) => change({ [side()]: within(side(), size) });
  const sizeAt = (x: number, y: number) => {
    const body = document.querySelector(".bench")!.getBoundingClientRect();
    return { left: x - body.left, rightWidth: body.right - x, sheet: body.bottom - y - bars() }[side()];
  };
  const [low, high] = typeof innerWidth === "number" && control.isOpen(name) ? limitsOf(now) : [0, 1];
  return (
    <div
      class="edge"
      role="separator"
      tabIndex={0}
      aria-label={label}
      aria-orientation={now === "sheet" ? "horizontal" : "vertical"}
      aria-valuenow={Math.min(Math.max(layout[now], low), high)}
      aria-valuemin={low}
      aria-valuemax={high}
      onPointerDown={(event) => {
        if (event.button !== 0) return;
        event.preventDefault();
        const edge = event.currentTarget;
        edge.setPointerCapture(event.pointerId);
        const abort = new AbortController();
        edge.addEventListener("pointermove", (move) => set(sizeAt(move.clientX, move.clientY)), abort);
        for (const end of ["pointerup", "pointercancel"]) edge.addEventListener(end, () => abort.abort(), abort);
      }}
      onKeyDown={(event) => {
        const grows = { left: "ArrowRight", rightWidth: "ArrowLeft", sheet: "ArrowUp" }[side()];
        const shrinks = { left: "ArrowLeft", rightWidth: "ArrowRight", sheet: "ArrowDown" }[side()];
        if (event.key !== grows && event.key !== shrinks) return;
        event.preventDefault();
        set(layout[side()] + (event.key === grows ? STEP : -STEP));
      }}
    />
  );
}

/** The height of the bars below a sheet. */
const bars = (): number => [...document.querySelectorAll(".status, .tabs-of-panels")].reduce((sum, one) => sum + one.clientHeight, 0);

/** The buttons that open the panels. */
export function PanelButtons({ names, language, control, counts }: Omit<PanelProps, "name" | "children"> & { names: readonly PanelName[]; counts: Partial<Record<PanelName, string>> }) {
  const words = LAYOUT_TEXTS[language];
  return (
    <nav class="tabs-of-panels" aria-label={words.panels}>
      {names.map((name) => (
        <button
          type="button"
          key={name}
          data-panel={name}
          aria-expanded={control.isOpen(name)}
          aria-controls={`panel-${name}`}
          onClick={() => control.toggle(name)}
        >
          {words.short[name]}
          {counts[name] && <span class="count">{counts[name]}</span>}
        </button>
      ))}
    </nav>
  );
}
