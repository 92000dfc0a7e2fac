// What is seen of the shape: its box, the view, the distance of the eye, and the screen for which pixels are counted.
import type { Size, Vec3, View } from "../viewer";
import { fovOf } from "../viewer/view";
import type { Bench, Screen } from "./document";
import { type Part, boxOf, toZUp } from "./glb";
import { type Box, awayFrom, fillingDistance } from "./pixels";
import { framing } from "./stage/framing";
import type { Store } from "./store";

/**
 * Pixels are never counted for a distance nearer than these shares of the one at which the shape fills the picture's height.
 * Chosen: a view from near may at most about double the budget's triangles, because the proof runs unasked; levels run on demand.
 */
const NEAREST = { budget: 1 / 2, levels: 1 / 8 };

export class Sight {
  /** The shape for which the view was set last, and that view. */
  framed: { name: string; up: string | null; view: View } | null = null;
  private room = 1;
  private boxCache: { parts: readonly Part[]; box: Box | undefined } | null = null;
  private proofScreen: { bench: Bench; view: View; size: Size; screen: Screen } | null = null;

  constructor(private readonly store: Store) {}

  private get state() {
    return this.store.state;
  }

  /** The screen of the current proof, or else of this view. */
  get screen(): Screen {
    const { bench: current, size, view } = this.state;
    const { proofScreen } = this;
    // The screen of the current proof, because the box that is known only since must not change its command line.
    if (proofScreen && proofScreen.bench === current && proofScreen.view === view && proofScreen.size === size) return proofScreen.screen;
    return this.screenBy(NEAREST.budget);
  }

  /** Before a proof: its screen is that of this view, however the shape turns out. */
  keepScreen(): void {
    const { bench, view, size } = this.state;
    this.proofScreen = { bench, view, size, screen: this.screen };
  }

  /** The screen of the last proof. */
  get lastScreen(): Screen {
    return this.proofScreen?.screen ?? this.screen;
  }

  /** The screen for levels, which may be nearer. */
  get screenOfLevels(): Screen {
    return this.screenBy(NEAREST.levels);
  }

  private screenBy(nearest: number): Screen {
    const { size } = this.state;
    const ratio = globalThis.devicePixelRatio || 1;
    const [fovDeg, { box }] = [fovOf(size), this];
    const least = box ? nearest * fillingDistance(box, fovDeg) : 0;
    return { width: size.width * ratio, height: size.height * ratio, fovDeg, distance: Math.max(this.away, least) };
  }

  /** The distance from the eye to the nearest point of the shape's box. */
  get away(): number {
    const { box } = this;
    return box ? awayFrom(box, this.state.view) : this.state.view.distance;
  }

  /** Whether the eye is nearer than the distance for which pixels are counted. */
  get isNear(): boolean {
    return this.away < this.screen.distance;
  }

  private get box(): Box | undefined {
    const parts = this.state.shown?.parts ?? [];
    if (this.boxCache?.parts !== parts) this.boxCache = { parts, box: boxOf(parts) };
    return this.boxCache.box;
  }

  /** Sets the view for a new shape; for a changed one it is kept unless the size is very different. Returns whether it was set. */
  frame(current: Bench, parts: readonly Part[], up: string | null, isDragging: boolean): boolean {
    const isNew = this.framed?.name !== current.name;
    const box = boxOf(parts);
    if (isNew && !box) return false;
    if (!box) {
      this.framed = { ...this.framed!, up };
      return false;
    }
    const { view, home } = this.state;
    const next = framing(box, { view, home, before: isNew ? null : this.framed!.view, room: this.room }, isDragging);
    this.framed = { name: current.name, up, view: next.view ?? this.framed!.view };
    this.store.update(next.view ? { home: next.home, view: next.view } : { home: next.home });
    return next.view !== undefined;
  }

  /** The same shape under another name keeps its view; the next shape, after `forget`, gets one of its own. */
  rename(name: string): void {
    if (this.framed) this.framed = { ...this.framed, name };
  }
  forget(): void {
    this.framed = null;
  }

  /** How much farther away a shape fits into what the panels leave of the picture. It concerns the next time that it is fitted. */
  makeRoom(room: number): void {
    if (room === this.room) return;
    const { home } = this.state;
    this.store.update({ home: { ...home, distance: (home.distance * room) / this.room } });
    this.room = room;
  }

  /** A point of the report in the picture's coordinates, with z up. */
  place(at: Vec3): Vec3 {
    return toZUp(at, this.framed?.up ?? null);
  }
}
