from collections import Counter

def has_inside(faces):
    edges = Counter(e for a, b, c in faces for e in ((a, b), (b, c), (c, a)))
    return all(n == 1 and (b, a) in edges for (a, b), n in edges.items())
