"""`Polylines`: straight lines with their bound."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, overload

from chordal._made import Made, counted

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Polyline:
    """One of `Polylines`: points joined by straight segments."""

    #: The points, n × 2 or n × 3. A closed polyline does not repeat its first point. For reading only.
    points: NDArray[np.float64]
    #: For each point where it lies on its curve: the index of the piece, plus the parameter in it.
    places: NDArray[np.float64]
    #: Whether the last point is joined to the first.
    closed: bool
    #: The number of the element in its file, or of the curve.
    source: int


class Polylines(Made, Sequence[Polyline]):
    """Points joined by straight segments, one polyline for each curve or subpath, with the bound of all.

    `points` of a single curve are its polyline's; of several, `lines[i].points` are those of each.

    >>> import chordal
    >>> two = chordal.bezier([[(0, 0), (0, 1), (1, 1), (1, 0)], [(0, 0), (1, 0), (2, 0), (3, 0)]])
    >>> lines = two.flatten(tol=0.1)
    >>> lines.bound.evidence, lines.bound.at_most <= 0.1
    ('proved', True)
    >>> len(lines)
    2
    >>> lines[1].points
    array([[0., 0.],
           [3., 0.]])
    """

    __slots__ = ()

    @property
    def points(self) -> NDArray[np.float64]:
        """The points of all polylines, n × 2 or n × 3. Not copied, for reading only."""
        return self._array("points")

    @property
    def places(self) -> NDArray[np.float64]:
        """For each point where it lies on its curve: the index of the piece, plus the parameter in it."""
        return self._array("places")

    @property
    def starts(self) -> NDArray[np.int64]:
        """For each polyline the index of its first point, and at the end the number of points."""
        return self._array("starts")

    def __len__(self) -> int:
        return len(self.starts) - 1

    @overload
    def __getitem__(self, index: int) -> Polyline: ...

    @overload
    def __getitem__(self, index: slice) -> list[Polyline]: ...

    def __getitem__(self, index: int | slice) -> Polyline | list[Polyline]:
        starts, closed, sources = self.starts, self._array("closed"), self._array("sources")
        points, places = self.points, self.places

        def one(i: int) -> Polyline:
            rows = slice(starts[i], starts[i + 1])
            return Polyline(points[rows], places[rows], bool(closed[i]), int(sources[i]))

        chosen = range(len(self))[index]
        return one(chosen) if isinstance(chosen, int) else [one(i) for i in chosen]

    def _size(self) -> str:
        output = self.report["certificate"]["output"]
        segments = counted(output["segments"], "segment", "segments")
        return f"{counted(output['polylines'], 'polyline', 'polylines')}, {segments}"
