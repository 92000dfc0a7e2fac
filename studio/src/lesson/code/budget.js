// Around a circle of radius 1, and over a surface, which has two directions.
const chords = (tolerance) => Math.ceil(Math.PI / Math.acos(1 - tolerance));
const triangles = (tolerance) => 2 * chords(tolerance) ** 2;
console.log([0.04, 0.02, 0.01].map((tolerance) => [chords(tolerance), triangles(tolerance)]));
