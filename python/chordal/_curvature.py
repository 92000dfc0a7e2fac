"""Curvature at the vertices of triangles, estimated from the angles and edges around them.

Source: M. Meyer, M. Desbrun, P. Schröder, A. H. Barr, *Discrete Differential-Geometry Operators for Triangulated
2-Manifolds*, 2003.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from chordal._corners import firsts_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def curvatures(points: NDArray[np.float64], faces: NDArray[Any]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The Gaussian and the mean curvature at each vertex; NaN at borders, at vertices without a face, and at vertices whose
    triangles have no area. Vertices at the same position count as one.
    """
    import numpy as np

    first = firsts_of(points)
    corners = first[faces]
    n = len(points)
    # For each corner: the edges to the next corner and to the one after, the angle between them, and its cotangent.
    at = points[corners]
    onward, back = np.roll(at, -1, axis=1) - at, np.roll(at, -2, axis=1) - at
    cosine = np.einsum("fck,fck->fc", onward, back)
    sine = np.linalg.norm(np.cross(onward, back), axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        angle, cotangent = np.arctan2(sine, cosine), cosine / sine
    area = _areas(onward, back, angle, cotangent, sine)
    # The edge from corner c to the next one is opposite to the corner after that, whose cotangent is its weight.
    across = np.roll(cotangent, -2, axis=1)[..., None] * onward
    bending = np.zeros((n, 3))
    np.add.at(bending, corners, -across)
    np.add.at(bending, np.roll(corners, -1, axis=1), across)
    around, normals, total = np.zeros(n), np.zeros((n, 3)), np.zeros(n)
    np.add.at(around, corners, angle)
    np.add.at(total, corners, area)
    np.add.at(normals, corners, np.cross(onward, back))
    with np.errstate(divide="ignore", invalid="ignore"):
        gaussian = (2 * np.pi - around) / total
        # The cotangent sum over 2 · area is the Laplacian, whose length is twice the mean curvature: so 4 · area in all.
        mean = np.linalg.norm(bending, axis=1) / (4 * total)
    mean = np.where(np.einsum("vk,vk->v", bending, normals) < 0, -mean, mean)
    inner = _inner(corners, n)
    gaussian[~inner], mean[~inner] = np.nan, np.nan
    return gaussian[first], mean[first]


def _areas(onward: Any, back: Any, angle: Any, cotangent: Any, sine: Any) -> Any:
    """The area of a triangle that counts for each corner (mixed Voronoi area): its Voronoi region; or, if an angle is obtuse,
    half of the triangle for that corner and a quarter for the others."""
    import numpy as np

    nearest = (
        np.einsum("fck,fck->fc", onward, onward) * np.roll(cotangent, -2, axis=1)
        + np.einsum("fck,fck->fc", back, back) * np.roll(cotangent, -1, axis=1)
    ) / 8
    is_obtuse = angle > np.pi / 2
    total = sine / 2
    split = np.where(is_obtuse, total / 2, total / 4)
    return np.where(is_obtuse.any(axis=1, keepdims=True), split, nearest)


def _inner(corners: NDArray[Any], n: int) -> Any:
    """Whether a vertex has faces, and each edge at it has a face on either side."""
    import numpy as np

    ends = np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1).reshape(-1, 2).astype(np.int64)
    low, high = ends.min(axis=1), ends.max(axis=1)
    # The lower end comes first, so both faces of an edge give it one number.
    _, edge, count = np.unique(low * n + high, return_inverse=True, return_counts=True)
    is_open = count[edge.ravel()] != 2  # two faces an edge: a surface without a border there
    inner = np.zeros(n, dtype=bool)
    inner[corners.ravel()] = True
    inner[ends[is_open].ravel()] = False
    return inner
