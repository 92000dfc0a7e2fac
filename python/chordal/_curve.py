"""`bezier`, `Curve` and `Polyline`: curves by their control points, and the straight lines that come of them."""

from __future__ import annotations

import html
import json
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final, Literal, SupportsFloat, SupportsIndex

from chordal import _chordal
from chordal._arrays import coordinates
from chordal._bound import Bound, bound_of
from chordal._budget import Length, Share, wanted
from chordal._errors import BudgetUnmet
from chordal._arguments import function, text
from chordal._view import View

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


def bezier(control: ArrayLike, *, unit: str | None = None) -> Curve:
    """Cubic Bézier curves by their control points, in the plane or in space.

    `control` is one curve, 4 × 2 or 4 × 3; or a chain of n pieces, neighbours sharing a point, (3n + 1) × 2 or × 3;
    or n separate curves, n × 4 × 2 or × 3. Any real numbers will do; they are copied. `unit` is the unit of the
    coordinates, for budgets with a unit.

    >>> import chordal
    >>> chordal.bezier([(0, 0), (0, 1), (1, 1), (1, 0)])
    <Curve: 1 curve of 1 piece, 2-D>
    """
    copied = coordinates("control", control)
    shape = copied.shape
    if copied.ndim not in (2, 3) or shape[-1] not in (2, 3):
        hint = "; is it the wrong way round?" if copied.ndim == 2 and shape[0] in (2, 3) else ""
        raise ValueError(f"control: points of 2 or 3 coordinates, as in (4, 2) or (n, 4, 3), not {shape}{hint}")
    if copied.size == 0:
        raise ValueError(f"control: there are no points: {shape}")
    if copied.ndim == 3 and shape[1] != 4:
        raise ValueError(f"control: 4 points for each of n curves, as in (n, 4, 2), not {shape}")
    if copied.ndim == 2 and (shape[0] < 4 or shape[0] % 3 != 1):
        raise ValueError(f"control: 4 points, or 3n + 1 for a chain of n pieces, not {shape[0]}")
    counts = (shape[0], 4, shape[2]) if copied.ndim == 3 else (1, shape[0], shape[1])
    return Curve(_chordal.Paths(copied.tobytes(), counts, text("unit", unit)), counts)


class Curve:
    """One or more curves. `bezier` makes it; it does not change."""

    __slots__ = ("_counts", "_paths")

    def __init__(self, paths: _chordal.Paths, counts: tuple[int, int, int]) -> None:
        self._paths: Final = paths
        self._counts: Final = counts

    def flatten(
        self,
        *,
        tol: Length | None = None,
        rel: Share | None = None,
        pixels: SupportsFloat | None = None,
        view: str | View | None = None,
        segments: SupportsIndex | None = None,
        spacing: Literal["fewest", "even"] = "fewest",
        progress: Callable[[str, int, int], object] | None = None,
    ) -> Polyline:
        """Straight lines within a budget, with the bound that was reached.

        `tol` is the largest distance between curve and lines, either way; `rel` the same as a share of the diagonal
        of the curves' box. `pixels` is the largest distance on the screen of `view`; a curve in the plane lies at
        z = 0. `segments` is the most segments of all curves together. All that are given hold. `spacing` "fewest"
        takes as few segments as the budget allows; "even" takes equal steps of the parameter in each piece, which is
        faster.

        Other Python threads run meanwhile, Ctrl-C ends it, and what `progress` raises comes back, as for
        `Shape.mesh`. Raises `BudgetError`, `BudgetUnmet` with the best `Polyline`, and `Refused`.

        >>> import chordal
        >>> arch = chordal.bezier([(0, 0), (0, 1), (1, 1), (1, 0)])
        >>> arch.flatten(tol=0.01).points.shape
        (10, 2)
        >>> arch.flatten(segments=2, spacing="even").points
        array([[0.  , 0.  ],
               [0.5 , 0.75],
               [1.  , 0.  ]])
        """
        budget = wanted(tol=tol, rel=rel, pixels=pixels, view=view, count=("segments", segments))
        lines = self._paths.flatten(budget, text("spacing", spacing) or "", function("progress", progress))
        polyline = Polyline(lines)
        if lines.unmet is not None:
            raise BudgetUnmet(lines.unmet, polyline)
        return polyline

    def __repr__(self) -> str:
        n_curves, n_points, n_coordinates = self._counts
        n_pieces = (n_points - 1) // 3
        curves = f"{n_curves} curve{'' if n_curves == 1 else 's'}"
        return f"<Curve: {curves} of {n_pieces} piece{'' if n_pieces == 1 else 's'}, {n_coordinates}-D>"


class Polyline:
    """Points joined by straight segments, with their bound: one polyline for each curve. It does not change.

    >>> import chordal
    >>> two = chordal.bezier([[(0, 0), (0, 1), (1, 1), (1, 0)], [(0, 0), (1, 0), (2, 0), (3, 0)]])
    >>> lines = two.flatten(tol=0.1)
    >>> lines.bound.evidence, lines.bound.at_most <= 0.1
    ('proved', True)
    >>> len(lines.strands)
    2
    >>> lines.strands[1]
    array([[0., 0.],
           [3., 0.]])
    """

    __slots__ = ("_lines",)

    def __init__(self, lines: _chordal.Lines) -> None:
        self._lines: Final = lines

    @property
    def points(self) -> NDArray[np.float64]:
        """The points of all polylines, n × 2 or n × 3. Not copied, for reading only."""
        import numpy as np

        return np.asarray(self._lines.points)

    @property
    def starts(self) -> NDArray[np.int64]:
        """For each polyline the index of its first point, and at the end the number of points."""
        import numpy as np

        return np.asarray(self._lines.starts)

    @property
    def strands(self) -> list[NDArray[np.float64]]:
        """The points of each polyline by itself, as views of `points`."""
        points, starts = self.points, self.starts
        return [points[first:end] for first, end in zip(starts[:-1], starts[1:], strict=True)]

    @property
    def places(self) -> NDArray[np.float64]:
        """For each point where it lies on its curve: the index of the piece, plus the parameter in it."""
        import numpy as np

        return np.asarray(self._lines.places)

    @property
    def bound(self) -> Bound:
        """How far the lines are from the curves, the worst of all, and how that is known."""
        return bound_of(self.report["bound"])

    @property
    def report(self) -> dict[str, Any]:
        """The budget, the bound and the counts, in the words of the report of `chordal mesh`. It is yours to change."""
        report: dict[str, Any] = json.loads(self._lines.report)
        return report

    def __repr__(self) -> str:
        return f"<Polyline: {self._size()}; {self.bound.sentence()}>"

    def _repr_html_(self) -> str:
        rows = (("polyline", self._size()), ("bound", self.bound.sentence()))
        cells = "".join(f"<tr><th>{name}</th><td>{html.escape(text)}</td></tr>" for name, text in rows)
        return f"<table>{cells}</table>"

    def _size(self) -> str:
        output = self.report["output"]
        lines, segments = output["polylines"], output["segments"]
        strands = "" if lines == 1 else f"{lines:,} polylines, "
        return f"{strands}{segments:,} segment{'' if segments == 1 else 's'}"
