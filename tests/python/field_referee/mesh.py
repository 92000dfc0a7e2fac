"""A mesh from a file: its topology, distances to it, and pairs of triangles that cross."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from .ranges import Array

Indices = npt.NDArray[np.int64]
#: Pairs of a point and a triangle that are looked at in one go.
BATCH = 1 << 18
#: Cells along the diagonal at most: triangles are put into all cells that they meet.
MOST_CELLS = 160
EPS = float(np.finfo(np.float64).eps)


@dataclass(frozen=True)
class Mesh:
    """Triangles that share corners by index."""

    points: Array
    faces: Indices

    def corners(self) -> tuple[Array, Array, Array]:
        """The three corners of each face."""
        return self.points[self.faces[:, 0]], self.points[self.faces[:, 1]], self.points[self.faces[:, 2]]

    def normals(self) -> Array:
        """Vectors across the faces, twice their area long."""
        a, b, c = self.corners()
        return np.asarray(np.cross(b - a, c - a), np.float64)

    def size(self) -> float:
        """The largest coordinate in size."""
        return float(np.abs(self.points).max(initial=0.0))


def read_ply(path: Path) -> Mesh:
    """The vertices and triangles of a binary PLY; other properties are passed over."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    names = {"float": "<f4", "double": "<f8", "uchar": "u1", "int": "<i4", "uint": "<u4", "ushort": "<u2"}
    elements: list[tuple[str, int, list[str]]] = []
    order: list[tuple[str, str]] = []
    for words in (line.split() for line in data[:end].decode().splitlines()):
        if words[0] == "format":
            assert words[1] == "binary_little_endian", words
        elif words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property":
            elements[-1][2].append(" ".join(words[1:]))
            if elements[-1][0] == "vertex":
                order.append((words[2], names[words[1]]))
    assert [e[0] for e in elements] == ["vertex", "face"], elements
    rows = np.frombuffer(data, np.dtype(order), elements[0][1], end)
    points = np.stack([rows[k].astype(np.float64) for k in "xyz"], axis=1)
    (kind,) = elements[1][2]
    _, count, index, _ = kind.split()
    face = np.dtype([("n", names[count]), ("at", names[index], 3)])
    rows = np.frombuffer(data, face, elements[1][1], end + elements[0][1] * np.dtype(order).itemsize)
    assert (rows["n"] == 3).all(), "a polygon that is no triangle"
    return Mesh(points, rows["at"].astype(np.int64))


def dot(u: npt.NDArray[np.floating[Any]], v: npt.NDArray[np.floating[Any]]) -> Array:
    """The product of each two vectors."""
    return np.asarray(np.einsum("ij,ij->i", u, v), np.float64)


def point_triangle(p: Array, a: Array, b: Array, c: Array) -> Array:
    """The distance of each point to its triangle."""

    def to_segment(start: Array, end: Array) -> Array:
        along, away = end - start, p - start
        total = dot(along, along)
        t = np.clip(dot(away, along) / np.where(total > 0, total, 1.0), 0.0, 1.0)
        off = away - t[:, None] * along
        return np.asarray(np.sqrt(dot(off, off)), np.float64)

    least = np.minimum(np.minimum(to_segment(a, b), to_segment(b, c)), to_segment(c, a))
    n: Array = np.asarray(np.cross(b - a, c - a), np.float64)
    area = dot(n, n)
    above = (area > 0) & (dot(np.cross(n, b - a), p - a) > 0)
    above &= (dot(np.cross(n, c - b), p - b) > 0) & (dot(np.cross(n, a - c), p - c) > 0)
    height = np.abs(dot(p - a, n)) / np.sqrt(np.where(area > 0, area, 1.0))
    return np.asarray(np.where(above, np.minimum(height, least), least), np.float64)


class Grid:
    """Triangles in the cells of a grid that they come within a reach of."""

    def __init__(self, mesh: Mesh, reach: float) -> None:
        self.mesh, self.reach = mesh, reach
        a, b, c = mesh.corners()
        low, high = np.minimum(np.minimum(a, b), c) - reach, np.maximum(np.maximum(a, b), c) + reach
        self.origin = low.min(axis=0)
        extent = float((high.max(axis=0) - self.origin).max())
        # About as many cells across as triangles lie across.
        across = min(MOST_CELLS, max(4.0, np.sqrt(len(mesh.faces))))
        self.side = max(4 * reach, extent / across)
        first = np.floor((low - self.origin) / self.side).astype(np.int64)
        last = np.floor((high - self.origin) / self.side).astype(np.int64)
        self.shape = last.max(axis=0) + 1
        self.keys, self.rows = self.fill(first, last)

    def fill(self, first: Indices, last: Indices) -> tuple[Indices, Indices]:
        """Each cell of each triangle that its plane comes near enough to, in the order of the cells."""
        sizes = last - first + 1
        counts = sizes.prod(axis=1)
        rows = np.repeat(np.arange(len(counts)), counts)
        k = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
        cell = first[rows] + np.stack(
            [k % sizes[rows, 0], k // sizes[rows, 0] % sizes[rows, 1], k // (sizes[rows, 0] * sizes[rows, 1])], axis=1
        )
        n = self.mesh.normals()
        length = np.sqrt((n * n).sum(axis=1))
        middle = self.origin + (cell + 0.5) * self.side
        a = self.mesh.points[self.mesh.faces[:, 0]]
        off = np.abs(((middle - a[rows]) * n[rows]).sum(axis=1))
        # Half the diagonal of a cell is less than 0.87 of its side.
        near = off <= (0.87 * self.side * (1 + 1e-6) + self.reach) * length[rows] * (1 + 1e-6)
        near |= ~(length[rows] > 1e-12 * self.side * self.side)
        keys = self.key(cell)[near]
        order = np.argsort(keys, kind="stable")
        return keys[order], rows[near][order]

    def key(self, cell: Indices) -> Indices:
        """One number for a cell."""
        return np.asarray((cell[:, 2] * self.shape[1] + cell[:, 1]) * self.shape[0] + cell[:, 0], np.int64)

    def distances(self, points: Array) -> Array:
        """The distance of each point to the mesh where it is within the reach, else something larger."""
        cell = np.floor((points - self.origin) / self.side).astype(np.int64)
        inside = ((cell >= 0) & (cell < self.shape)).all(axis=1)
        keys = np.where(inside, self.key(cell), -1)
        start, end = np.searchsorted(self.keys, keys, "left"), np.searchsorted(self.keys, keys, "right")
        counts = end - start
        least = np.full(len(points), np.inf)
        a, b, c = self.mesh.corners()
        done = 0
        while done < len(points):
            upto = done + max(1, int(np.searchsorted(np.cumsum(counts[done:]), BATCH)))
            n = counts[done:upto]
            which = np.repeat(np.arange(done, min(upto, len(points))), n)
            k = np.arange(len(which)) - np.repeat(np.cumsum(n) - n, n)
            row = self.rows[start[which] + k]
            np.minimum.at(least, which, point_triangle(points[which], a[row], b[row], c[row]))
            done = upto
        return least

    def pairs(self) -> Indices:
        """Each two triangles that lie in one cell, once."""
        _, start, counts = np.unique(self.keys, return_index=True, return_counts=True)
        found = []
        for n in np.unique(counts):
            if n < 2:
                continue
            i, j = np.triu_indices(n, 1)
            block = start[counts == n][:, None]
            for part in np.array_split(block, max(1, len(block) * len(i) // (1 << 22))):
                u, v = self.rows[part + i].ravel(), self.rows[part + j].ravel()
                found.append(np.unique(np.minimum(u, v) * len(self.mesh.faces) + np.maximum(u, v)))
        if not found:
            return np.zeros((0, 2), np.int64)
        keys = np.unique(np.concatenate(found))
        return np.stack([keys // len(self.mesh.faces), keys % len(self.mesh.faces)], axis=1)


def true_distances(mesh: Mesh, points: Array) -> Array:
    """The distances of a few points to all triangles."""
    a, b, c = mesh.corners()
    return np.array([point_triangle(np.broadcast_to(p, a.shape), a, b, c).min(initial=np.inf) for p in points])


def topology(mesh: Mesh) -> list[str]:
    """What keeps a mesh from being closed, oriented and manifold, by indices alone."""
    f, n = mesh.faces, len(mesh.points)
    wrong = []
    if ((f[:, 0] == f[:, 1]) | (f[:, 1] == f[:, 2]) | (f[:, 2] == f[:, 0])).any():
        return ["a face has a corner twice"]
    start, end = f.ravel(), np.roll(f, -1, axis=1).ravel()
    key, back = start * n + end, end * n + start
    if len(np.unique(key)) < len(key):
        wrong.append(f"{len(key) - len(np.unique(key))} half-edges are there twice")
    open_edges = int((~np.isin(back, key)).sum())
    if open_edges:
        wrong.append(f"{open_edges} half-edges have no twin")
    if wrong:
        return wrong
    # Around a vertex: from the corner at which a half-edge starts to that of the edge before it, turned around.
    twin = twins(mesh)
    before = np.arange(len(key)) // 3 * 3 + (np.arange(len(key)) + 2) % 3
    following = twin[before]
    label, jump = np.arange(len(key)), following
    # Twice as far each time: after 32 rounds all corners of one fan have one label.
    for _ in range(32):
        label = np.minimum(label, label[jump])
        jump = jump[jump]
    fans = np.unique(np.stack([start, label], axis=1), axis=0)
    pinched = len(fans) - len(np.unique(start))
    if pinched:
        wrong.append(f"{pinched} vertices join fans that share no edge")
    return wrong


def twins(mesh: Mesh) -> Indices:
    """The half-edge that runs against each, of a mesh that is closed."""
    n = len(mesh.points)
    start, end = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    key = start * n + end
    order = np.argsort(key)
    return np.asarray(order[np.searchsorted(key[order], end * n + start)], np.int64)


def folded_edges(mesh: Mesh) -> int:
    """Edges of a closed mesh whose two faces lie on each other, to rounding; slivers have no say."""
    twin, half = twins(mesh), np.arange(mesh.faces.size)
    u, v = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    opposite = np.roll(mesh.faces, -2, axis=1).ravel()
    n = mesh.normals()[half // 3]
    area = np.sqrt(dot(n, n))
    start, along = mesh.points[u], mesh.points[v] - mesh.points[u]
    mine, other = mesh.points[opposite] - start, mesh.points[opposite[twin]] - start
    longest = np.sqrt(np.maximum(np.maximum(dot(along, along), dot(mine, mine)), dot(other, other)))
    with np.errstate(all="ignore"):
        margin = 64 * EPS * (mesh.size() + longest * longest * longest / area)
        inward = np.cross(n, along) / (area * np.sqrt(dot(along, along)))[:, None]
        flat = np.abs(dot(other, n)) / area <= margin
        # A sliver is one whose rounding would hide an angle of a thousandth.
        same = (dot(other, inward) > 1000 * margin) & (margin < 1e-3 * dot(mine, inward))
    return int((flat & same).sum()) // 2


def crossing_pairs(mesh: Mesh) -> Indices:
    """Pairs of triangles of which an edge of one goes through the inside of the other, by more than rounding."""
    pairs = Grid(mesh, 0.0).pairs()
    box = np.stack([np.minimum.reduce(mesh.corners()), np.maximum.reduce(mesh.corners())])
    meet = (box[0][pairs[:, 0]] <= box[1][pairs[:, 1]]) & (box[0][pairs[:, 1]] <= box[1][pairs[:, 0]])
    pairs = pairs[meet.all(axis=1)]
    crossing = np.zeros(len(pairs), bool)
    for one, other in ((0, 1), (1, 0)):
        for k in range(3):
            start = mesh.faces[pairs[:, one], k]
            end = mesh.faces[pairs[:, one], (k + 1) % 3]
            crossing |= pierces(mesh, np.stack([start, end], axis=1), pairs[:, other])
    return np.asarray(pairs[crossing], np.int64)


def pierces(mesh: Mesh, edges: Indices, faces: Indices) -> npt.NDArray[np.bool_]:
    """Whether an edge crosses the inside of a face; never where they share a corner, which lies in its plane."""
    p, q = mesh.points[edges[:, 0]], mesh.points[edges[:, 1]]
    a, b, c = (mesh.points[mesh.faces[faces, k]] for k in range(3))
    n = np.cross(b - a, c - a)
    area = np.sqrt(dot(n, n))
    longest = np.sqrt(np.maximum(np.maximum(dot(b - a, b - a), dot(c - b, c - b)), dot(a - c, a - c)))
    longest = np.maximum(longest, np.sqrt(dot(q - p, q - p)))
    with np.errstate(all="ignore"):
        unit = n / area[:, None]
        # The rounding of a height: that of differences, made larger where the triangle is thin.
        margin = 64 * EPS * (mesh.size() + longest * longest * longest / area)
        d, e = dot(p - a, unit), dot(q - a, unit)
        apart = ((d > margin) & (e < -margin)) | ((d < -margin) & (e > margin))
        x = p + (d / (d - e))[:, None] * (q - p)
        # How far inside of each side; the place along the edge is less sure where it runs flat.
        unsure = margin * (1 + np.sqrt(dot(q - p, q - p)) / np.abs(d - e))
        for u, v in ((a, b), (b, c), (c, a)):
            side = v - u
            apart &= dot(np.cross(unit, side), x - u) > unsure * np.sqrt(dot(side, side))
    shared = (edges[:, :, None] == mesh.faces[faces][:, None, :]).any(axis=(1, 2))
    return np.asarray(apart & ~shared, np.bool_)
