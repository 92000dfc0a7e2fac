// Which panels lie over the picture, and how large they are: remembered in this browser, where that is allowed.
import { useEffect, useState } from "preact/hooks";

/** At the right only one is open at a time. */
export const RIGHT = ["certificate", "findings", "beside", "change", "export"] as const;
export type RightPanel = (typeof RIGHT)[number];
export type PanelName = "input" | RightPanel;

export interface Layout {
  isLeftOpen: boolean;
  right: RightPanel | null;
  /** The widths of the panels, and on a phone the height of the sheet, in pixels. */
  left: number;
  rightWidth: number;
  sheet: number;
  hasGrid: boolean;
  hasSizes: boolean;
}

/** Narrower windows have sheets at the bottom, one at a time. The style sheet has the same number. */
export const PHONE = "(max-width: 50rem)";
/** From this width both sides are open at first. */
const WIDE = 1600;
const KEY = "chordal workbench";
/** The range of a width and of a sheet's height, in pixels; the rest of the window stays free. */
const LIMITS = { left: [260, 640, 0.6], rightWidth: [240, 560, 0.5], sheet: [120, 900, 0.72] } as const;
export type Side = keyof typeof LIMITS;

const FIRST: Layout = { isLeftOpen: true, right: null, left: 440, rightWidth: 320, sheet: 400, hasGrid: true, hasSizes: true };

export const isPhone = () => typeof matchMedia === "function" && matchMedia(PHONE).matches;

export function limitsOf(side: Side): readonly [number, number] {
  const [least, most, share] = LIMITS[side];
  const window_ = side === "sheet" ? innerHeight : innerWidth;
  return [least, Math.max(least, Math.min(most, Math.round(share * window_)))];
}

export function within(side: Side, size: number): number {
  const [least, most] = limitsOf(side);
  return Math.round(Math.min(Math.max(size, least), most));
}

function remembered(): Layout {
  const first: Layout = isPhone() ? { ...FIRST, isLeftOpen: false } : innerWidth >= WIDE ? { ...FIRST, right: "certificate" } : FIRST;
  try {
    const stored = JSON.parse(localStorage.getItem(KEY) ?? "{}") as Record<string, unknown>;
    const known = Object.entries(first).map(([name, usual]) => {
      const value = stored[name];
      const isRight = name === "right" && (value === null || RIGHT.includes(value as RightPanel));
      return [name, isRight || (name !== "right" && typeof value === typeof usual) ? value : usual];
    });
    const layout = Object.fromEntries(known) as unknown as Layout;
    // A layout of a large window may have both sides open.
    return isPhone() && layout.isLeftOpen && layout.right ? { ...layout, right: null } : layout;
  } catch {
    return first;
  }
}

export interface LayoutControl {
  layout: Layout;
  change(change: Partial<Layout>): void;
  /** Opens a panel, or closes it if it is open. */
  toggle(name: PanelName): void;
  isOpen(name: PanelName): boolean;
}

/** `isLive` is false while the page is written at build time. */
export function useLayout(isLive: boolean): LayoutControl {
  const [layout, setLayout] = useState<Layout>(() => (isLive ? remembered() : FIRST));
  const change = (change: Partial<Layout>) => setLayout((old) => ({ ...old, ...change }));
  useEffect(() => {
    if (!isLive) return;
    try {
      localStorage.setItem(KEY, JSON.stringify(layout));
    } catch {
      // Then it lasts as long as the page.
    }
  }, [layout]);
  const isOpen = (name: PanelName) => (name === "input" ? layout.isLeftOpen : layout.right === name);
  const toggle = (name: PanelName) => {
    const opens = !isOpen(name);
    if (name === "input") change({ isLeftOpen: opens, ...(opens && isPhone() ? { right: null } : {}) });
    else change({ right: opens ? name : null, ...(opens && isPhone() ? { isLeftOpen: false } : {}) });
  };
  return { layout, change, toggle, isOpen };
}
