"""How far a mesh is from another shape, at samples of all its triangles: what a notebook colours."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from chordal._mesh import Mesh

#: So many triangles are drawn instead of those of the mesh, if it has fewer. Chosen: 3 MB in a notebook, and a second or so.
_MOST_DRAWN: Final = 60_000
#: The parts of an edge at most. Chosen: on a triangle over an arc the largest distance between samples is then 1/64 off, since it
#: goes with the square of the parts.
_MOST_PARTS: Final = 8


@dataclass(frozen=True)
class SampledDeviation:
    """Triangles with the distance at each of their vertices, for drawing alone. They are parts of those of a mesh, or these
    themselves, each with corners of its own and one distance, the largest that was found on it.
    """

    vertices: NDArray[Any]
    faces: NDArray[Any]
    normals: NDArray[Any] | None
    values: NDArray[Any]


def sampled_deviation(mesh: Mesh, distances: Any) -> SampledDeviation:
    """Samples the distance, a function of points: at the corners of equal parts of each triangle, where there are few of them."""
    import numpy as np

    n_parts = int(np.clip(np.sqrt(_MOST_DRAWN / max(len(mesh.faces), 1)), 1, _MOST_PARTS))
    if n_parts == 1:
        # The corners, the middles of edges, and the middle.
        shares = np.vstack([_lattice(2)[0], np.full((1, 3), 1 / 3)])
        worst = np.abs(distances(_placed(mesh.vertices[mesh.faces], shares))).max(axis=1)
        return _assembled(mesh, np.eye(3), np.array([[0, 1, 2]]), np.repeat(worst[:, None], 3, axis=1))
    shares, rows = _lattice(n_parts)
    return _assembled(mesh, shares, rows, np.abs(distances(_placed(mesh.vertices[mesh.faces], shares))))


def _placed(corners: NDArray[Any], shares: NDArray[Any]) -> NDArray[Any]:
    """What has these shares of the corners of each triangle: triangles × shares × 3."""
    import numpy as np

    found: NDArray[Any] = np.einsum("sc,fck->fsk", shares, corners)
    return found


def _assembled(mesh: Mesh, shares: NDArray[Any], rows: NDArray[Any], values: NDArray[Any]) -> SampledDeviation:
    import numpy as np

    normals = mesh._vertex_rows("normal")
    firsts = len(shares) * np.arange(len(mesh.faces))
    return SampledDeviation(
        vertices=_placed(mesh.vertices[mesh.faces], shares).reshape(-1, 3),
        faces=(firsts[:, None, None] + rows).reshape(-1, 3),
        normals=None if normals is None else _placed(normals[mesh.faces], shares).reshape(-1, 3),
        values=values.reshape(-1),
    )


def _lattice(n_parts: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """The corners of a triangle's equal parts, as shares of its own corners, and the parts, counter-clockwise as it is."""
    import numpy as np

    places = [(i, j) for i in range(n_parts + 1) for j in range(n_parts + 1 - i)]
    number = {place: k for k, place in enumerate(places)}
    rows = []
    for i, j in places:
        if i + j < n_parts:
            rows.append([number[i, j], number[i + 1, j], number[i, j + 1]])
        if i + j < n_parts - 1:
            rows.append([number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]])
    return np.array([(n_parts - i - j, i, j) for i, j in places]) / n_parts, np.array(rows)
