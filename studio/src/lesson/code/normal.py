import numpy as np

def normal(v0, v1, v2):
    n = np.cross(np.subtract(v1, v0), np.subtract(v2, v0))
    return n / np.linalg.norm(n)
