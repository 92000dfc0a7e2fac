const lerp = (p, q, t) => p.map((a, i) => a + t * (q[i] - a));

function casteljau(points, t) {
  while (points.length > 1)
    points = points.slice(1).map((q, i) => lerp(points[i], q, t));
  return points[0];
}
