// Around a circle of radius 1; and over a surface, which has two directions.
const chords = (tol) => Math.ceil(Math.PI / Math.acos(1 - tol));
const triangles = (tol) => 2 * chords(tol) ** 2;
console.log([0.04, 0.02, 0.01].map((tol) => [chords(tol), triangles(tol)]));
