"""`surface`: NURBS surfaces from arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, SupportsIndex

from chordal import _chordal
from chordal._arguments import text, whole
from chordal._arrays import coordinates
from chordal._shape import Shape

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def surface(
    control: ArrayLike,
    *,
    weights: ArrayLike | None = None,
    knots: Sequence[ArrayLike] | None = None,
    degrees: Sequence[SupportsIndex] = (3, 3),
    unit: str | None = None,
) -> Shape:
    """A rational B-spline surface (NURBS) with these control points, rows × columns × 3: `u` runs along a row, `v` from
    row to row.

    `weights` are rows × columns, by default 1. `degrees` are the degrees along `u` and `v`, from 1 to 30. `knots` are two
    lists, along `u` and along `v`, each with as many knots as control points plus the degree plus 1; by default they are
    uniform, and the surface ends at its outer control points.

    Raises `ValueError` if the numbers do not define such a surface.

    >>> import chordal
    >>> flat = chordal.shapes.surface([[(0, 0, 0), (1, 0, 0)], [(0, 1, 0), (1, 1, 1)]], degrees=(1, 1))
    >>> flat
    <Shape: surfaces, from json>
    >>> flat.mesh(tol=0.01).bound.evidence
    'proved'
    """
    import numpy as np

    points = coordinates("control", control)
    if points.ndim != 3 or points.shape[2] != 3:
        raise ValueError(f"control: rows of points in space, as in (rows, columns, 3), not {points.shape}")
    n_rows, n_columns, _ = points.shape
    weight_rows = np.ones((n_rows, n_columns)) if weights is None else coordinates("weights", weights)
    if weight_rows.shape != (n_rows, n_columns):
        raise ValueError(f"weights: one for each control point, {(n_rows, n_columns)}, not {weight_rows.shape}")
    if len(degrees) != 2:
        raise ValueError(f"degrees: two of them, along u and along v, not {len(degrees)}")
    along_u, along_v = (whole("degrees", degree) for degree in degrees)
    knot_lists = None
    if knots is not None:
        if len(knots) != 2:
            raise ValueError(f"knots: two lists of them, along u and along v, not {len(knots)}")
        first, second = (coordinates("knots", row).ravel().tolist() for row in knots)
        knot_lists = (first, second)
    arguments: _chordal.SurfaceArguments = {
        "shape": (n_columns, n_rows),
        "degrees": (along_u, along_v),
        "knots": knot_lists,
        "unit": text("unit", unit),
    }
    named = {"weights": weight_rows, "knots": knot_lists, "degrees": (along_u, along_v), "unit": unit}
    return Shape(_chordal.surface(points.tobytes(), weight_rows.tobytes(), arguments), (surface, (points,), named))
