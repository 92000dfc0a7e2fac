"""The words that make solids of solids."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from . import ranges as r
from .ranges import Array, Value
from .words import BOUND, EXACT, SIGN, Function, Solid, slabs

#: Copies along an axis up to which all of them are evaluated; beyond it only those near a point.
FEW = 32


def every(parts: Sequence[Solid | Sequence[Solid]]) -> list[Solid]:
    """All solids of arguments, where a list stands for what it holds."""
    return [solid for part in parts for solid in ([part] if isinstance(part, Solid) else part)]


def balanced(solids: list[Solid], join: Callable[[Solid, Solid], Solid]) -> Solid:
    """Solids joined in pairs, and the pairs again."""
    while len(solids) > 1:
        pairs = [solids[k : k + 2] for k in range(0, len(solids), 2)]
        solids = [join(pair[0], pair[1]) if len(pair) == 2 else pair[0] for pair in pairs]
    return solids[0]


def union(*shapes: Solid | Sequence[Solid]) -> Solid:
    return balanced(every(shapes), lambda a, b: a | b)


def intersection(*shapes: Solid | Sequence[Solid]) -> Solid:
    return balanced(every(shapes), lambda a, b: a & b)


def difference(shape: Solid, *others: Solid | Sequence[Solid]) -> Solid:
    return shape - union(*others) if others else shape


def complement(shape: Solid) -> Solid:
    return shape.complement()


def held(shape: Solid) -> Solid:
    """What takes part in blends and offsets: a lower bound is kept at or above the distance to its box."""
    assert shape.outside != SIGN, "the words that blend need a distance outside"
    if shape.outside == EXACT:
        return shape
    low, high = shape.bounds

    def value(*p: Value) -> Value:
        most = shape.value(*p)
        for k in range(3):
            if np.isfinite(high[k]):
                most = r.maximum(most, p[k] - high[k])
            if np.isfinite(low[k]):
                most = r.maximum(most, low[k] - p[k])
        return most

    return replace(shape, value=value)


def grown(bounds: tuple[Array, Array], by: float) -> tuple[Array, Array]:
    """A box grown to all sides."""
    return bounds[0] - by, bounds[1] + by


def smooth_union(a: Solid, b: Solid, radius: float) -> Solid:
    first, second = held(a), held(b)

    def value(x: Value, y: Value, z: Value) -> Value:
        u, v = first.value(x, y, z) / radius, second.value(x, y, z) / radius
        near = r.maximum(1.0 - abs(u - v), 0.0)
        return (r.minimum(u, v) - r.square(near) * 0.25) * radius

    low, high = np.minimum(a.bounds[0], b.bounds[0]), np.maximum(a.bounds[1], b.bounds[1])
    joined = a.joined(b, value, grown((low, high), 0.25 * radius))
    return replace(joined, outside=BOUND, leaves=(value,), weight=joined.weight + 6)


def smooth_intersection(a: Solid, b: Solid, radius: float) -> Solid:
    made = smooth_union(a.complement(), b.complement(), radius).complement()
    return replace(made, bounds=(a & b).bounds)


def smooth_difference(a: Solid, b: Solid, radius: float) -> Solid:
    return smooth_intersection(a, b.complement(), radius)


def placed(shape: Solid, back: Callable[[Value, Value, Value], Sequence[Value]]) -> Solid:
    """The solid in other coordinates, with its leaves; its box is left to the caller."""

    def moved(function: Function) -> Function:
        return lambda x, y, z: function(*back(x, y, z))

    leaves = tuple(moved(function) for function in shape.leaves)
    return replace(shape, value=moved(shape.value), leaves=leaves, weight=shape.weight + 3)


def move(shape: Solid, x: float, y: float, z: float = 0.0) -> Solid:
    by = np.array([x, y, z], np.float64)
    made = placed(shape, lambda u, v, w: (u - x, v - y, w - z))
    return replace(made, bounds=(shape.bounds[0] + by, shape.bounds[1] + by))


def turned(shape: Solid, rows: Array) -> Solid:
    """The solid in coordinates that a matrix without stretch takes back to its own."""

    def back(*p: Value) -> list[Value]:
        found = []
        for row in rows:
            terms = [p[k] * row[k] for k in range(3) if row[k] != 0]
            found.append(sum(terms[1:], terms[0]))
        return found

    # The inverse of such a matrix is its transpose; 0 times an endless side is 0.
    ends = [[rows[i, k] * shape.bounds[e][i] if rows[i, k] != 0 else 0.0 for i in range(3)] for k in range(3) for e in (0, 1)]
    pairs = np.array(ends).reshape(3, 2, 3)
    low, high = pairs.min(axis=1).sum(axis=1), pairs.max(axis=1).sum(axis=1)
    return replace(placed(shape, back), bounds=(low, high))


def rotate(shape: Solid, axis: Sequence[float], degrees: float) -> Solid:
    n = np.array(axis, np.float64)
    n = n / np.max(np.abs(n))
    n = n / np.sqrt(n @ n)
    turn = math.radians(math.fmod(degrees, 360.0))
    quarters = {0: (0.0, 1.0), 90: (1.0, 0.0), 180: (0.0, -1.0), 270: (-1.0, 0.0)}
    s, c = quarters.get(degrees % 360, (math.sin(turn), math.cos(turn)))  # type: ignore[call-overload]
    skew = np.array([[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]])
    forward = c * np.eye(3) + s * skew + (1 - c) * np.outer(n, n)
    return turned(shape, forward.T)


def rotate_x(shape: Solid, degrees: float) -> Solid:
    return rotate(shape, (1, 0, 0), degrees)


def rotate_y(shape: Solid, degrees: float) -> Solid:
    return rotate(shape, (0, 1, 0), degrees)


def rotate_z(shape: Solid, degrees: float) -> Solid:
    return rotate(shape, (0, 0, 1), degrees)


def mirror(shape: Solid, x: float, y: float, z: float = 0.0) -> Solid:
    n = np.array([x, y, z], np.float64)
    return turned(shape, np.eye(3) - 2 * np.outer(n, n) / (n @ n))


def scale(shape: Solid, factor: float) -> Solid:
    return scaled(shape, (factor, factor, factor))


def stretch(shape: Solid, x: float, y: float, z: float = 1.0) -> Solid:
    made = scaled(shape, (x, y, z))
    return replace(made, outside=min(made.outside, BOUND), inside=min(made.inside, BOUND))


def scaled(shape: Solid, by: tuple[float, float, float]) -> Solid:
    """The solid with a factor along each axis; the value stays at or below the distance."""
    least = min(abs(b) for b in by)
    made = placed(shape, lambda x, y, z: (x / by[0], y / by[1], z / by[2]))
    inner = made.value
    ends = np.array([shape.bounds[0] * by, shape.bounds[1] * by])
    value: Function = lambda x, y, z: inner(x, y, z) * least
    return replace(made, value=value, bounds=(ends.min(axis=0), ends.max(axis=0)))


def repeat(
    shape: Solid, x: float = 0, y: float = 0, z: float = 0, nx: float = 0, ny: float = 0, nz: float = 0
) -> Solid:
    low, high = shape.bounds
    axes = [Copies(p, int(n), low[k], high[k]) for k, (p, n) in enumerate(zip((x, y, z), (nx, ny, nz), strict=True))]
    choices = list(itertools.product(*(axis.numbers for axis in axes)))

    def back(choice: Sequence[int]) -> Callable[[Value, Value, Value], Sequence[Value]]:
        return lambda *p: [axis.place(c, k) for axis, c, k in zip(axes, p, choice, strict=True)]

    copies = [placed(shape, back(choice)) for choice in choices]
    whole = balanced(copies, lambda a, b: a | b)
    first = np.array([axis.bounds(low[k], high[k])[0] for k, axis in enumerate(axes)])
    last = np.array([axis.bounds(low[k], high[k])[1] for k, axis in enumerate(axes)])
    jumps = shape.outside != EXACT and any(axis.window > 1 for axis in axes)
    return replace(
        whole,
        bounds=(first, last),
        outside=SIGN if jumps else shape.outside,
        inside=min(shape.inside, BOUND),
    )


class Copies:
    """Copies along one axis: all of them where they are few, or those around the nearest."""

    def __init__(self, period: float, count: int, low: float, high: float) -> None:
        self.period, self.count = period, count
        self.once = period == 0 or count == 1
        if self.once:
            self.numbers, self.near, self.window = [0], False, 1
            return
        around = range(math.floor(-high / period) - 1, math.ceil(-low / period) + 2)
        self.window = len(around)
        self.near = count == 0 or count > FEW
        self.numbers = list(around) if self.near else list(range(count))

    def place(self, at: Value, k: int) -> Value:
        """The coordinate within copy `k`, counted from the nearest one where there are many."""
        if self.once:
            return at
        number: Value = k
        if self.near:
            number = r.nearest_whole(at / self.period) + k
            if self.count:
                number = r.minimum(r.maximum(number, 0.0), self.count - 1.0)
        return at - number * self.period

    def bounds(self, low: float, high: float) -> tuple[float, float]:
        """The ends of all copies."""
        if self.once:
            return low, high
        return (-np.inf, np.inf) if self.count == 0 else (low, high + (self.count - 1) * self.period)


def offset(shape: Solid, by: float) -> Solid:
    if by == 0:
        return shape
    from_outside = held(shape) if by > 0 else shape
    value: Function = lambda x, y, z: from_outside.value(x, y, z) - by
    made = replace(shape, value=value, leaves=(value,))
    if by > 0:
        return replace(made, inside=min(shape.inside, BOUND), bounds=grown(shape.bounds, by))
    return replace(made, outside=min(shape.outside, BOUND))


def shell(shape: Solid, thickness: float) -> Solid:
    wall, half = held(shape), 0.5 * thickness
    outer: Function = lambda x, y, z: wall.value(x, y, z) - half
    inner: Function = lambda x, y, z: -wall.value(x, y, z) - half
    value: Function = lambda x, y, z: abs(wall.value(x, y, z)) - half
    return replace(
        shape,
        value=value,
        leaves=(outer, inner),
        outside=min(shape.outside, shape.inside),
        inside=BOUND,
        bounds=grown(shape.bounds, half),
    )


def has_height(shape: Solid) -> bool:
    """Whether the values depend on z, by a look at some places."""
    points = np.random.default_rng(1).uniform(-3, 3, (64, 3))
    other = points + np.array([0.0, 0.0, 0.731])
    return not np.array_equal(shape.at(points), shape.at(other))


def of_the_plane(shape: Solid) -> tuple[int, int]:
    """What the values are worth in a section."""
    if has_height(shape):
        return min(shape.outside, BOUND), min(shape.inside, BOUND)
    return shape.outside, shape.inside


def extrude(shape: Solid, height: float) -> Solid:
    half = 0.5 * height
    cap: Function = lambda x, y, z: abs(z) - half
    value: Function = lambda x, y, z: slabs([shape.value(x, y, 0.0), cap(x, y, z)])
    outside, inside = of_the_plane(shape)
    low, high = shape.bounds
    flat = tuple((lambda f: lambda x, y, z: f(x, y, 0.0))(f) for f in shape.leaves)  # noqa: B023 (it is bound at once)
    bounds = (np.array([low[0], low[1], -half]), np.array([high[0], high[1], half]))
    return Solid(value, outside, inside, bounds, shape.weight + 6, (*flat, cap))


def revolve(shape: Solid) -> Solid:
    made = placed(shape, lambda x, y, z: (r.length(x, y), z, 0.0))
    outside, inside = of_the_plane(shape)
    low, high = shape.bounds
    return replace(
        made,
        outside=outside if low[0] >= 0 else min(outside, BOUND),
        inside=inside if low[0] > 0 else min(inside, BOUND),
        bounds=(np.array([-high[0], -high[0], low[1]]), np.array([high[0], high[0], high[1]])),
    )


def twist(shape: Solid, degrees: float) -> Solid:
    return turning(shape, 2, math.radians(degrees))


def bend(shape: Solid, degrees: float) -> Solid:
    return turning(shape, 0, math.radians(degrees))


def turning(shape: Solid, axis: int, slope: float) -> Solid:
    """The solid turned about z by an angle that grows along an axis.

    Its value, where it is to be a distance, is asked at the nearest point of a cylinder just around the box, and is
    divided by how far the turn stretches there.
    """
    if slope == 0:
        return shape

    def back(p: Sequence[Value], along: Value) -> Sequence[Value]:
        s, c = r.sin(along * slope), r.cos(along * slope)
        return c * p[0] + s * p[1], c * p[1] - s * p[0], p[2]

    plain = placed(shape, lambda *p: back(p, p[axis]))
    low, high = shape.bounds
    reach = float(np.hypot(*np.maximum(np.abs(low[:2]), np.abs(high[:2]))))
    bounds = (np.array([-reach, -reach, low[2]]), np.array([reach, reach, high[2]]))
    if not math.isfinite(reach):
        return replace(plain, outside=SIGN, inside=SIGN, bounds=bounds)
    rim = reach * (1 + 1 / 1024)
    pull = abs(slope) * rim
    most = 0.5 * (pull + math.sqrt(pull * pull + 4)) if axis == 2 else 1 + pull

    def value(x: Value, y: Value, z: Value) -> Value:
        off = r.length(x, y)
        share = rim / r.maximum(off, rim)
        onto = (x * share, y * share, z)
        return r.maximum(shape.value(*back(onto, onto[axis])) / most, off - rim)

    return replace(
        plain,
        value=value,
        outside=min(shape.outside, BOUND),
        inside=min(shape.inside, BOUND),
        bounds=bounds,
    )


def displace(shape: Solid, by: object, amplitude: float) -> Solid:
    from .script import Formula, of_formula

    formula: Formula = of_formula(by)
    base = held(shape)
    value: Function = lambda x, y, z: base.value(x, y, z) + formula.value(x, y, z)
    return Solid(value, SIGN, SIGN, grown(shape.bounds, amplitude), shape.weight + 10, (value,))


