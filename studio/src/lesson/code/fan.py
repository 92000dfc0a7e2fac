import chordal

def fan(n):  # a convex polygon, from its first corner
    return [(0, i, i + 1) for i in range(1, n - 1)]

arrow = b"v 0 0 0\nv 4 2 0\nv 0 4 0\nv 1 2 0\nf 1 2 3 4\n"
print(chordal.load(arrow, format="obj").faces)  # any other, by its ears
