// Colours as numbers: ramps for values, lighting, and the conversion to and from sRGB.
import type { MeshLayer, RampName } from "./layers";

export type Rgb = readonly [number, number, number];

/** Eight steps of cividis and of magma, and from the paint of a surface to a dark orange: readable with colour-blindness and in grey. */
const RAMPS: Record<RampName, readonly string[]> = {
  deviation: ["#00224e", "#213c6e", "#4a556c", "#6c6e72", "#8f8978", "#b4a56c", "#dac550", "#fee838"],
  heat: ["#000004", "#231151", "#5f187f", "#982d80", "#d3436e", "#f8765c", "#febb81", "#fcfdbf"],
  share: ["#dfe7f1", "#e9d8cc", "#f1c4a0", "#f4ab76", "#ee8e52", "#e06e34", "#c84f1e", "#a03810"],
};

export function hex(text: string): Rgb {
  const digits = text.length === 4 ? [...text.slice(1)].map((c) => c + c).join("") : text.slice(1, 7);
  return [0, 2, 4].map((i) => Number.parseInt(digits.slice(i, i + 2), 16) / 255) as unknown as Rgb;
}

/** The colour at a position from 0 to 1 on a ramp. */
export function onRamp(ramp: RampName, share: number): Rgb {
  const stops = RAMPS[ramp];
  const position = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const low = Math.min(Math.floor(position), stops.length - 2);
  const [a, b] = [hex(stops[low]!), hex(stops[low + 1]!)];
  return [0, 1, 2].map((k) => a[k]! + (position - low) * (b[k]! - a[k]!)) as unknown as Rgb;
}

/** The ramp as the stops of a CSS gradient, for the scale beside a picture. */
export const rampStops = (ramp: RampName) => RAMPS[ramp];

/** The colour of every vertex, if the layer has vertex colours or values. */
export function vertexColors(layer: MeshLayer): Float32Array | undefined {
  if (layer.colors) return layer.colors;
  if (!layer.values) return undefined;
  const { of, range, ramp } = layer.values;
  const colors = new Float32Array(3 * of.length);
  of.forEach((value, i) => colors.set(onRamp(ramp, (value - range[0]) / (range[1] - range[0] || 1)), 3 * i));
  return colors;
}

export const toLinear = (x: number) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
export const fromLinear = (x: number) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);

/** The light: ambient, and a sun from the upper left behind the eye. */
export const LIGHT = { ambient: 0.34, sun: 0.82, from: [-0.4, 0.55, 0.73] } as const;

/** A colour under the light; `cosine` is that of the angle between normal and light. */
export function lit(color: Rgb, cosine: number): Rgb {
  const intensity = LIGHT.ambient + LIGHT.sun * Math.max(cosine, 0);
  return color.map((x) => Math.min(fromLinear(toLinear(x) * intensity), 1)) as unknown as Rgb;
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
