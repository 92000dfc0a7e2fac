"""Equal vertices in arrays: detection of triangle soups, and welding."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from chordal._arguments import warn

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def firsts_of(rows: NDArray[np.float64]) -> NDArray[np.int64]:
    """For each row, the index of the first row with the same numbers; 0.0 and -0.0 are equal."""
    import numpy as np

    # Rows are compared as bytes, in which 0.0 and -0.0 differ; adding 0.0 leaves only 0.0.
    flat = np.ascontiguousarray(rows + 0.0)
    keys = flat.view(np.dtype((np.void, flat.dtype.itemsize * flat.shape[1]))).ravel()
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    first_of_row: NDArray[np.int64] = first[inverse.ravel()]
    return first_of_row


def warn_of_soup(points: NDArray[np.float64], faces: NDArray[Any]) -> None:
    """Warns of a triangle soup: no two triangles share a vertex, although some of their corners have the same position."""
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
    """Merges vertices that are equal in all attributes. Returns the rows that are kept; the faces with new indices; and for each
    kept row the first one at the same position, or None if all positions differ.
    """
    import numpy as np

    first = firsts_of(np.hstack([points, *attributes])) if attributes else firsts_of(points)
    kept, numbers = np.unique(first, return_inverse=True)
    position_ids = firsts_of(points[kept])
    all_differ = np.array_equal(position_ids, np.arange(len(kept)))
    renumbered = numbers.ravel()[faces].astype(np.uint32) if faces.size else faces
    return kept, renumbered, None if all_differ else position_ids.astype(np.uint32)
