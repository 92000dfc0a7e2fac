"""Manifold on the pairs of the bench: `peers.py run PAIR OP` or `peers.py random N FOLDER` prints a line of JSON."""

import json
import sys
import time

import manifold3d as m3
import numpy as np


def load(path):
    """The positions and faces of a mesh of the bench."""
    raw = open(path, "rb").read()
    n, m = np.frombuffer(raw, "<u4", 2)
    points = np.frombuffer(raw, "<f8", 3 * int(n), 8).reshape(-1, 3).copy()
    faces = np.frombuffer(raw, "<u4", 3 * int(m), 8 + 24 * int(n)).reshape(-1, 3)
    return points, faces.astype(np.uint64)


def combined(a, op, b):
    """A boolean in double precision, from arrays to arrays."""
    first, second = (m3.Manifold(m3.Mesh64(vert_properties=p, tri_verts=f)) for p, f in (a, b))
    how = {"union": m3.Manifold.__add__, "difference": m3.Manifold.__sub__, "intersection": m3.Manifold.__xor__}
    made = how[op](first, second)
    return made, made.to_mesh64()


def run(pair, op):
    """The median of three."""
    a, b = load(pair + ".a"), load(pair + ".b")
    seconds = []
    for _ in range(3):
        start = time.perf_counter()
        made, mesh = combined(a, op, b)
        seconds.append(time.perf_counter() - start)
    print(json.dumps({"seconds": sorted(seconds)[1], "triangles": len(mesh.tri_verts), "volume": made.volume(),
                      "status": str(made.status())}))


def random(n, folder):
    """How many volumes differ from Chordal's by more than a billionth of the sum."""
    rows = [json.loads(line) for line in open(folder + "/volumes.jsonl")]
    off = 0
    for i in range(n):
        a, b = load(f"{folder}/{i}.a"), load(f"{folder}/{i}.b")
        volumes = [combined(a, op, b)[0].volume() for op in ("union", "difference", "intersection")]
        scale = max(volumes[0], 1.0)
        off += any(abs(x - y) > 1e-9 * scale for x, y in zip(volumes, rows[i]["volumes"]))
    print(json.dumps({"pairs": n, "differ": off}))


if sys.argv[1] == "run":
    run(sys.argv[2], sys.argv[3])
else:
    random(int(sys.argv[2]), sys.argv[3])
