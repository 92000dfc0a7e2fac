// The unit of a shape's lengths, as its file states it.

const SYMBOLS: readonly (readonly [metres: number, symbol: string])[] = [
  [1e-6, "µm"],
  [1e-3, "mm"],
  [1e-2, "cm"],
  [0.0254, "in"],
  [0.3048, "ft"],
  [1, "m"],
  [1000, "km"],
];

/** The symbol of a unit of so many metres; empty if the shape states none, or an unusual one. */
export const unitOf = (metres: number | null): string => SYMBOLS.find(([size]) => metres !== null && Math.abs(metres / size - 1) < 1e-9)?.[1] ?? "";
