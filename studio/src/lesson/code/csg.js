const union = (a, b) => (p) => Math.min(a(p), b(p));
const intersection = (a, b) => (p) => Math.max(a(p), b(p));
const difference = (a, b) => (p) => Math.max(a(p), -b(p));

const block = ([x, y, z]) => Math.max(Math.abs(x) - 1, Math.abs(y) - 1, Math.abs(z) - 0.5);
const part = difference(block, ([x, y]) => Math.hypot(x, y) - 0.4);
