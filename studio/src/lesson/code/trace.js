function trace(f, eye, way, most = 100) {
  for (let t = 0, step = 0; step < most; step++) {
    const value = f(eye.map((e, i) => e + t * way[i]));
    if (value < 1e-4) return { t, step };
    t += value; // nothing is nearer, so this is safe
  }
}
