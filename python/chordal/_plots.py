"""`plot_error`: the number of triangles or segments that an error costs, for any shape."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, SupportsFloat

from chordal._arguments import number
from chordal._curve import Curve
from chordal._errors import BudgetUnmet
from chordal._html import columns
from chordal._shape import Shape

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class ErrorCurve:
    """The error against the number of triangles, or of segments for curves. `plot_error` returns it.

    >>> import chordal
    >>> found = chordal.plot_error(chordal.shapes.sphere(1), rel=[0.03, 0.01])
    >>> bool(found.counts[0] < found.counts[1]), bool(found.errors[0] > found.errors[1])
    (True, True)
    """

    #: The numbers of triangles or segments, ascending.
    counts: NDArray[np.int64]
    #: The proved or measured error for each number.
    errors: NDArray[np.float64]
    #: The slope of a straight line through them on logarithmic scales: near -1 for surfaces, -2 for curves.
    slope: float
    #: The axes of matplotlib with the plot; None if matplotlib is not installed.
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
    """Meshes a shape, or flattens a curve, within each share `rel` of its diagonal, and plots the error against the number of
    triangles or segments on logarithmic scales, with a straight line through them. The cost is one mesh for each share.

    Without matplotlib nothing is plotted, and the numbers are the same.

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
            result = _approximated(shape, is_curve, tolerance, progress)
        except BudgetUnmet as unmet:
            result = unmet.best
        error = result.bound.at_most if result.bound.at_most is not None else result.bound.at_least
        count = result.report["certificate"]["output"]["segments"] if is_curve else len(result.faces)
        # Both axes are logarithmic.
        if error > 0:
            rows.append((int(count), float(error)))
    rows = sorted(set(rows))
    if not rows:
        raise ValueError("shape: nothing is lost at any of these lengths, so there is nothing to draw")
    counts, errors = np.array([row[0] for row in rows]), np.array([row[1] for row in rows])
    slope = float(np.polyfit(np.log(counts), np.log(errors), 1)[0]) if len(set(counts)) > 1 else float("nan")
    return ErrorCurve(counts, errors, slope, _drawn(counts, errors, slope, "segments" if is_curve else "triangles", axes))


def _approximated(shape: Any, is_curve: bool, rel: float, progress: Any) -> Any:
    return (shape.flatten if is_curve else shape.mesh)(rel=rel, progress=progress)


def _drawn(counts: Any, errors: Any, slope: float, counted: str, axes: Any | None) -> Any:
    """The axes of matplotlib with the points and their line; None without matplotlib."""
    import numpy as np

    if axes is None:
        try:
            from matplotlib import pyplot
        except ImportError:
            return None
        _, axes = pyplot.subplots()
    axes.loglog(counts, errors, "o", label="error")
    if np.isfinite(slope):
        # The fitted line passes through the mean of the logarithms.
        middle = np.exp(np.mean(np.log(errors)) - slope * np.mean(np.log(counts)))
        axes.loglog(counts, middle * counts.astype(float) ** slope, "--", label=f"slope {slope:.2f}")
    axes.set_xlabel(counted)
    axes.set_ylabel("error, in units")
    axes.legend()
    return axes
