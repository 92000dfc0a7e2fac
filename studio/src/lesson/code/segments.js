import { CubicBezierCurve, Vector2 } from "three";

const control = [[1.5, 1.6], [2.2, 7.6], [8.2, 7.4], [10.6, 1.8]];
const arch = new CubicBezierCurve(...control.map((p) => new Vector2(...p)));
const at = (t) => arch.getPoint(t);
const gap = (n) => at(0.5 / n).distanceTo(at(0).lerp(at(1 / n), 0.5));
