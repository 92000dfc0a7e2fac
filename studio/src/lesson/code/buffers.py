import chordal

teapot = chordal.mesh("teapot.bpt", tol=0.05)
vertices, faces = teapot.vertices, teapot.faces
indexed = 12 * len(vertices) + 6 * len(faces)  # bytes: three floats, three 16-bit indices
print(indexed, "instead of", 36 * len(faces), "bytes;", len(faces) * 3 / len(vertices), "triangles a vertex")
