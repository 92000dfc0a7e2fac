"""One peer on a field: `peers.py WHO MODEL THREADS CELLS OUT` meshes it, writes the mesh and prints a line of JSON."""

import json
import sys
import time

import numpy as np

who, model, threads, cells, out = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4]), sys.argv[5]
HALF = 1.25
STEP = 2 * HALF / cells


def gyroid(x, y, z):
    """A gyroid of frequency 8."""
    x, y, z = 8 * x, 8 * y, 8 * z
    return np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)


def ball(x, y, z, radius):
    """A ball about the origin."""
    return np.sqrt(x * x + y * y + z * z) - radius


#: Negative inside, from three coordinates; numbers or arrays.
MODELS = {
    "ball": lambda x, y, z: ball(x, y, z, 0.6),
    "torus": lambda x, y, z: np.sqrt((np.sqrt(x * x + y * y) - 0.55) ** 2 + z * z) - 0.25,
    "cube-ball": lambda x, y, z: np.maximum(
        np.maximum(np.maximum(abs(x) - 0.5, abs(y) - 0.5), abs(z) - 0.5), -ball(x, y, z, 0.64)
    ),
    "gyroid-ball": lambda x, y, z: np.maximum(gyroid(x, y, z), ball(x, y, z, 0.8)),
}
field = MODELS[model]


def fogleman():
    """The library's own way: a soup of triangles, whose bounds are given."""
    import sdf

    shape = sdf.sdf3(lambda: lambda p: field(p[:, 0], p[:, 1], p[:, 2]))()
    points = shape.generate(step=STEP, bounds=((-HALF,) * 3, (HALF + STEP,) * 3), workers=threads, verbose=False)
    return np.asarray(points, np.float64), np.arange(len(points), dtype=np.uint32).reshape(-1, 3)


def manifold():
    """Positive inside, asked point by point."""
    import math

    from manifold3d import Manifold

    sin, cos, root = math.sin, math.cos, math.sqrt
    scalar = {
        "ball": lambda x, y, z: 0.6 - root(x * x + y * y + z * z),
        "torus": lambda x, y, z: 0.25 - root((root(x * x + y * y) - 0.55) ** 2 + z * z),
        "cube-ball": lambda x, y, z: -max(abs(x) - 0.5, abs(y) - 0.5, abs(z) - 0.5, 0.64 - root(x * x + y * y + z * z)),
        "gyroid-ball": lambda x, y, z: -max(
            sin(8 * x) * cos(8 * y) + sin(8 * y) * cos(8 * z) + sin(8 * z) * cos(8 * x), root(x * x + y * y + z * z) - 0.8
        ),
    }[model]
    made = Manifold.level_set(scalar, (-HALF, -HALF, -HALF, HALF, HALF, HALF), STEP).to_mesh64()
    return np.asarray(made.vert_properties, np.float64)[:, :3], np.asarray(made.tri_verts, np.uint32)


work = {"sdf": fogleman, "manifold": manifold}[who]
seconds = []
for _ in range(3 if who == "sdf" else 1):
    start = time.perf_counter()
    points, faces = work()
    seconds.append(time.perf_counter() - start)
if who == "sdf":
    points, back = np.unique(points, axis=0, return_inverse=True)
    faces = back.reshape(-1)[faces].astype(np.uint32)
with open(out, "wb") as file:
    file.write(np.array([len(points), len(faces)], "<u4").tobytes())
    file.write(np.ascontiguousarray(points, "<f8").tobytes())
    file.write(np.ascontiguousarray(faces, "<u4").tobytes())
print(json.dumps({"seconds": sorted(seconds)[len(seconds) // 2], "triangles": len(faces)}))
