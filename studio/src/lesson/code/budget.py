import chordal

for tol in (0.04, 0.02, 0.01):
    mesh = chordal.mesh("teapot.bpt", tol=tol)
    print(len(mesh.faces), "triangles, at most", mesh.bound.at_most)
