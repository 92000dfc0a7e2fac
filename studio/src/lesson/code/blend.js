import { Triangle, Vector3 } from "three";

function blend([a, b, c], values, p) {
  const weights = Triangle.getBarycoord(p, a, b, c, new Vector3()).toArray();
  return [weights, weights.reduce((sum, w, i) => sum + w * values[i], 0)];
}
