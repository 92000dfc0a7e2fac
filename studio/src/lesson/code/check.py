from collections import Counter

def is_manifold(faces):
    edges = Counter((a, b) for f in faces for a, b in zip(f, (f[1], f[2], f[0])))
    return all(count == 1 and edges[b, a] == 1 for (a, b), count in list(edges.items()))
