import chordal

teapot = chordal.mesh("teapot.bpt", tol=0.05)
n, m = len(teapot.vertices), len(teapot.faces)
print(12 * n + 6 * m, "bytes instead of", 36 * m)
print(3 * m / n, "triangles share a vertex")
