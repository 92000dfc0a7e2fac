const side = (a, b, p) => // twice the signed area: positive on the left
  (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
const inside = (a, b, c, p) => {
  const signs = [side(a, b, p), side(b, c, p), side(c, a, p)];
  return Math.min(...signs) >= 0 || Math.max(...signs) <= 0;
};
