const lerp = (p, q, t) => p.map((a, i) => a + t * (q[i] - a));

function casteljau(points, t) {
  if (points.length === 1) return points[0];
  return casteljau(points.slice(1).map((q, i) => lerp(points[i], q, t)), t);
}
