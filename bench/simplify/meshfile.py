"""Meshes as the `simplify` program writes and reads them, and as others publish them."""

import numpy as np


def read(path):
    """Points and faces of a file of the `simplify` program."""
    raw = open(path, "rb").read()
    n, m = (int(x) for x in np.frombuffer(raw, "<u4", 2))
    points = np.frombuffer(raw, "<f8", 3 * n, 8).reshape(-1, 3)
    return points.copy(), np.frombuffer(raw, "<u4", 3 * m, 8 + 24 * n).reshape(-1, 3).astype(np.int32)


def write(path, points, faces):
    """The same, the other way."""
    with open(path, "wb") as file:
        file.write(np.array([len(points), len(faces)], "<u4").tobytes())
        file.write(np.asarray(points, "<f8").tobytes())
        file.write(np.asarray(faces, "<u4").tobytes())


def foreign(path):
    """Points and faces of a text file in OBJ, OFF or PLY: positions alone, polygons as fans, rounded to f32."""
    lines = open(path, encoding="latin-1").read().split("\n")
    if path.suffix == ".obj":
        points = [line.split()[1:4] for line in lines if line.startswith("v ")]
        polygons = [[int(word.split("/")[0]) - 1 for word in line.split()[1:]] for line in lines if line.startswith("f ")]
    else:
        if path.suffix == ".off":
            body = [line for line in lines[1:] if line.strip() and not line.startswith("#")]
            n, m = (int(word) for word in body.pop(0).split()[:2])
        else:
            counts = {line.split()[1]: int(line.split()[2]) for line in lines if line.startswith("element ")}
            n, m = counts["vertex"], counts["face"]
            body = lines[lines.index("end_header") + 1 :]
        points = [line.split()[:3] for line in body[:n]]
        rows = [[int(word) for word in line.split()] for line in body[n : n + m]]
        polygons = [row[1 : 1 + row[0]] for row in rows]
    faces = [[p[0], p[i], p[i + 1]] for p in polygons for i in range(1, len(p) - 1)]
    return np.array(points, np.float32).astype(np.float64), np.array(faces, np.int32)
