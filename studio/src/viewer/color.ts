// Colours as numbers: ramps for values, light, and what a screen makes of it.
import type { MeshLayer, RampName } from "./layers";

export type Rgb = readonly [number, number, number];

/** Eight steps of cividis and of magma: both keep their order for every kind of eyes, and in grey. */
const RAMPS: Record<RampName, readonly string[]> = {
  deviation: ["#00224e", "#213c6e", "#4a556c", "#6c6e72", "#8f8978", "#b4a56c", "#dac550", "#fee838"],
  heat: ["#000004", "#231151", "#5f187f", "#982d80", "#d3436e", "#f8765c", "#febb81", "#fcfdbf"],
};

export function hex(text: string): Rgb {
  const digits = text.length === 4 ? [...text.slice(1)].map((c) => c + c).join("") : text.slice(1, 7);
  return [0, 2, 4].map((i) => Number.parseInt(digits.slice(i, i + 2), 16) / 255) as unknown as Rgb;
}

/** The colour of a share from 0 to 1 of a ramp. */
export function onRamp(ramp: RampName, share: number): Rgb {
  const stops = RAMPS[ramp];
  const at = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const low = Math.min(Math.floor(at), stops.length - 2);
  const [a, b] = [hex(stops[low]!), hex(stops[low + 1]!)];
  return [0, 1, 2].map((k) => a[k]! + (at - low) * (b[k]! - a[k]!)) as unknown as Rgb;
}

/** The ramp as a CSS gradient's stops, for the scale beside a picture. */
export const rampStops = (ramp: RampName) => RAMPS[ramp];

/** The colour of every vertex, where a layer has any. */
export function vertexColors(layer: MeshLayer): Float32Array | undefined {
  if (layer.colors) return layer.colors;
  if (!layer.values) return undefined;
  const { of, range, ramp } = layer.values;
  const all = new Float32Array(3 * of.length);
  of.forEach((value, i) => all.set(onRamp(ramp, (value - range[0]) / (range[1] - range[0] || 1)), 3 * i));
  return all;
}

export const toLinear = (x: number) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
export const fromLinear = (x: number) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);

/** The light: a part from everywhere, and one from the upper left behind the eye. */
export const LIGHT = { all: 0.34, one: 0.82, from: [-0.4, 0.55, 0.73] } as const;

/** A colour under the light, for a cosine between the normal and the light. */
export function lit(color: Rgb, cosine: number): Rgb {
  const much = LIGHT.all + LIGHT.one * Math.max(cosine, 0);
  return color.map((x) => Math.min(fromLinear(toLinear(x) * much), 1)) as unknown as Rgb;
}

export function css(color: Rgb): string {
  return `#${color
    .map((x) =>
      Math.round(255 * Math.min(Math.max(x, 0), 1))
        .toString(16)
        .padStart(2, "0"),
    )
    .join("")}`;
}
