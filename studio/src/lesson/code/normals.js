function smooth(geometry) { // the average of the faces around each vertex
  geometry.computeVertexNormals();
  return geometry;
}
const flat = (geometry) => smooth(geometry.toNonIndexed()); // each face by itself
