import { Vector3 } from "three";

const minus = (a, b) => new Vector3().subVectors(a, b);
const normal = (v0, v1, v2) => minus(v1, v0).cross(minus(v2, v0)).normalize();
