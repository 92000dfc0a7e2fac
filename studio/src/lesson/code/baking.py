import chordal

teapot = chordal.mesh("teapot.bpt", tol=0.05)
samples = teapot.bake(cells=20)  # signed distances on a lattice
back = samples.mesh()
print(samples.array.size, "samples,", len(back.faces), "triangles")
print("lost on the way back: at most", back.bound.at_most)
print("lost there and back: at most", teapot.deviation(back).at_most)
