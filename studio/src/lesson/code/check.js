function hasInside(faces) {
  const edges = faces.flatMap(([a, b, c]) => [[a, b], [b, c], [c, a]]);
  const known = new Set(edges.map(String));
  const hasTwin = ([a, b]) => known.has(String([b, a]));
  return known.size === edges.length && edges.every(hasTwin);
}
