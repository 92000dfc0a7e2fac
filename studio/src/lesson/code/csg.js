const union = (a, b) => (p) => Math.min(a(p), b(p));
const intersection = (a, b) => (p) => Math.max(a(p), b(p));
const difference = (a, b) => (p) => Math.max(a(p), -b(p));

const block = (p) => Math.max(...p.map((x, i) => Math.abs(x) - [1, 1, 0.5][i]));
const part = difference(block, ([x, y]) => Math.hypot(x, y) - 0.4);
