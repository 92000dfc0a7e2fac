import { Vector3 } from "three";

const normal = (v0, v1, v2) =>
  new Vector3().subVectors(v1, v0).cross(new Vector3().subVectors(v2, v0)).normalize();
