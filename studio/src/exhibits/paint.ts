// The paints of things in space. They are the same by day and by night, so that a still picture needs to know neither.
export const PAINT = {
  /** The front of a surface, and a second one beside it. */
  front: "#7ea6d8",
  other: "#a9c4e6",
  /** The back, where winding matters. */
  back: "#e0875a",
  /** What is picked out. */
  mark: "#f2c14e",
} as const;
/** The red, green and blue of three corners, and a fourth. */
export const CORNERS = [
  [0.86, 0.2, 0.18],
  [0.16, 0.62, 0.3],
  [0.16, 0.38, 0.86],
  [0.95, 0.76, 0.2],
] as const;
