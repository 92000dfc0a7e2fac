import { BufferGeometry, Float32BufferAttribute } from "three";

const square = new BufferGeometry(); // two triangles, four vertices
const corners = [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0];
square.setAttribute("position", new Float32BufferAttribute(corners, 3));
square.setIndex([0, 1, 2, 0, 2, 3]);
const bytes = 12 * square.attributes.position.count + 2 * square.index.count;
