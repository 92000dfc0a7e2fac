function isManifold(faces) {
  const edges = new Map();
  for (const f of faces)
    f.forEach((a, i) => edges.set(`${a} ${f[(i + 1) % 3]}`, (edges.get(`${a} ${f[(i + 1) % 3]}`) ?? 0) + 1));
  return [...edges].every(([edge, n]) => n === 1 && edges.get(edge.split(" ").reverse().join(" ")) === 1);
}
