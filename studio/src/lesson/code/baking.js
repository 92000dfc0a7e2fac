const row = (n, value) => Array.from({ length: n }, (_, i) => value(i));
const bake = (f, n) => row(n, (x) => row(n, (y) => row(n, (z) => f([x, y, z]))));

function read(samples, [x, ...rest]) { // linear between neighbours, axis by axis
  const i = Math.min(Math.floor(x), samples.length - 2);
  const at = (k) => rest.length ? read(samples[k], rest) : samples[k];
  return at(i) + (x - i) * (at(i + 1) - at(i));
}
