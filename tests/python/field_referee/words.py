"""`Solid`, and the words that make solids of numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from . import ranges as r
from .ranges import Array, Value

#: A value at points or over boxes, from three coordinates.
Function = Callable[[Value, Value, Value], Value]
SIGN, BOUND, EXACT = 0, 1, 2
EVERYWHERE = (np.full(3, -np.inf), np.full(3, np.inf))


@dataclass(frozen=True)
class Solid:
    """The points where `value` is negative, and what combinations have to know of it.

    What a value is worth as a distance and the box take part in the meaning of the words: a blend of a mere lower bound
    is not the same outside of its box. `weight` counts operations, and `leaves` are the functions whose zeros hold
    the surface, in the coordinates of the whole.
    """

    value: Function
    outside: int = SIGN
    inside: int = SIGN
    bounds: tuple[Array, Array] = EVERYWHERE
    weight: int = 4
    leaves: tuple[Function, ...] = field(default=())

    def __or__(self, other: Solid) -> Solid:
        both: Function = lambda x, y, z: r.minimum(self.value(x, y, z), other.value(x, y, z))
        low, high = np.minimum(self.bounds[0], other.bounds[0]), np.maximum(self.bounds[1], other.bounds[1])
        return self.joined(other, both, (low, high))

    def __and__(self, other: Solid) -> Solid:
        both: Function = lambda x, y, z: r.maximum(self.value(x, y, z), other.value(x, y, z))
        low, high = np.maximum(self.bounds[0], other.bounds[0]), np.minimum(self.bounds[1], other.bounds[1])
        turned = self.complement().joined(other.complement(), both, (low, high))
        return replace(turned, outside=turned.inside, inside=turned.outside, leaves=self.leaves + other.leaves)

    def __sub__(self, other: Solid) -> Solid:
        return self & other.complement()

    def complement(self) -> Solid:
        """All other points."""
        value: Function = lambda x, y, z: -self.value(x, y, z)
        return replace(self, value=value, outside=self.inside, inside=self.outside, bounds=EVERYWHERE)

    def joined(self, other: Solid, value: Function, bounds: tuple[Array, Array]) -> Solid:
        """The union's worth and leaves with a value and a box."""
        return Solid(
            value,
            min(self.outside, other.outside),
            min(self.inside, other.inside, BOUND),
            bounds,
            self.weight + other.weight + 1,
            self.leaves + other.leaves,
        )

    def at(self, points: Array) -> Array:
        """The values at points; where there is none it is not negative."""
        with np.errstate(all="ignore"):
            value = self.value(points[:, 0], points[:, 1], points[:, 2])
        value = np.broadcast_to(np.asarray(value, np.float64), len(points))
        return np.where(np.isnan(value), np.inf, value)

    def over(self, low: Array, high: Array) -> tuple[Array, Array]:
        """The ends of the values over boxes."""
        with np.errstate(all="ignore"):
            lo, hi = r.ends(self.value(*(r.Range(low[:, k], high[:, k]) for k in range(3))))
        whole = [np.broadcast_to(np.asarray(end, np.float64), len(low)) for end in (lo, hi)]
        return np.where(np.isnan(whole[0]), -np.inf, whole[0]), np.where(np.isnan(whole[1]), np.inf, whole[1])


def leaf(
    value: Function,
    worth: tuple[int, int],
    bounds: tuple[Array, Array],
    weight: int = 8,
    parts: Sequence[Function] = (),
) -> Solid:
    """A solid that is not made of others; `parts` are smooth functions whose zeros hold its surface."""
    return Solid(value, *worth, bounds, weight, tuple(parts) or (value,))


def wall(k: int, half: float) -> Function:
    """A pair of parallel planes."""
    return lambda *p: abs(p[k]) - half


def centred(*half: float) -> tuple[Array, Array]:
    """The box of these half sizes around the origin."""
    sizes = np.array(half, np.float64)
    return -sizes, sizes


def largest(parts: Sequence[Value]) -> Value:
    """The largest of some values."""
    most = parts[0]
    for part in parts[1:]:
        most = r.maximum(most, part)
    return most


def slabs(parts: Sequence[Value]) -> Value:
    """The distance to where all parts are negative, if each is the distance along its own axis."""
    most = largest(parts)
    return r.length(*(r.maximum(part, 0.0) for part in parts)) + r.minimum(most, 0.0)


def sphere(radius: float) -> Solid:
    return leaf(lambda x, y, z: r.length(x, y, z) - radius, (EXACT, EXACT), centred(radius, radius, radius))


def box(x: float, y: float, z: float) -> Solid:
    return rounded_box(x, y, z, 0.0)


def rounded_box(x: float, y: float, z: float, radius: float) -> Solid:
    half = (0.5 * x, 0.5 * y, 0.5 * z)
    inner = [h - radius for h in half]
    value: Function = lambda *p: slabs([abs(c) - h for c, h in zip(p, inner, strict=True)]) - radius
    return leaf(value, (EXACT, EXACT), centred(*half), 12, [wall(k, half[k]) for k in range(3)] if radius == 0 else ())


def cylinder(radius: float, height: float) -> Solid:
    value: Function = lambda x, y, z: slabs([r.length(x, y) - radius, abs(z) - 0.5 * height])
    parts: list[Function] = [lambda x, y, z: r.length(x, y) - radius, wall(2, 0.5 * height)]
    return leaf(value, (EXACT, EXACT), centred(radius, radius, 0.5 * height), 12, parts)


def cone(bottom: float, top: float, height: float) -> Solid:
    h = 0.5 * height
    outline = [[-bottom, -h], [bottom, -h], [top, h], [-top, h]]
    profile = contour(outline)
    value: Function = lambda x, y, z: r.lipschitz(profile, r.length(x, y), z)
    widest = max(bottom, top)
    flat, steep = height / math.hypot(height, bottom - top), (bottom - top) / math.hypot(height, bottom - top)
    side: Function = lambda x, y, z: (r.length(x, y) - bottom) * flat + (z + h) * steep
    return leaf(value, (EXACT, EXACT), centred(widest, widest, h), 60, [side, wall(2, h)])


def capsule(a: Sequence[float], b: Sequence[float], radius: float) -> Solid:
    start, end = np.array(a, np.float64), np.array(b, np.float64)
    along = end - start
    total = float(along @ along)

    def value(*p: Value) -> Value:
        away = [c - s for c, s in zip(p, start, strict=True)]
        if total == 0:
            return r.length(*away) - radius
        dot = away[0] * along[0] + away[1] * along[1] + away[2] * along[2]
        place = r.minimum(r.maximum(dot / total, 0.0), 1.0)
        return r.length(*(c - place * d for c, d in zip(away, along, strict=True))) - radius

    low, high = np.minimum(start, end) - radius, np.maximum(start, end) + radius
    return leaf(value, (EXACT, EXACT), (low, high), 16)


def torus(major: float, minor: float) -> Solid:
    reach = major + minor
    value: Function = lambda x, y, z: r.length(r.length(x, y) - major, z) - minor
    return leaf(value, (EXACT, EXACT if minor <= major else BOUND), centred(reach, reach, minor))


def ellipsoid(x: float, y: float, z: float) -> Solid:
    radii = (x, y, z)

    def value(*p: Value) -> Value:
        flat = (r.length(*(c / s for c, s in zip(p, radii, strict=True))) - 1.0) * min(radii)
        return r.maximum(flat, r.length(*p) - max(radii))

    return leaf(value, (BOUND, BOUND), centred(*radii), 12)


def octahedron(radius: float) -> Solid:
    value: Function = lambda x, y, z: (abs(x) + abs(y) + abs(z) - radius) / math.sqrt(3)
    return leaf(value, (BOUND, EXACT), centred(radius, radius, radius))


def tetrahedron(radius: float) -> Solid:
    def value(x: Value, y: Value, z: Value) -> Value:
        return largest([-(x + y + z), y + z - x, z + x - y, x + y - z]) / math.sqrt(3) - radius / 3

    reach = radius / math.sqrt(3)
    return leaf(value, (BOUND, EXACT), centred(reach, reach, reach), 12)


def plane(normal: Sequence[float], offset: float = 0.0) -> Solid:
    n = np.array(normal, np.float64)
    n = n / np.max(np.abs(n))
    n = n / np.sqrt(n @ n)
    low, high = np.full(3, -np.inf), np.full(3, np.inf)
    used = np.flatnonzero(n)
    if len(used) == 1:
        (high if n[used[0]] > 0 else low)[used[0]] = offset if n[used[0]] > 0 else -offset

    def value(*p: Value) -> Value:
        terms = [p[k] * n[k] for k in used]
        return sum(terms[1:], terms[0]) - offset

    return leaf(value, (EXACT, EXACT), (low, high), 4)


def triangle(a: Sequence[float], b: Sequence[float], c: Sequence[float], thickness: float) -> Solid:
    from .mesh import point_triangle

    corners = np.array([a, b, c], np.float64)

    def away(x: Value, y: Value, z: Value) -> Array:
        points = np.stack(np.broadcast_arrays(x, y, z), axis=-1).reshape(-1, 3)
        return point_triangle(points, *(np.broadcast_to(p, points.shape) for p in corners))

    half = 0.5 * thickness
    value: Function = lambda x, y, z: r.lipschitz(away, x, y, z) - half
    return leaf(value, (EXACT, EXACT), (corners.min(axis=0) - half, corners.max(axis=0) + half), 60)


def waves(period: float, level: float, combine: Callable[..., Value]) -> Solid:
    """A sum of products of sines and cosines, over the steepest slope that it can have."""
    k = math.tau / period

    def value(*p: Value) -> Value:
        angles = [c * k for c in p]
        total = combine([r.sin(a) for a in angles], [r.cos(a) for a in angles])
        return (total - level) * (1 / (k * math.sqrt(3)))

    return leaf(value, (BOUND, BOUND), EVERYWHERE, 40)


def gyroid(period: float, level: float = 0.0) -> Solid:
    return waves(period, level, lambda s, c: s[0] * c[1] + s[1] * c[2] + s[2] * c[0])


def schwarz_p(period: float, level: float = 0.0) -> Solid:
    return waves(period, level, lambda s, c: c[0] + c[1] + c[2])


def diamond(period: float, level: float = 0.0) -> Solid:
    def combine(s: Any, c: Any) -> Value:
        return c[2] * (s[0] * c[1] + c[0] * s[1]) + s[2] * (c[0] * c[1] + s[0] * s[1])

    return waves(period, level, combine)


def endless(low: Sequence[float], high: Sequence[float]) -> tuple[Array, Array]:
    """A box of the plane, without end along z."""
    return np.array([*low, -np.inf]), np.array([*high, np.inf])


def circle(radius: float) -> Solid:
    return leaf(lambda x, y, z: r.length(x, y) - radius, (EXACT, EXACT), endless([-radius] * 2, [radius] * 2))


def rectangle(x: float, y: float) -> Solid:
    return rounded_rectangle(x, y, 0.0)


def rounded_rectangle(x: float, y: float, radius: float) -> Solid:
    half = [0.5 * x, 0.5 * y]
    value: Function = lambda u, v, w: (
        slabs([abs(u) - (half[0] - radius), abs(v) - (half[1] - radius)]) - radius
    )
    parts = [wall(k, half[k]) for k in range(2)] if radius == 0 else ()
    return leaf(value, (EXACT, EXACT), endless([-h for h in half], half), 10, parts)


def segment(a: Sequence[float], b: Sequence[float], radius: float) -> Solid:
    solid = capsule([*a, 0.0], [*b, 0.0], radius)
    value: Function = lambda x, y, z: solid.value(x, y, 0.0)
    low, high = solid.bounds
    return leaf(value, (EXACT, EXACT), endless(list(low[:2]), list(high[:2])), 16)


def polygon(points: Sequence[Sequence[float]]) -> Solid:
    corners = np.array(points, np.float64)
    away = contour(points)
    value: Function = lambda x, y, z: r.lipschitz(away, x, y)
    low, high = corners.min(axis=0), corners.max(axis=0)
    lines = [line(a, b) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True) if np.any(a != b)]
    return leaf(value, (EXACT, EXACT), endless(list(low), list(high)), 15 * len(corners), lines)


def line(a: Array, b: Array) -> Function:
    """The signed distance to the line through two points."""
    n = np.array([b[1] - a[1], a[0] - b[0]]) / math.hypot(b[0] - a[0], b[1] - a[1])
    return lambda x, y, z: (x - a[0]) * n[0] + (y - a[1]) * n[1]


def regular_polygon(sides: float, radius: float) -> Solid:
    n = int(sides)
    return polygon(
        [[radius * math.cos(math.tau * k / n), radius * math.sin(math.tau * k / n)] for k in range(n)]
    )


def contour(points: Sequence[Sequence[float]]) -> Callable[[Value, Value], Array]:
    """The signed distance to a closed polygon, negative inside, where a ray crosses it an odd number of times."""
    corners = np.array(points, np.float64)
    following = np.roll(corners, -1, axis=0)
    edges = [(a, b) for a, b in zip(corners, following, strict=True) if np.any(a != b)]

    def signed(x: Value, y: Value) -> Array:
        u, v = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
        least = np.full(u.shape, np.inf)
        inside = np.zeros(u.shape, bool)
        for a, b in edges:
            d = b - a
            px, py = u - a[0], v - a[1]
            t = np.clip((px * d[0] + py * d[1]) / (d @ d), 0.0, 1.0)
            qx, qy = px - t * d[0], py - t * d[1]
            least = np.minimum(least, qx * qx + qy * qy)
            crosses = (a[1] <= v) != (b[1] <= v)
            if d[1] != 0:
                inside ^= crosses & (px * d[1] < py * d[0] if d[1] > 0 else px * d[1] > py * d[0])
        size = np.sqrt(least)
        return np.where(inside, -size, size)

    return signed
