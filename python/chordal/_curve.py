"""Curves: Béziers, splines, arcs and NURBS, and their operations."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Final, Literal, SupportsFloat, SupportsIndex

from chordal import _chordal
from chordal._arguments import function, number, text
from chordal._arrays import coordinates
from chordal._bound import Bound, bound_of
from chordal._budget import Length, Share, budget_options
from chordal._hints import Guessed, refuse_own
from chordal._polylines import Polylines
from chordal._recipe import Recipe, Remakeable
from chordal._shape import Shape
from chordal._view import View

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


def bezier(control: ArrayLike, *, unit: str | None = None) -> Curve:
    """Cubic Bézier curves by their control points, in the plane or in space.

    `control` is one curve, 4 × 2 or 4 × 3; or a chain of n pieces whose neighbours share a point, (3n + 1) × 2 or × 3;
    or n separate curves, n × 4 × 2 or × 3. Arrays of any real type are copied. `unit` is the unit of the coordinates, for
    budgets with a unit.

    >>> import chordal
    >>> chordal.shapes.bezier([(0, 0), (0, 1), (1, 1), (1, 0)])
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
    source = _chordal.Source.curves(copied.tobytes(), counts, text("unit", unit))
    return Curve(source, None, (bezier, (copied,), {"unit": unit}))


def spline(
    points: ArrayLike,
    closed: bool = False,
    knots: Literal["centripetal", "chordal", "uniform"] = "centripetal",
    tangents: ArrayLike | None = None,
    *,
    unit: str | None = None,
) -> Curve:
    """The smooth path through points, n × 2 or n × 3: cubics, with equal second derivatives where they meet.

    It is C2 with respect to its knots, whose intervals are the square roots of the distances between the points
    ("centripetal"), the distances ("chordal"), or equal ("uniform"). Without `tangents` its second derivatives are 0 at the
    ends; two tangents are its first derivatives there, with respect to the knots. A `closed` path continues to its first
    point, which is not given twice.

    >>> import chordal
    >>> path = chordal.shapes.spline([(0, 0), (1, 2), (3, 1), (4, 4)])
    >>> path
    <Curve: 1 curve of 3 pieces, 2-D>
    >>> path.points_at([0, 1, 3])
    array([[0., 0.],
           [1., 2.],
           [4., 4.]])
    """
    ends = None if tangents is None else _points("tangents", tangents)
    return _called("spline", unit, _points("points", points), bool(closed), knots, ends)


def nurbs(
    control: ArrayLike,
    degree: SupportsIndex = 3,
    weights: ArrayLike | None = None,
    knots: ArrayLike | None = None,
    *,
    unit: str | None = None,
) -> Curve:
    """The rational B-spline with these control points, n × 2 or n × 3, of a degree from 1 to 30.

    It starts and ends at the first and the last control point, with uniform knots between, unless `knots` has n + degree
    + 1 knots of its own. `weights` are n numbers above 0, by default 1.

    >>> import chordal
    >>> quarter = chordal.shapes.nurbs([(1, 0), (1, 1), (0, 1)], degree=2, weights=[1, 0.5**0.5, 1])
    >>> quarter.points_at([0.5]).round(4).tolist()
    [[0.7071, 0.7071]]
    """
    weight_list = None if weights is None else coordinates("weights", weights).ravel().tolist()
    knot_list = None if knots is None else coordinates("knots", knots).ravel().tolist()
    return _called("nurbs", unit, _points("control", control), degree, weight_list, knot_list)


def arc(
    radius: SupportsFloat,
    start: SupportsFloat = 0,
    degrees: SupportsFloat = 360,
    center: Sequence[SupportsFloat] | None = None,
    *,
    unit: str | None = None,
) -> Curve:
    """An arc of a circle in the plane, counter-clockwise from a start over an angle, both in degrees; by default a whole
    circle. It is an exact arc, not an approximation by cubics.

    >>> import chordal
    >>> ring = chordal.shapes.arc(0.5, center=(2, 0)).revolve()  # a torus
    >>> ring.mesh(tol=0.01).report["certificate"]["valid"]["closed"]
    True
    """
    middle = None if center is None else [float(x) for x in center]
    return _called("arc", unit, radius, start, degrees, middle)


def fit(
    points: ArrayLike,
    tolerance: SupportsFloat,
    closed: bool = False,
    corners: SupportsFloat = 30,
    *,
    unit: str | None = None,
) -> Curve:
    """A path of few cubics that passes each of many points, n × 2 or n × 3, within a tolerance. Its `bound` is the largest
    distance from a point to the path. It has corners where the points turn by more than `corners` degrees, which should be
    larger for noisy points.

    Raises `Refused` if the tolerance is below the rounding error.

    >>> import chordal, numpy
    >>> t = numpy.linspace(0, 10, 201)
    >>> wave = chordal.shapes.fit(numpy.column_stack([t, numpy.sin(t)]), 1e-3)
    >>> wave.n_pieces < 12, wave.bound.at_most <= 1e-3, wave.bound.metric
    (True, True, 'one-sided')
    """
    rows = coordinates("points", points)
    if rows.ndim != 2 or rows.shape[1] not in (2, 3):
        raise ValueError(f"points: rows of 2 or 3 coordinates, as in (n, 2), not {rows.shape}")
    arguments: _chordal.FitArguments = {
        "width": rows.shape[1],
        "tolerance": number("tolerance", tolerance),
        "closed": bool(closed),
        "corners": number("corners", corners),
        "unit": text("unit", unit),
    }
    source, bound = _chordal.fit(rows.tobytes(), arguments)
    recipe = (fit, (rows, arguments["tolerance"], arguments["closed"], arguments["corners"]), {"unit": unit})
    return Curve(source, bound_of(json.loads(bound)), recipe)


def _points(name: str, points: ArrayLike) -> list[list[float]]:
    rows = coordinates(name, points)
    if rows.ndim != 2 or rows.shape[1] not in (2, 3):
        hint = "; is it the wrong way round?" if rows.ndim == 2 and rows.shape[0] in (2, 3) else ""
        raise ValueError(f"{name}: rows of 2 or 3 coordinates, as in (n, 2), not {rows.shape}{hint}")
    listed: list[list[float]] = rows.tolist()
    return listed


def _called(name: str, unit: str | None, *args: Any) -> Curve:
    """The path that a function of shape scripts returns."""
    value = _chordal.ScriptValue.call(name, *args)
    assert isinstance(value, _chordal.ScriptValue)
    return Curve(_chordal.path_source(value, text("unit", unit)), None, (_called, (name, unit, *args), {}))


class Curve(Remakeable, Guessed):
    """One or more curves, created by `bezier`, `spline`, `nurbs`, `arc` and `fit`. Curves are immutable.

    `polygon` fills a curve of the plane, and `sweep` follows a curve; both return a `Field`. `revolve` and `extrude` return
    NURBS surfaces.

    >>> import chordal
    >>> path = chordal.shapes.spline([(0, 0), (1, 2), (3, 1)])
    >>> path.n_pieces, path.closed, path.bound
    (2, False, None)
    """

    __slots__ = ("_bound", "_recipe", "_source")

    def __init__(self, source: _chordal.Source, bound: Bound | None = None, recipe: Recipe | None = None) -> None:
        refuse_own(self, source, _chordal.Source)
        self._source: Final = source
        self._bound: Final = bound
        self._recipe = recipe

    @property
    def bound(self) -> Bound | None:
        """The bound against the curve or the points that it approximates; None if it approximates nothing."""
        return self._bound

    @property
    def n_pieces(self) -> int:
        """The total number of pieces of all curves."""
        return _chordal.path_facts(self._source)[1]

    @property
    def closed(self) -> bool:
        """Whether it is a single curve that ends where it starts, and continues there as at any other joint."""
        return _chordal.path_facts(self._source)[3]

    def points_at(self, places: ArrayLike) -> NDArray[np.float64]:
        """The points at places. The whole part of a place is the index of a piece, the fraction the parameter in it, as in
        `Polyline.places`. The last axis of the result has the coordinates.

        >>> import chordal
        >>> chordal.shapes.bezier([(0, 0), (0, 1), (1, 1), (1, 0)]).points_at(0.5)
        array([0.5 , 0.75])
        """
        return self._at(places, 0)

    def derivatives(self, places: ArrayLike, order: Literal[1, 2] = 1) -> NDArray[np.float64]:
        """The first or second derivatives at places, with respect to the parameter of each piece, which runs from 0 to 1. Where
        two pieces meet, the derivative is that of the second one.

        >>> import chordal
        >>> chordal.shapes.bezier([(0, 0), (0, 1), (1, 1), (1, 0)]).derivatives([0, 0.5])
        array([[0. , 3. ],
               [1.5, 0. ]])
        """
        if order not in (1, 2):
            raise ValueError(f"order: 1 or 2, not {order}")
        return self._at(places, order)

    def _at(self, places: ArrayLike, order: int) -> NDArray[np.float64]:
        import numpy as np

        parameters = coordinates("places", places)
        width = _chordal.path_facts(self._source)[2]
        return np.frombuffer(_chordal.path_at(self._source, parameters.tobytes(), order)).reshape(*parameters.shape, width)

    def to_cubics(self, *, tol: SupportsFloat) -> Curve:
        """The curve as few lines and cubic Bézier curves within a distance, as SVG and fonts need them. Lines and cubics are
        kept. The `bound` of the result is proved, in both directions.

        >>> import chordal
        >>> circle = chordal.shapes.arc(1).to_cubics(tol=1e-3)
        >>> circle, circle.bound.at_most < 2.8e-4
        (<Curve: 1 curve of 4 pieces, 2-D>, True)
        """
        length = number("tol", tol)
        source, bound = _chordal.to_cubics(self._source, length)
        return Curve(source, bound_of(json.loads(bound)), (Curve.to_cubics, (self,), {"tol": length}))

    def revolve(self) -> Shape:
        """The surface of revolution of a plane curve, whose coordinates are radius and height: a full turn about its y axis,
        which becomes the z axis. An exact NURBS surface.

        >>> import chordal
        >>> ball = chordal.shapes.arc(1, start=-90, degrees=180).revolve()
        >>> tube = chordal.shapes.nurbs([(1, 0), (1, 2)], degree=1).revolve()
        >>> cone = chordal.shapes.nurbs([(1, 0), (0, 2)], degree=1).revolve()
        >>> [surface.mesh(tol=0.01).bound.evidence for surface in (ball, tube, cone)]
        ['proved', 'proved', 'proved']
        """
        return Shape(_chordal.revolved(self._source), (Curve.revolve, (self,), {}))

    def extrude(self, along: Sequence[SupportsFloat]) -> Shape:
        """The surface that the curve sweeps along a vector of three numbers, without caps. A plane curve lies at z = 0. An
        exact NURBS surface.

        >>> import chordal
        >>> chordal.shapes.spline([(0, 0), (1, 2), (3, 1)]).extrude((0, 0, 2)).mesh(tol=0.01).bound.evidence
        'proved'
        """
        vector = [number("along", x) for x in along]
        if len(vector) != 3:
            raise ValueError(f"along: three numbers, not {len(vector)}")
        return Shape(_chordal.extruded(self._source, vector), (Curve.extrude, (self, vector), {}))

    def shape(self) -> Shape:
        """The curves as a `Shape`, for example to inspect them; `mesh` fills those in the plane."""
        return Shape(self._source, (Curve.shape, (self,), {}))

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
        """Polylines within a budget, with the bound that was reached.

        `tol` is the largest distance between curve and polyline, in both directions; `rel` is the same as a share of the
        diagonal of the curves' box. `pixels` is the largest distance on the screen of `view`; a curve in the plane lies at
        z = 0. `segments` is the largest number of segments of all curves together. All given limits hold. `spacing` "fewest"
        takes as few segments as the budget allows; "even" takes equal steps of the parameter in each piece, which is
        faster.

        Other Python threads keep running, Ctrl-C ends the call, and exceptions of `progress` are passed on, as for
        `Shape.mesh`. Raises `BudgetError`, `BudgetUnmet` with the best `Polylines`, and `Refused`.

        >>> import chordal
        >>> arch = chordal.shapes.bezier([(0, 0), (0, 1), (1, 1), (1, 0)])
        >>> arch.flatten(tol=0.01).points.shape
        (10, 2)
        >>> arch.flatten(segments=2, spacing="even").points
        array([[0.  , 0.  ],
               [0.5 , 0.75],
               [1.  , 0.  ]])
        """
        budget = budget_options(
            tol=tol, rel=rel, pixels=pixels, view=view, segments=segments, spacing=spacing, counted="segments"
        )
        return Polylines._of(self._source.mesh(budget, "json", function("progress", progress)))

    def __repr__(self) -> str:
        n_curves, n_pieces, n_coordinates, _ = _chordal.path_facts(self._source)
        n_pieces //= n_curves
        curves = f"{n_curves} curve{'' if n_curves == 1 else 's'}"
        return f"<Curve: {curves} of {n_pieces} piece{'' if n_pieces == 1 else 's'}, {n_coordinates}-D>"
