import numpy as np

def bernstein(t):
    return (1 - t)**3, 3 * t * (1 - t)**2, 3 * t**2 * (1 - t), t**3

def patch(points, u, v):
    return np.einsum("i,j,ijk", bernstein(v), bernstein(u), points)

spout = np.loadtxt("teapot.bpt", skiprows=274, max_rows=16).reshape(4, 4, 3)
