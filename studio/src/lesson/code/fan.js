import { ShapeUtils, Vector2 } from "three";

const fan = (n) => // a convex polygon, from its first corner
  Array.from({ length: n - 2 }, (_, i) => [0, i + 1, i + 2]);

const arrow = [[0, 0], [4, 2], [0, 4], [1, 2]].map((p) => new Vector2(...p));
const faces = ShapeUtils.triangulateShape(arrow, []); // any other, by its ears
