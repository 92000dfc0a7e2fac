"""Numbers, arrays of numbers and ranges of them under one set of functions."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
#: A number, an array, or a `Range`; the functions below take any of them.
Value = Any

#: How far an end of a range is pushed out after an operation: more than the rounding of the operation, half a unit in
#: the last place, or of a function of numpy, at most four units (numpy's own tests).
SLACK = 16 * np.finfo(np.float64).eps
TINY = float(np.finfo(np.float64).tiny)


class Range:
    """All numbers from `lo` to `hi`, for many places at once. Ends are pushed outward by more than rounding."""

    __array_ufunc__ = None  # numpy leaves operators to this class

    def __init__(self, lo: Value, hi: Value) -> None:
        self.lo, self.hi = lo, hi

    @staticmethod
    def around(lo: Value, hi: Value) -> Range:
        """The range with its ends pushed out; an end that is no number is without end."""
        lo = lo - SLACK * np.abs(lo) - TINY
        hi = hi + SLACK * np.abs(hi) + TINY
        return Range(np.where(np.isnan(lo), -np.inf, lo), np.where(np.isnan(hi), np.inf, hi))

    def __neg__(self) -> Range:
        return Range(-self.hi, -self.lo)

    def __abs__(self) -> Range:
        least = np.maximum(np.maximum(self.lo, -self.hi), 0.0)
        return Range(least, np.maximum(-self.lo, self.hi))

    def __add__(self, other: Value) -> Range:
        lo, hi = ends(other)
        return Range.around(self.lo + lo, self.hi + hi)

    __radd__ = __add__

    def __sub__(self, other: Value) -> Range:
        lo, hi = ends(other)
        return Range.around(self.lo - hi, self.hi - lo)

    def __rsub__(self, other: Value) -> Range:
        lo, hi = ends(other)
        return Range.around(lo - self.hi, hi - self.lo)

    def __mul__(self, other: Value) -> Range:
        lo, hi = ends(other)
        products = [a * b for a in (self.lo, self.hi) for b in (lo, hi)]
        # 0 times what has no end: any finite number takes part, so the product is 0.
        products = [np.where(np.isnan(p), 0.0, p) for p in products]
        return Range.around(np.minimum.reduce(products), np.maximum.reduce(products))

    __rmul__ = __mul__

    def __truediv__(self, other: Value) -> Range:
        lo, hi = ends(other)
        clear = (lo > 0) | (hi < 0)
        inverse = Range.around(np.where(clear, 1 / hi, -np.inf), np.where(clear, 1 / lo, np.inf))
        return self * inverse

    def __rtruediv__(self, other: Value) -> Range:
        return Range(*ends(other)) / self


def ends(value: Value) -> tuple[Value, Value]:
    """The two ends of a range; a number is both of its own."""
    return (value.lo, value.hi) if isinstance(value, Range) else (value, value)


def rising(value: Value, function: Callable[[Value], Value], low: float = -math.inf, high: float = math.inf) -> Value:
    """A function that never falls, which is defined from `low` to `high`."""
    if isinstance(value, Range):
        inside = (value.lo >= low) & (value.hi <= high)
        lo, hi = function(np.clip(value.lo, low, high)), function(np.clip(value.hi, low, high))
        return Range.around(np.where(inside, lo, -np.inf), np.where(inside, hi, np.inf))
    return function(value)


def sqrt(value: Value) -> Value:
    """The square root; of sums of squares, so what rounding or a wide range puts below 0 is 0."""
    if isinstance(value, Range):
        return Range.around(np.sqrt(np.maximum(value.lo, 0.0)), np.sqrt(np.maximum(value.hi, 0.0)))
    return np.sqrt(value)


def square(value: Value) -> Value:
    """The square."""
    if isinstance(value, Range):
        size = abs(value)
        return Range.around(size.lo * size.lo, size.hi * size.hi)
    return value * value


def length(*parts: Value) -> Value:
    """The length of a vector."""
    total = square(parts[0])
    for part in parts[1:]:
        total = total + square(part)
    return sqrt(total)


def minimum(a: Value, b: Value) -> Value:
    """The smaller of both."""
    if isinstance(a, Range) or isinstance(b, Range):
        (p, q), (r, s) = ends(a), ends(b)
        return Range(np.minimum(p, r), np.minimum(q, s))
    return np.minimum(a, b)


def maximum(a: Value, b: Value) -> Value:
    """The larger of both."""
    if isinstance(a, Range) or isinstance(b, Range):
        (p, q), (r, s) = ends(a), ends(b)
        return Range(np.maximum(p, r), np.maximum(q, s))
    return np.maximum(a, b)


def sin(value: Value) -> Value:
    """The sine."""
    if not isinstance(value, Range):
        return np.sin(value)

    def holds(top: float) -> Value:
        # Whether `top` plus whole turns lies in the range.
        return np.floor((value.hi - top) / math.tau + 1e-9) >= np.ceil((value.lo - top) / math.tau - 1e-9)

    a, b = np.sin(value.lo), np.sin(value.hi)
    endless = ~(np.abs(value.lo) < 1e6) | ~(np.abs(value.hi) < 1e6)
    hi = np.where(holds(math.pi / 2) | endless, 1.0, np.maximum(a, b))
    lo = np.where(holds(-math.pi / 2) | endless, -1.0, np.minimum(a, b))
    return Range.around(lo, hi)


def cos(value: Value) -> Value:
    """The cosine."""
    return sin(value + math.pi / 2) if isinstance(value, Range) else np.cos(value)


def tan(value: Value) -> Value:
    """The tangent."""
    return sin(value) / cos(value) if isinstance(value, Range) else np.tan(value)


def atan2(y: Value, x: Value) -> Value:
    """The angle of a point; of a box that does not lie right of the second axis, any."""
    if not isinstance(y, Range) and not isinstance(x, Range):
        return np.arctan2(y, x)
    (y0, y1), (x0, x1) = ends(y), ends(x)
    corners = [np.arctan2(v, u) for v in (y0, y1) for u in (x0, x1)]
    # Away from the jump at the negative axis and from the origin the extremes are at corners.
    plain = (x0 > 0) | (y0 > 0) | (y1 < 0)
    lo = np.where(plain, np.minimum.reduce(corners), -math.pi)
    hi = np.where(plain, np.maximum.reduce(corners), math.pi)
    return Range.around(lo, hi)


def nearest_whole(value: Value) -> Value:
    """The nearest whole number, halves away from 0."""
    return rising(value, lambda v: np.where(v < 0, -np.floor(0.5 - v), np.floor(v + 0.5)))


def lipschitz(function: Callable[..., Array], *coordinates: Value) -> Value:
    """A function that changes by no more than one moves, at points or over boxes."""
    if not any(isinstance(c, Range) for c in coordinates):
        return function(*coordinates)
    boxes = [ends(c) for c in coordinates]
    middles = np.broadcast_arrays(*[0.5 * (lo + hi) for lo, hi in boxes])
    reach: Value = 0.0
    for lo, hi in boxes:
        reach = reach + np.square(0.5 * (hi - lo))
    reach = np.sqrt(reach)
    size = sum(np.abs(m) for m in middles)
    value = function(*middles)
    # Contours and triangles round like their coordinates do.
    reach = reach + SLACK * 64 * (size + np.abs(value))
    return Range.around(value - reach, value + reach)
