import { CubicBezierCurve, Vector2 } from "three";

const control = [[1.7, 0.6], [3.1, 0.825], [2.4, 2.025], [3.3, 2.4]];
const spout = new CubicBezierCurve(...control.map((p) => new Vector2(...p)));
const at = (t) => spout.getPoint(t);
const gap = (n) => at(0.5 / n).distanceTo(at(0).lerp(at(1 / n), 0.5));
