"""One peer that makes distances from a mesh: `peers.py WHO THREADS MESH GRID` prints a line of JSON.

Its values are asked for at the samples of Chordal's grid, and compared with them: the largest difference in cells where both
hold distances, and how many have the other sign.
"""

import json
import sys
import time

import numpy as np

who, threads, path, grid = sys.argv[1], int(sys.argv[2]), sys.argv[3], sys.argv[4]
raw = open(path, "rb").read()
n, m = np.frombuffer(raw, "<u4", 2)
points = np.frombuffer(raw, "<f8", 3 * int(n), 8).reshape(-1, 3).copy()
faces = np.frombuffer(raw, "<u4", 3 * int(m), 8 + 24 * int(n)).reshape(-1, 3).copy()
numbers = np.fromfile(grid, "<f8")
size, step, origin, band = numbers[:3].astype(int), numbers[3], numbers[4:7], numbers[7]
exact = numbers[8:].reshape(size[2], size[1], size[0])
axes = [origin[k] + step * np.arange(size[k]) for k in range(3)]
z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
asked = np.stack([x, y, z], axis=-1).reshape(-1, 3)


def timed(work, repeats):
    """The median of the seconds, and the last result."""
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        found = work()
        seconds.append(time.perf_counter() - start)
    return sorted(seconds)[len(seconds) // 2], found


def open3d():
    """A scene of rays, its own tree included."""
    import open3d as o3d

    def work():
        scene = o3d.t.geometry.RaycastingScene(nthreads=threads)
        scene.add_triangles(o3d.core.Tensor(points.astype(np.float32)), o3d.core.Tensor(faces.astype(np.uint32)))
        return scene.compute_signed_distance(o3d.core.Tensor(asked.astype(np.float32)), nthreads=threads).numpy()

    return timed(work, 1)


def igl():
    """Signs by pseudonormals."""
    import igl as lib

    def work():
        kind = lib.SIGNED_DISTANCE_TYPE_PSEUDONORMAL
        return lib.signed_distance(asked, points, faces.astype(np.int64), sign_type=kind)[0]

    return timed(work, 1)


def openvdb():
    """A narrow band of three voxels on each side."""
    import pyopenvdb as vdb

    turn = vdb.createLinearTransform([[step, 0, 0, 0], [0, step, 0, 0], [0, 0, step, 0], [*origin, 1]])
    seconds, made = timed(lambda: vdb.FloatGrid.createLevelSetFromPolygons(
        points.astype(np.float32), triangles=faces.astype(np.uint32), transform=turn, halfWidth=3.0), 3)
    values = np.zeros(tuple(size), np.float32)
    made.copyToArray(values, ijk=(0, 0, 0))
    return seconds, values.transpose(2, 1, 0)


seconds, values = {"open3d": open3d, "igl": igl, "openvdb": openvdb}[who]()
values = np.asarray(values, np.float64).reshape(exact.shape)
near = np.abs(exact) < min(band, 3 * step) * 0.999
off = np.abs(values - exact)[near].max() / step
wrong = int(((values < 0) != (exact < 0))[np.abs(exact) > 1e-9].sum())
print(json.dumps({"seconds": seconds, "off": float(off), "wrong": wrong}))
