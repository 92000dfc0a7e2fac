"""Formulas of the coordinates, by the names of shape scripts."""

from __future__ import annotations

import math
from typing import SupportsFloat, overload

from chordal._field import Formula, called, coordinate

#: Half of a full turn, in radians.
pi: float = math.pi
#: The first coordinate of a point.
x: Formula = coordinate(0)
#: The second coordinate of a point.
y: Formula = coordinate(1)
#: The third coordinate of a point, which is height.
z: Formula = coordinate(2)


@overload
def sqrt(value: SupportsFloat) -> float: ...
@overload
def sqrt(value: Formula | SupportsFloat) -> Formula | float: ...
def sqrt(value: Formula | SupportsFloat) -> Formula | float:
    """The square root."""
    return called("sqrt", value)  # type: ignore[no-any-return]


@overload
def exp(value: SupportsFloat) -> float: ...
@overload
def exp(value: Formula | SupportsFloat) -> Formula | float: ...
def exp(value: Formula | SupportsFloat) -> Formula | float:
    """The exponential function."""
    return called("exp", value)  # type: ignore[no-any-return]


@overload
def log(value: SupportsFloat) -> float: ...
@overload
def log(value: Formula | SupportsFloat) -> Formula | float: ...
def log(value: Formula | SupportsFloat) -> Formula | float:
    """The natural logarithm."""
    return called("log", value)  # type: ignore[no-any-return]


@overload
def sin(value: SupportsFloat) -> float: ...
@overload
def sin(value: Formula | SupportsFloat) -> Formula | float: ...
def sin(value: Formula | SupportsFloat) -> Formula | float:
    """The sine of an angle in radians."""
    return called("sin", value)  # type: ignore[no-any-return]


@overload
def cos(value: SupportsFloat) -> float: ...
@overload
def cos(value: Formula | SupportsFloat) -> Formula | float: ...
def cos(value: Formula | SupportsFloat) -> Formula | float:
    """The cosine of an angle in radians."""
    return called("cos", value)  # type: ignore[no-any-return]


@overload
def tan(value: SupportsFloat) -> float: ...
@overload
def tan(value: Formula | SupportsFloat) -> Formula | float: ...
def tan(value: Formula | SupportsFloat) -> Formula | float:
    """The tangent of an angle in radians."""
    return called("tan", value)  # type: ignore[no-any-return]


@overload
def asin(value: SupportsFloat) -> float: ...
@overload
def asin(value: Formula | SupportsFloat) -> Formula | float: ...
def asin(value: Formula | SupportsFloat) -> Formula | float:
    """The arcsine, in radians."""
    return called("asin", value)  # type: ignore[no-any-return]


@overload
def acos(value: SupportsFloat) -> float: ...
@overload
def acos(value: Formula | SupportsFloat) -> Formula | float: ...
def acos(value: Formula | SupportsFloat) -> Formula | float:
    """The arccosine, in radians."""
    return called("acos", value)  # type: ignore[no-any-return]


@overload
def atan(value: SupportsFloat) -> float: ...
@overload
def atan(value: Formula | SupportsFloat) -> Formula | float: ...
def atan(value: Formula | SupportsFloat) -> Formula | float:
    """The arctangent, in radians."""
    return called("atan", value)  # type: ignore[no-any-return]


@overload
def floor(value: SupportsFloat) -> float: ...
@overload
def floor(value: Formula | SupportsFloat) -> Formula | float: ...
def floor(value: Formula | SupportsFloat) -> Formula | float:
    """The largest integer that is not above the value."""
    return called("floor", value)  # type: ignore[no-any-return]


@overload
def ceil(value: SupportsFloat) -> float: ...
@overload
def ceil(value: Formula | SupportsFloat) -> Formula | float: ...
def ceil(value: Formula | SupportsFloat) -> Formula | float:
    """The smallest integer that is not below the value."""
    return called("ceil", value)  # type: ignore[no-any-return]


@overload
def radians(value: SupportsFloat) -> float: ...
@overload
def radians(value: Formula | SupportsFloat) -> Formula | float: ...
def radians(value: Formula | SupportsFloat) -> Formula | float:
    """An angle in degrees, converted to radians."""
    return called("radians", value)  # type: ignore[no-any-return]


@overload
def atan2(y: SupportsFloat, x: SupportsFloat) -> float: ...
@overload
def atan2(y: Formula | SupportsFloat, x: Formula | SupportsFloat) -> Formula | float: ...
def atan2(y: Formula | SupportsFloat, x: Formula | SupportsFloat) -> Formula | float:
    """The angle of the point (x, y) from the x axis, in radians."""
    return called("atan2", y, x)  # type: ignore[no-any-return]


@overload
def minimum(a: SupportsFloat, b: SupportsFloat) -> float: ...
@overload
def minimum(a: Formula | SupportsFloat, b: Formula | SupportsFloat) -> Formula | float: ...
def minimum(a: Formula | SupportsFloat, b: Formula | SupportsFloat) -> Formula | float:
    """The smaller of two values."""
    return called("minimum", a, b)  # type: ignore[no-any-return]


@overload
def maximum(a: SupportsFloat, b: SupportsFloat) -> float: ...
@overload
def maximum(a: Formula | SupportsFloat, b: Formula | SupportsFloat) -> Formula | float: ...
def maximum(a: Formula | SupportsFloat, b: Formula | SupportsFloat) -> Formula | float:
    """The larger of two values."""
    return called("maximum", a, b)  # type: ignore[no-any-return]
