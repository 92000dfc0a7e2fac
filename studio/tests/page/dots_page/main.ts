// The viewer with one dot, line or mark in its middle, for the tests that measure them.
import type { Layer } from "../../../src/viewer";
import { Viewer } from "../../../src/viewer/viewer";

declare global {
  /** The width of a dot or a line along the middle row, in CSS pixels. */
  var widthOf: (what: "dot" | "line", size: number) => number;
  /** The colour of a red mark in the middle, before or behind a white wall. */
  var colorOfMark: (what: "dot" | "line", isBehind: boolean) => number[];
}

const root = document.getElementById("view")!;
const viewer = new Viewer(root);
viewer.look({ azimuth: 0, elevation: 0, distance: 6, target: [0, 0, 0] });

type What = "dot" | "line";
/** A dot of that width, or a vertical line, at this x; the eye is at x = 6. */
const red = (what: What, size: number, x = 0): Layer =>
  what === "dot"
    ? { kind: "points", id: "red", positions: new Float32Array([x, 0, 0]), paint: "#ff0000", size, isMark: true }
    : { kind: "lines", id: "red", positions: new Float32Array([x, 0, -1, x, 0, 1]), paint: "#ff0000", width: size, isMark: true };
const WALL: Layer = {
  kind: "mesh",
  id: "wall",
  positions: new Float32Array([0, -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1]),
  indices: new Uint32Array([0, 1, 2, 0, 2, 3]),
  paint: "#ffffff",
  shading: "none",
  sides: "both",
};

/** The middle row of the picture. */
function middleRow(layers: Layer[]): Uint8ClampedArray {
  viewer.draw({ layers });
  // Read in the task that draws it: later the buffer is cleared.
  const drawn = viewer.now();
  const copy = Object.assign(document.createElement("canvas"), { width: drawn.width, height: drawn.height });
  const context = copy.getContext("2d")!;
  context.drawImage(drawn, 0, 0);
  return context.getImageData(0, Math.floor(drawn.height / 2), drawn.width, 1).data;
}

globalThis.widthOf = (what, size) => {
  const row = middleRow([red(what, size)]);
  let painted = 0;
  for (let i = 3; i < row.length; i += 4) painted += row[i]! > 127 ? 1 : 0;
  // The viewer may use a lower pixel ratio than the screen has.
  return (painted * 4 * root.clientWidth) / row.length;
};

globalThis.colorOfMark = (what, isBehind) => {
  const row = middleRow([WALL, red(what, 9, isBehind ? -0.5 : 0.5)]);
  return [...row.slice(4 * Math.floor(row.length / 8)).slice(0, 3)];
};
