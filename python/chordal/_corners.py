"""Vertices of arrays: whether triangles stand alone, and which rows are one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from chordal._arguments import warn

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def firsts_of(rows: NDArray[np.float64]) -> NDArray[np.int64]:
    """For each row the first one with the same numbers; the zeros of both signs are one."""
    import numpy as np

    flat = np.ascontiguousarray(rows + 0.0)
    keys = flat.view(np.dtype((np.void, flat.dtype.itemsize * flat.shape[1]))).ravel()
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    found: NDArray[np.int64] = first[inverse.ravel()]
    return found


def warn_of_soup(points: NDArray[np.float64], faces: NDArray[Any]) -> None:
    """Says it where no two triangles share a vertex, although some of their corners are at the same place."""
    import numpy as np

    n_corners = faces.size
    if len(faces) < 2 or len(points) < n_corners or len(np.unique(faces)) != n_corners:
        return
    first = firsts_of(points)
    if len(np.unique(first[faces.ravel()])) < n_corners:
        warn(
            "faces: no two triangles share a vertex, although corners are at the same place, so that every edge is open; "
            "weld=True joins equal positions, as mesh.mend(weld=True) does later"
        )


def welded(
    points: NDArray[np.float64], faces: NDArray[Any], attributes: list[NDArray[np.float64]]
) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any] | None]:
    """Which rows stay, where equal ones in everything are one; the faces by these; and for each row that stays the first one
    at the same position, where there are several.
    """
    import numpy as np

    first = firsts_of(np.hstack([points, *attributes])) if attributes else firsts_of(points)
    kept, numbers = np.unique(first, return_inverse=True)
    tied = firsts_of(points[kept])
    is_plain = np.array_equal(tied, np.arange(len(kept)))
    renumbered = numbers.ravel()[faces].astype(np.uint32) if faces.size else faces
    return kept, renumbered, None if is_plain else tied.astype(np.uint32)
