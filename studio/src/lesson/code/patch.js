const lerp = (p, q, t) => p.map((a, k) => a + t * (q[k] - a));
const next = (points, t) => points.slice(1).map((q, i) => lerp(points[i], q, t));
const curve = (points, t) => points[1] ? curve(next(points, t), t) : points[0];

const patch = (rows, u, v) => // a curve whose points run along curves
  curve(rows.map((row) => curve(row, u)), v);
