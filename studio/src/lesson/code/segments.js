import { CubicBezierCurve, Vector2 } from "three";

const points = [[1.5, 1.6], [2.2, 7.6], [8.2, 7.4], [10.6, 1.8]].map(([x, y]) => new Vector2(x, y));
const arch = new CubicBezierCurve(...points);
const gap = (n) => // over the middle of the first chord
  arch.getPoint(0.5 / n).distanceTo(arch.getPoint(0).lerp(arch.getPoint(1 / n), 0.5));
