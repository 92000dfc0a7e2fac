"""Affine transforms of meshes, with all of their attributes."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat

from chordal import _chordal
from chordal._arguments import number, vector
from chordal._arrays import coordinates
from chordal._hints import keywords_hinted
from chordal._registry import registered
from chordal._units import METRES, refuse_unknown, unit_of

if TYPE_CHECKING:
    from typing import TypeAlias

    from numpy.typing import ArrayLike, NDArray

    from chordal._mesh import Mesh

    #: Three numbers.
    _Vector: TypeAlias = Sequence[SupportsFloat] | NDArray[Any]

_Rows = list[list[float]]


class Transformable:
    """A mesh that can be transformed."""

    __slots__ = ()

    def transform(self, matrix: ArrayLike) -> Mesh:
        """The mesh under an affine map: `matrix` is 4 × 4, or its first three rows, and maps (x, y, z, 1) to the new position.

        Texture coordinates, colours, materials, parts and the unit are kept; normals and tangents are transformed. If the map
        mirrors, the winding of faces is reversed, so that the front stays the front. The bound is scaled by the largest factor
        by which the map stretches a length, and includes the rounding. If the file has nodes of its own or animations, a new
        root node gets the map, and `parts` stay as they are.

        Raises `ValueError` for a matrix that is not affine, or is singular.

        >>> import chordal
        >>> one = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
        >>> one.transform([(-2, 0, 0, 0), (0, 2, 0, 0), (0, 0, 2, 5), (0, 0, 0, 1)]).vertices[1]
        array([-2.,  0.,  5.])
        """
        rows = coordinates("matrix", matrix)
        if rows.shape not in ((3, 4), (4, 4)) or (len(rows) == 4 and rows[3].tolist() != [0, 0, 0, 1]):
            raise ValueError("matrix: 4 × 4 with a last row of 0, 0, 0, 1, or its first three rows")
        return self._moved([[float(entry) for entry in row] for row in rows[:3].tolist()], keeps_angles=False)

    def translate(self, *by: SupportsFloat | _Vector) -> Mesh:
        """The mesh translated by a vector, or by three numbers; see `transform`.

        >>> import chordal
        >>> chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]).translate((0, 0, 3)).bounds[0]
        array([0., 0., 3.])
        """
        x, y, z = vector("by", by)
        return self._moved([[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]], keeps_angles=True)

    def scale(self, *by: SupportsFloat | _Vector, about: _Vector = (0.0, 0.0, 0.0)) -> Mesh:
        """The mesh scaled about a point by one factor, or by three along x, y and z; see `transform`. Negative factors mirror.

        >>> import chordal
        >>> one = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
        >>> one.scale(2).area, one.scale((1, -1, 1)).faces.tolist()
        (2.0, [[0, 2, 1]])
        """
        steps = (number("by", by[0]),) * 3 if len(by) == 1 and isinstance(by[0], SupportsFloat) else vector("by", by)
        is_alike = len({abs(step) for step in steps}) == 1
        return self._moved(_about([[step if j == k else 0.0 for j in range(3)] for k, step in enumerate(steps)], about), is_alike)

    @keywords_hinted
    def rotate(
        self, axis: Literal["x", "y", "z"] | _Vector, degrees: SupportsFloat, *, about: _Vector = (0.0, 0.0, 0.0)
    ) -> Mesh:
        """The mesh rotated about an axis through a point, counter-clockwise as seen from the tip of the axis; see `transform`.
        `axis` is a letter or a vector. Multiples of 90 degrees about a letter are exact.

        >>> import chordal
        >>> one = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
        >>> one.rotate("z", 90).vertices[1]
        array([0., 1., 0.])
        """
        if isinstance(degrees, str):
            raise TypeError(f"axis, degrees: in this order, as in rotate({degrees!r}, {axis!r})")
        return self._moved(_about(_turn(axis, number("degrees", degrees)), about), keeps_angles=True)

    @property
    def unit(self) -> str | None:
        """The unit of the coordinates, as in "mm"; None if it is unknown or has no name."""
        return unit_of(self._metres())

    def to_unit(self, unit: Literal["um", "mm", "cm", "m", "km", "in", "ft"]) -> Mesh:
        """The same lengths in another unit; see `transform`. Raises `ValueError` if the unit of the coordinates is unknown:
        `load(…, unit=)` and `Mesh(…, unit=)` state it.

        >>> import chordal
        >>> inches = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], unit="in")
        >>> inches.to_unit("mm").extents.tolist(), inches.to_unit("mm").unit
        ([25.4, 25.4, 0.0], 'mm')
        """
        metres = self._metres()
        refuse_unknown(unit)
        if metres is None:
            raise ValueError('unit: nothing says the unit of these coordinates; load(…, unit="mm") and Mesh(…, unit="mm") do')
        named = self.unit
        factor = float((Fraction(metres) if named is None else METRES[named]) / METRES[unit])
        return self._moved(_about([[factor if j == k else 0.0 for j in range(3)] for k in range(3)], (0, 0, 0)), True, unit)

    def _metres(self) -> float | None:
        metres: float | None = self._scene["metres_per_unit"]  # type: ignore[attr-defined]
        return metres

    def _moved(self, rows: _Rows, keeps_angles: bool, unit: str | None = None) -> Mesh:
        assert isinstance(self, registered.mesh)
        if _volume_of(rows) == 0:
            raise ValueError("matrix: it flattens; of a mesh without thickness nothing is the front")
        if rows == [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]] and unit in (None, self.unit):
            return self
        bound = self.bound
        source, (least, most) = self._source.transformed([*rows, [0.0, 0.0, 0.0, 1.0]], unit, (bound.at_least, bound.at_most))
        at = None
        if bound.at is not None and len(bound.at) == 3:
            place = bound.at
            at = tuple(row[0] * place[0] + row[1] * place[1] + row[2] * place[2] + row[3] for row in rows)
        angle = bound.angle_deg if keeps_angles else None
        moved = replace(bound, at_least=least, at_most=most, pixels=None, angle_deg=angle, at=at)
        if most is not None and not math.isfinite(most):
            # Beyond the range of doubles, nothing is known about the distance.
            moved = replace(moved, at_most=None, evidence="estimated")
        return registered.mesh._of_source(source, moved)


def _volume_of(rows: _Rows) -> float:
    """The determinant of the linear part, of which only the sign is used: scaled by the largest entry against underflow."""
    largest = max(abs(entry) for row in rows for entry in row[:3]) or 1.0
    (a, b, c), (d, e, f), (g, h, i) = ([entry / largest for entry in row[:3]] for row in rows)
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def _about(linear: _Rows, about: _Vector) -> _Rows:
    """A linear map about a point. Computed with Python's own numbers, whose sums are the same on every machine."""
    point = vector("about", (about,))
    image = [row[0] * point[0] + row[1] * point[1] + row[2] * point[2] for row in linear]
    return [[*row, point[k] - image[k]] for k, row in enumerate(linear)]


def _turn(axis: str | _Vector, degrees: float) -> _Rows:
    """Rodrigues' rotation. Sine and cosine are those of shape scripts, which are the same on every machine."""
    letters = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
    if isinstance(axis, str):
        if axis not in letters:
            raise ValueError(f"axis: x, y, z or a vector, not {axis!r}")
        x, y, z = letters[axis]
    else:
        x, y, z = vector("axis", (axis,))
        length = math.sqrt(x * x + y * y + z * z)
        if length == 0:
            raise ValueError("axis: a vector of zero length has no direction")
        x, y, z = x / length, y / length, z / length
    # Exact sines and cosines, so that quarter turns round nothing.
    quarters = {0: (0.0, 1.0), 90: (1.0, 0.0), 180: (0.0, -1.0), 270: (-1.0, 0.0)}
    called: Callable[..., Any] = _chordal.ScriptValue.call
    angle = called("radians", degrees)
    sine, cosine = quarters.get(degrees % 360) or (called("sin", angle), called("cos", angle))  # type: ignore[call-overload]
    versine = 1 - cosine
    return [
        [cosine + versine * x * x, versine * x * y - sine * z, versine * x * z + sine * y],
        [versine * y * x + sine * z, cosine + versine * y * y, versine * y * z - sine * x],
        [versine * z * x - sine * y, versine * z * y + sine * x, cosine + versine * z * z],
    ]
