import { BufferAttribute, BufferGeometry } from "three";

const square = new BufferGeometry();
square.setAttribute("position", new BufferAttribute(new Float32Array([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]), 3));
square.setIndex([0, 1, 2, 0, 2, 3]); // two triangles, four vertices
const bytes = 12 * square.attributes.position.count + 2 * square.index.count;
