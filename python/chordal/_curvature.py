"""Curvature at the vertices of triangles: what the angles and edges around a vertex say of the surface that they stand for.

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
    """The Gaussian and the mean curvature at each vertex; NaN at borders, at vertices without a face, and where triangles
    around one have no area. Vertices at one position count as one.
    """
    import numpy as np

    first = firsts_of(points)
    corners = first[faces]
    n = len(points)
    # Of each corner: the edges to the next and to the one after it, their angle, and its cotangent.
    at = points[corners]
    onward, back = np.roll(at, -1, axis=1) - at, np.roll(at, -2, axis=1) - at
    cosine = np.einsum("fck,fck->fc", onward, back)
    sine = np.linalg.norm(np.cross(onward, back), axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        angle, cotangent = np.arctan2(sine, cosine), cosine / sine
    area = _areas(onward, back, angle, cotangent, sine)
    # The edge from corner c to the next one lies opposite to the corner after that.
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
        # Half of the Laplacian is twice the mean curvature, along the normal; here half of each half.
        mean = np.linalg.norm(bending, axis=1) / (4 * total)
    mean = np.where(np.einsum("vk,vk->v", bending, normals) < 0, -mean, mean)
    inner = _inner(corners, n)
    gaussian[~inner], mean[~inner] = np.nan, np.nan
    return gaussian[first], mean[first]


def _areas(onward: Any, back: Any, angle: Any, cotangent: Any, sine: Any) -> Any:
    """The part of a triangle that belongs to each corner: what is nearest to it, or where an angle is obtuse half of the
    triangle at that one and a quarter at the others."""
    import numpy as np

    nearest = (
        np.einsum("fck,fck->fc", onward, onward) * np.roll(cotangent, -2, axis=1)
        + np.einsum("fck,fck->fc", back, back) * np.roll(cotangent, -1, axis=1)
    ) / 8
    is_obtuse = angle > np.pi / 2
    whole = sine / 2
    split = np.where(is_obtuse, whole / 2, whole / 4)
    return np.where(is_obtuse.any(axis=1, keepdims=True), split, nearest)


def _inner(corners: NDArray[Any], n: int) -> Any:
    """Whether each edge at a vertex has a face on either side."""
    import numpy as np

    ends = np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1).reshape(-1, 2).astype(np.int64)
    low, high = ends.min(axis=1), ends.max(axis=1)
    _, edge, count = np.unique(low * n + high, return_inverse=True, return_counts=True)
    is_open = count[edge.ravel()] != 2  # two faces an edge: a surface without a border there
    inner = np.zeros(n, dtype=bool)
    inner[corners.ravel()] = True
    inner[ends[is_open].ravel()] = False
    return inner
