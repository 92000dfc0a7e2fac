// A slice through a sampled field as a picture: inside and outside in two colours, iso-lines of the distance, the surface.
import type { Slice } from "./outcome";

/** Iso-lines between the surface and the largest distance. */
const LINES = 14;
const INSIDE = [31, 95, 184] as const;
const OUTSIDE = [214, 160, 96] as const;
const SURFACE = [198, 42, 18] as const;
/** Pixels per cell of the field; enough for smooth lines. */
const DOTS = 6;

export function drawSlice(canvas: HTMLCanvasElement, { size, samples, spacing }: Slice, height: number): void {
  const [nx, ny, nz] = size;
  const layer = Math.round(height * (nz - 1));
  const [width, tall] = [(nx - 1) * DOTS, (ny - 1) * DOTS];
  Object.assign(canvas, { width, height: tall });
  const context = canvas.getContext("2d");
  if (!context) return;
  const image = context.createImageData(width, tall);
  const sample = (x: number, y: number) => samples[x + nx * (y + ny * layer)]!;
  const largest = (spacing * Math.max(nx, ny)) / 2;
  const step = largest / LINES;
  for (let row = 0; row < tall; row++) {
    for (let column = 0; column < width; column++) {
      // Rows of a picture run down, and y runs up.
      const [u, v] = [column / DOTS, (tall - 1 - row) / DOTS];
      const [x, y] = [Math.floor(u), Math.floor(v)];
      const [s, t] = [u - x, v - y];
      const value = (1 - t) * ((1 - s) * sample(x, y) + s * sample(x + 1, y)) + t * ((1 - s) * sample(x, y + 1) + s * sample(x + 1, y + 1));
      const shade = 1 - 0.55 * Math.min(Math.abs(value) / largest, 1);
      // The distance from the nearest multiple of a step, which is where a line is.
      const line = Math.abs(value / step - Math.round(value / step)) * step;
      const isSurface = Math.abs(value) < spacing / 3;
      const base = isSurface ? SURFACE : value < 0 ? INSIDE : OUTSIDE;
      const dark = !isSurface && line < spacing / 8 ? 0.75 : 1;
      const offset = 4 * (row * width + column);
      for (let k = 0; k < 3; k++) {
        const paper = value < 0 ? 235 : 250;
        image.data[offset + k] = isSurface ? base[k]! : (base[k]! + (paper - base[k]!) * shade) * dark;
      }
      image.data[offset + 3] = 255;
    }
  }
  context.putImageData(image, 0, 0);
}
