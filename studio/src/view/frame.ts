// Maps between the drawing's units and the pixels of a figure: scale, shift, and y turned over.
import type { Point } from "../core/types";
import { WORLD } from "../state/state";

export class Frame {
  /** CSS pixels in one unit. */
  readonly scale: number;
  readonly height: number;

  /** `width` in CSS pixels. */
  constructor(readonly width: number) {
    this.scale = width / (WORLD.width + 2 * WORLD.margin);
    this.height = this.scale * (WORLD.height + 2 * WORLD.margin);
  }

  /** The position in the figure of a point of the drawing. */
  to([x, y]: Point): Point {
    return [(x + WORLD.margin) * this.scale, (WORLD.height + WORLD.margin - y) * this.scale];
  }

  /** The point of the drawing at a position in the figure. */
  from([x, y]: Point): Point {
    return [x / this.scale - WORLD.margin, WORLD.height + WORLD.margin - y / this.scale];
  }
}

/** A number for an SVG attribute: rounded to a hundredth of a pixel, which is invisible. */
export function px(value: number): string {
  return String(Math.round(value * 100) / 100);
}

export function pair(point: Point): string {
  return `${px(point[0])} ${px(point[1])}`;
}

/** The path of a cubic: the browser draws it from the same four points. */
export function cubicPath([a, b, c, d]: readonly Point[]): string {
  return `M${pair(a!)}C${pair(b!)} ${pair(c!)} ${pair(d!)}`;
}

export function linePath(points: readonly Point[]): string {
  return points.length ? `M${points.map(pair).join("L")}` : "";
}
