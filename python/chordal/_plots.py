"""`plot_error`: what half the error costs, of any shape."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, SupportsFloat

from chordal._arguments import number
from chordal._curve import Curve
from chordal._errors import BudgetUnmet
from chordal._shape import Shape
from chordal._table import columns

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class ErrorCurve:
    """Error against triangles, or against segments of curves. `plot_error` makes it.

    >>> import chordal
    >>> found = chordal.plot_error(chordal.shapes.sphere(1), rel=[0.03, 0.01])
    >>> bool(found.counts[0] < found.counts[1]), bool(found.errors[0] > found.errors[1])
    (True, True)
    """

    #: How many of them, ascending.
    counts: NDArray[np.int64]
    #: The proved or measured error of each.
    errors: NDArray[np.float64]
    #: The slope of a straight line through them by decades: near -1 for surfaces, -2 for curves.
    slope: float
    #: The axes of matplotlib that they are drawn in; None where it is not installed.
    axes: Any

    def _repr_html_(self) -> str:
        rows = [(f"{count:,}", f"{error:.3g}") for count, error in zip(self.counts.tolist(), self.errors.tolist(), strict=True)]
        return columns(f"slope {self.slope:.2f}", ("pieces", "error"), rows)

    def __repr__(self) -> str:
        return f"<ErrorCurve: {len(self.counts)} places, slope {self.slope:.2f}>"


def plot_error(
    shape: Shape | Curve,
    *,
    rel: Sequence[SupportsFloat] = (0.03, 0.01, 0.003, 0.001),
    axes: Any | None = None,
    progress: Callable[[str, int, int], object] | None = None,
) -> ErrorCurve:
    """Meshes a shape, or flattens a curve, within each share `rel` of its diagonal, and draws error against triangles or
    segments on logarithmic scales, with a straight line through them. It costs a mesh for each.

    Without matplotlib nothing is drawn, and the numbers are the same.

    >>> import chordal
    >>> found = chordal.plot_error(chordal.shapes.bezier([(0, 0), (0, 1), (1, 1), (1, 0)]), rel=[0.01, 0.0025, 0.001])
    >>> -2.5 < found.slope < -1.6
    True
    """
    import numpy as np

    rows = []
    is_curve = isinstance(shape, Curve) or shape.kind in ("curves", "drawing")
    for share in rel:
        tolerance = number("rel", share)
        try:
            made = _made(shape, is_curve, tolerance, progress)
        except BudgetUnmet as unmet:
            made = unmet.best
        error = made.bound.at_most if made.bound.at_most is not None else made.bound.at_least
        count = made.report["certificate"]["output"]["segments"] if is_curve else len(made.faces)
        if error > 0:
            rows.append((int(count), float(error)))
    rows = sorted(set(rows))
    if not rows:
        raise ValueError("shape: nothing is lost at any of these lengths, so there is nothing to draw")
    counts, errors = np.array([row[0] for row in rows]), np.array([row[1] for row in rows])
    slope = float(np.polyfit(np.log(counts), np.log(errors), 1)[0]) if len(set(counts)) > 1 else float("nan")
    return ErrorCurve(counts, errors, slope, _drawn(counts, errors, slope, "segments" if is_curve else "triangles", axes))


def _made(shape: Any, is_curve: bool, rel: float, progress: Any) -> Any:
    return (shape.flatten if is_curve else shape.mesh)(rel=rel, progress=progress)


def _drawn(counts: Any, errors: Any, slope: float, what: str, axes: Any | None) -> Any:
    """The points and their line, in axes of matplotlib."""
    import numpy as np

    if axes is None:
        try:
            from matplotlib import pyplot
        except ImportError:
            return None
        _, axes = pyplot.subplots()
    axes.loglog(counts, errors, "o", label="error")
    if np.isfinite(slope):
        middle = np.exp(np.mean(np.log(errors)) - slope * np.mean(np.log(counts)))
        axes.loglog(counts, middle * counts.astype(float) ** slope, "--", label=f"slope {slope:.2f}")
    axes.set_xlabel(what)
    axes.set_ylabel("error, in units")
    axes.legend()
    return axes
