// The viewer with one dot in its middle, for the test that measures it.
import { Viewer } from "../../../src/viewer/viewer";

declare global {
  /** The width of the dot along the middle row, in CSS pixels. */
  var widthOfDot: (size: number) => number;
}

const root = document.getElementById("view")!;
const viewer = new Viewer(root);
viewer.look({ azimuth: 0, elevation: 0, distance: 6, target: [0, 0, 0] });

globalThis.widthOfDot = (size) => {
  viewer.draw({ layers: [{ kind: "points", id: "dot", positions: new Float32Array(3), paint: "#ff0000", size }] });
  // Read in the task that draws it: later the buffer is cleared.
  const drawn = viewer.now();
  const copy = Object.assign(document.createElement("canvas"), { width: drawn.width, height: drawn.height });
  const context = copy.getContext("2d")!;
  context.drawImage(drawn, 0, 0);
  const row = context.getImageData(0, Math.floor(drawn.height / 2), drawn.width, 1).data;
  let painted = 0;
  for (let i = 3; i < row.length; i += 4) painted += row[i]! > 127 ? 1 : 0;
  // The viewer may use a lower pixel ratio than the screen has.
  return (painted * root.clientWidth) / drawn.width;
};
