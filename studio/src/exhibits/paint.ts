// The paints of 3D figures. They are the same in light and dark themes, so that a still picture need not know the theme.
export const PAINT = {
  /** The front of a surface, and of a second one beside it. */
  front: "#7ea6d8",
  other: "#a9c4e6",
  /** The back, to show the winding. */
  back: "#e0875a",
  /** Highlighted triangles. */
  mark: "#f2c14e",
} as const;
/** The colours of the corners, in red, green and blue. */
export const CORNERS = [
  [0.86, 0.2, 0.18],
  [0.16, 0.62, 0.3],
  [0.16, 0.38, 0.86],
  [0.95, 0.76, 0.2],
] as const;
