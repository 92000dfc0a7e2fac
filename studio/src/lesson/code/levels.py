import chordal

levels = chordal.load("teapot.bpt").lod(tol=0.005)
for distance in (10, 100, 1000):
    level = levels.at(distance)
    print(distance, len(level.mesh.faces), level.bound.at_most)
