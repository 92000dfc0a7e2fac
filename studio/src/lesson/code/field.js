const ball = ([x, y, z]) => Math.hypot(x, y, z) - 1;

function normal(f, p, h = 1e-4) { // central differences
  const g = [0, 1, 2].map((k) => f(p.map((x, i) => x + h * (i === k))) - f(p.map((x, i) => x - h * (i === k))));
  return g.map((x) => x / Math.hypot(...g));
}
