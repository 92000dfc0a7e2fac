const pixelsOf = (length, distance, height = 1080, fov = Math.PI / 4) =>
  (length / distance) * (height / 2 / Math.tan(fov / 2));

function levelAt(levels, distance) { // from fine to coarse, each with its error
  return levels.findLast(({ error }) => pixelsOf(error, distance) <= 1) ?? levels[0];
}
