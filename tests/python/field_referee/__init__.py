"""A referee of meshes of fields: it reads a shape script by itself, and shares no code with the library.

- `ranges`: numbers and ranges of numbers under one set of functions.
- `words`, `combine`, `script`: what the words of shape scripts mean, as functions of points or of boxes.
- `mesh`: a mesh from a file, its topology, distances to it, pairs of triangles that cross.
- `surface`: points of the true surface.
- `judge`: the verdict on a mesh with a bound.
- `random_scripts`: scripts drawn by a seed.

A distance is called a violation only where it is shown: a point of the surface (bracketed by two points of opposite
sign) is farther from all triangles than the bound says, or ranges show that the field has one sign on the whole ball
around a point of a triangle. What neither a search nor ranges decide is counted, and is no violation.
"""
