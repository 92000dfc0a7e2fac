"""The distance of a mesh to another shape at samples of all its triangles, for colours in a notebook."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from chordal._mesh import Mesh

#: A mesh with fewer triangles is subdivided to about this number. Chosen: 3 MB in a notebook, and about a second.
_MOST_DRAWN: Final = 60_000
#: The most parts of an edge. Chosen: on a triangle over an arc, samples then miss 1/64 of the largest distance, since the error
#: goes with the square of the parts.
_MOST_PARTS: Final = 8


@dataclass(frozen=True)
class SampledDeviation:
    """Triangles with a distance at each vertex, for drawing only. They subdivide the triangles of a mesh; or they are these
    themselves, unmerged, and each has the largest distance of its samples at all corners.
    """

    vertices: NDArray[Any]
    faces: NDArray[Any]
    normals: NDArray[Any] | None
    values: NDArray[Any]


def sampled_deviation(mesh: Mesh, distances: Any) -> SampledDeviation:
    """Samples a distance, given as a function of points, on each triangle: at the corners of equal parts, if there are few
    triangles, else at the corners, the midpoints of edges and the centre.
    """
    import numpy as np

    n_parts = int(np.clip(np.sqrt(_MOST_DRAWN / max(len(mesh.faces), 1)), 1, _MOST_PARTS))
    # Too many triangles to divide them: each gets one value, the largest of its corners, its middle and those of its edges.
    if n_parts == 1:
        barycentric = np.vstack([_lattice(2)[0], np.full((1, 3), 1 / 3)])
        largest = np.abs(distances(_interpolated(mesh.vertices[mesh.faces], barycentric))).max(axis=1)
        return _assembled(mesh, np.eye(3), np.array([[0, 1, 2]]), np.repeat(largest[:, None], 3, axis=1))
    barycentric, rows = _lattice(n_parts)
    return _assembled(mesh, barycentric, rows, np.abs(distances(_interpolated(mesh.vertices[mesh.faces], barycentric))))


def _interpolated(corners: NDArray[Any], barycentric: NDArray[Any]) -> NDArray[Any]:
    """The values of the corners of each triangle, interpolated at barycentric coordinates: triangles × coordinates × 3."""
    import numpy as np

    values: NDArray[Any] = np.einsum("sc,fck->fsk", barycentric, corners)
    return values


def _assembled(mesh: Mesh, barycentric: NDArray[Any], rows: NDArray[Any], values: NDArray[Any]) -> SampledDeviation:
    import numpy as np

    normals = mesh._vertex_rows("normal")
    # No two triangles share a sample, as values may differ on either side of an edge.
    firsts = len(barycentric) * np.arange(len(mesh.faces))
    return SampledDeviation(
        vertices=_interpolated(mesh.vertices[mesh.faces], barycentric).reshape(-1, 3),
        faces=(firsts[:, None, None] + rows).reshape(-1, 3),
        normals=None if normals is None else _interpolated(normals[mesh.faces], barycentric).reshape(-1, 3),
        values=values.reshape(-1),
    )


def _lattice(n_parts: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """The subdivision of a triangle into equal parts: barycentric coordinates of their corners, and the triangles, wound as it."""
    import numpy as np

    places = [(i, j) for i in range(n_parts + 1) for j in range(n_parts + 1 - i)]
    number = {place: k for k, place in enumerate(places)}
    rows = []
    for i, j in places:
        #        (i, j+1) --- (i+1, j+1)
        #           |     \     |          an upright triangle at each place, and one upside down
        #         (i, j) --- (i+1, j)      beside it, unless the place is at the far side
        if i + j < n_parts:
            rows.append([number[i, j], number[i + 1, j], number[i, j + 1]])
        if i + j < n_parts - 1:
            rows.append([number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]])
    return np.array([(n_parts - i - j, i, j) for i, j in places]) / n_parts, np.array(rows)
