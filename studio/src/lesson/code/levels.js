const pixelsOf = (length, distance, height = 1080, fov = Math.PI / 4) =>
  (length / distance) * (height / 2 / Math.tan(fov / 2));

const levelAt = (levels, distance) => // from fine to coarse
  levels.findLast(({ error }) => pixelsOf(error, distance) <= 1) ?? levels[0];
