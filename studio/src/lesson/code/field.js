const ball = ([x, y, z]) => Math.hypot(x, y, z) - 1;

function normal(f, p, h = 1e-4) { // central differences
  const moved = (k, by) => p.map((x, i) => (i === k ? x + by : x));
  const g = [0, 1, 2].map((k) => f(moved(k, h)) - f(moved(k, -h)));
  return g.map((x) => x / Math.hypot(...g));
}
