"""`bezier` and `Curve`: curves by their control points."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final, Literal, SupportsFloat, SupportsIndex

from chordal import _chordal
from chordal._arguments import function, text
from chordal._arrays import coordinates
from chordal._budget import Length, Share, budget_arguments
from chordal._polylines import Polylines
from chordal._view import View

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


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
    return Curve(_chordal.Source.curves(copied.tobytes(), counts, text("unit", unit)), counts)


class Curve:
    """One or more curves. `bezier` makes it; it does not change."""

    __slots__ = ("_counts", "_source")

    def __init__(self, source: _chordal.Source, counts: tuple[int, int, int]) -> None:
        self._source: Final = source
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
    ) -> Polylines:
        """Straight lines within a budget, with the bound that was reached.

        `tol` is the largest distance between curve and lines, either way; `rel` the same as a share of the diagonal
        of the curves' box. `pixels` is the largest distance on the screen of `view`; a curve in the plane lies at
        z = 0. `segments` is the most segments of all curves together. All that are given hold. `spacing` "fewest"
        takes as few segments as the budget allows; "even" takes equal steps of the parameter in each piece, which is
        faster.

        Other Python threads run meanwhile, Ctrl-C ends it, and what `progress` raises comes back, as for
        `Shape.mesh`. Raises `BudgetError`, `BudgetUnmet` with the best `Polylines`, and `Refused`.

        >>> import chordal
        >>> arch = chordal.bezier([(0, 0), (0, 1), (1, 1), (1, 0)])
        >>> arch.flatten(tol=0.01).points.shape
        (10, 2)
        >>> arch.flatten(segments=2, spacing="even").points
        array([[0.  , 0.  ],
               [0.5 , 0.75],
               [1.  , 0.  ]])
        """
        budget = budget_arguments(
            tol=tol, rel=rel, pixels=pixels, view=view, segments=segments, spacing=spacing, counted="segments"
        )
        return Polylines.of(self._source.mesh(budget, "json", function("progress", progress)))

    def __repr__(self) -> str:
        n_curves, n_points, n_coordinates = self._counts
        n_pieces = (n_points - 1) // 3
        curves = f"{n_curves} curve{'' if n_curves == 1 else 's'}"
        return f"<Curve: {curves} of {n_pieces} piece{'' if n_pieces == 1 else 's'}, {n_coordinates}-D>"
