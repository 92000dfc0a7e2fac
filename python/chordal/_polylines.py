"""`Polylines`: flattened curves with their bound."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, overload

from chordal import _chordal
from chordal._arrays import as_asked
from chordal._bound import Bound, bound_of
from chordal._convert import Convertible
from chordal._hints import Guessed
from chordal._html import table
from chordal._made import Form, counted, of_outcome, remade
from chordal._report import Report
from chordal._sourced import plain_reading

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from chordal._convert import Written


@dataclass(frozen=True, eq=False)
class Polyline:
    """One of `Polylines`: points joined by straight segments.

    >>> import chordal
    >>> ring = chordal.shapes.arc(1).flatten(segments=8)[0]
    >>> ring.closed, ring.points.shape
    (True, (8, 2))
    """

    #: The points, n × 2 or n × 3. A closed polyline does not repeat its first point. Read-only.
    points: NDArray[np.float64]
    #: The place of each point on its curve: the index of the piece, plus the parameter in it.
    places: NDArray[np.float64]
    #: Whether the last point is joined to the first.
    closed: bool
    #: The number of the element in its file, or of the curve.
    source: int

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return as_asked(self.points, dtype, copy)

    def __repr__(self) -> str:
        return f"<Polyline: {counted(len(self.points), 'point', 'points')}, {'closed' if self.closed else 'open'}>"


class Polylines(Convertible, Sequence[Polyline], Guessed):
    """One polyline for each curve or subpath, with a bound for all of them.

    `points` has the points of all polylines; `lines[i].points` has those of one.

    >>> import chordal
    >>> two = chordal.shapes.bezier([[(0, 0), (0, 1), (1, 1), (1, 0)], [(0, 0), (1, 0), (2, 0), (3, 0)]])
    >>> lines = two.flatten(tol=0.1)
    >>> lines.bound.evidence, lines.bound.at_most <= 0.1
    ('proved', True)
    >>> len(lines)
    2
    >>> lines[1].points
    array([[0., 0.],
           [3., 0.]])
    """

    __slots__ = ("_arrays", "_file", "_outcome", "_report_text")

    def __init__(self, outcome: _chordal.Outcome) -> None:
        self._outcome: _chordal.Outcome | None = outcome
        self._report_text: str | None = None
        self._arrays: dict[str, Any] = {}
        self._file: bytes = b""

    @classmethod
    def _of(cls, outcome: _chordal.Outcome) -> Polylines:
        """The polylines of an outcome, if they meet their budget."""
        return of_outcome(outcome, cls)

    @property
    def _text(self) -> str:
        if self._report_text is None:
            assert self._outcome is not None
            self._report_text = self._outcome.report
        return self._report_text

    @property
    def bound(self) -> Bound:
        """The largest distance between a polyline and its curve, and how it is known."""
        return bound_of(self.report["certificate"]["bound"])

    @property
    def report(self) -> Report:
        """The report of `chordal mesh --json`, which `docs/schema` describes. You may change it."""
        return Report(json.loads(self._text))

    @property
    def points(self) -> NDArray[np.float64]:
        """The points of all polylines, n × 2 or n × 3. Not copied, read-only."""
        return self._array("points")

    @property
    def places(self) -> NDArray[np.float64]:
        """The place of each point on its curve: the index of the piece, plus the parameter in it."""
        return self._array("places")

    @property
    def starts(self) -> NDArray[np.int64]:
        """For each polyline, the index of its first point; finally the number of points."""
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

        def polyline(i: int) -> Polyline:
            rows = slice(starts[i], starts[i + 1])
            return Polyline(points[rows], places[rows], bool(closed[i]), int(sources[i]))

        # A range resolves negative indices and slices, and raises `IndexError`, as a list does.
        chosen = range(len(self))[index]
        return polyline(chosen) if isinstance(chosen, int) else [polyline(i) for i in chosen]

    def _array(self, name: str) -> NDArray[Any]:
        import numpy as np

        if name not in self._arrays:
            assert self._outcome is not None
            self._arrays[name] = np.asarray(self._outcome.array(name))
        array: NDArray[Any] = self._arrays[name]
        return array

    def _written(self, form: Form, tol: Any, rel: Any) -> Written:
        if tol is not None or rel is not None:
            raise TypeError("tol, rel: these lines were made within a budget already")
        if self._outcome is not None:
            return remade(self._outcome, Polylines, form)
        # Polylines from another process have their JSON file instead of an outcome.
        if form.format == "json" and not form.options:
            return _Kept(self._file, self._text)
        source = _chordal.Source(self._file, plain_reading("json"))
        return _chordal.convert(source, form.format, form.options, None, form.progress)

    def __reduce__(self) -> Any:
        names = ("points", "places", "starts", "closed", "sources")
        content = self._file if self._outcome is None else self._outcome.remake("json", (), None).write()
        return _again, (self._text, {name: self._array(name) for name in names}, content)

    def __repr__(self) -> str:
        return f"<Polylines: {self._size()}; {self.bound.sentence()}>"

    def _repr_html_(self) -> str:
        return table("Polylines", [("size", self._size()), ("bound", self.bound.sentence())])

    def _size(self) -> str:
        output = self.report["certificate"]["output"]
        segments = counted(output["segments"], "segment", "segments")
        return f"{counted(output['polylines'], 'polyline', 'polylines')}, {segments}"


class _Kept:
    """A file whose content is known already."""

    names_files: Final = False

    def __init__(self, content: bytes, report: str) -> None:
        self.report: Final = report
        self._content: Final = content

    def write(self) -> bytes:
        return self._content

    def write_files(self, stem: str) -> tuple[bytes, list[tuple[str, bytes]]]:
        return self._content, []


def _again(report: str, arrays: dict[str, Any], content: bytes) -> Polylines:
    """Restores pickled polylines."""
    restored = Polylines.__new__(Polylines)
    restored._outcome, restored._report_text, restored._arrays, restored._file = None, report, arrays, content
    return restored
