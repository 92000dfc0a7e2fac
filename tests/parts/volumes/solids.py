"""Solids as their exact membership tests in numpy, areas and volumes in closed form, and integrals by sampling.

A `Solid` is a function of x, y and z that is negative inside, and a box that holds all of it. Values are distances where
a blend needs one. Nothing here calls Chordal: the words are those of the scripts because a part reads the same then.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

PI = math.pi
Array = np.ndarray
Value = Callable[[Array, Array, Array], Array]


class Estimate(float):
    """A number with the standard error of its sampling."""

    error: float

    def __new__(cls, value: float, error: float) -> Estimate:
        made = super().__new__(cls, value)
        made.error = error
        return made

    def __add__(self, other: float) -> Estimate:
        return Estimate(float(self) + float(other), math.hypot(self.error, getattr(other, "error", 0.0)))

    def __sub__(self, other: float) -> Estimate:
        return self + -1 * other

    def __mul__(self, factor: float) -> Estimate:
        return Estimate(float(self) * factor, self.error * abs(factor))

    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, other: float) -> Estimate:
        return -1 * self + other


class Solid:
    """The points where `value` is negative, all of them between `low` and `high`."""

    def __init__(self, value: Value, low: Sequence[float], high: Sequence[float]) -> None:
        self.value, self.low, self.high = value, np.array(low, float), np.array(high, float)

    def __or__(self, other: Solid) -> Solid:
        value: Value = lambda x, y, z: np.minimum(self.value(x, y, z), other.value(x, y, z))
        return Solid(value, np.minimum(self.low, other.low), np.maximum(self.high, other.high))

    def __and__(self, other: Solid) -> Solid:
        value: Value = lambda x, y, z: np.maximum(self.value(x, y, z), other.value(x, y, z))
        return Solid(value, np.maximum(self.low, other.low), np.minimum(self.high, other.high))

    def __sub__(self, other: Solid) -> Solid:
        return Solid(lambda x, y, z: np.maximum(self.value(x, y, z), -other.value(x, y, z)), self.low, self.high)


# Solids and shapes of the plane, which are endless along z: lengths as in the scripts, distances as values.


def slabs(parts: Sequence[Array]) -> Array:
    """The distance to where all parts are negative, each of which is the distance along its own axis."""
    most = parts[0]
    for part in parts[1:]:
        most = np.maximum(most, part)
    return np.sqrt(sum(np.maximum(part, 0) ** 2 for part in parts)) + np.minimum(most, 0)


def box(x: float, y: float, z: float, radius: float = 0) -> Solid:
    half = np.array([x, y, z]) / 2
    inner = half - radius
    value: Value = lambda *p: slabs([abs(c) - h for c, h in zip(p, inner, strict=True)]) - radius
    return Solid(value, -half, half)


def cylinder(radius: float, height: float) -> Solid:
    reach = [radius, radius, height / 2]
    return Solid(lambda x, y, z: slabs([np.hypot(x, y) - radius, abs(z) - height / 2]), np.negative(reach), reach)


def cone(bottom: float, top: float, height: float) -> Solid:
    return revolve([[0, -height / 2], [bottom, -height / 2], [top, height / 2], [0, height / 2]])


def sphere(radius: float) -> Solid:
    return Solid(lambda x, y, z: np.sqrt(x * x + y * y + z * z) - radius, [-radius] * 3, [radius] * 3)


def torus(major: float, minor: float) -> Solid:
    reach = [major + minor, major + minor, minor]
    return Solid(lambda x, y, z: np.hypot(np.hypot(x, y) - major, z) - minor, np.negative(reach), reach)


def capsule(a: Sequence[float], b: Sequence[float], radius: float) -> Solid:
    start, along = np.array(a, float), np.subtract(b, a).astype(float)

    def value(x: Array, y: Array, z: Array) -> Array:
        u, v, w = x - start[0], y - start[1], z - start[2]
        t = np.clip((u * along[0] + v * along[1] + w * along[2]) / (along @ along), 0, 1)
        return np.sqrt((u - t * along[0]) ** 2 + (v - t * along[1]) ** 2 + (w - t * along[2]) ** 2) - radius

    return Solid(value, np.minimum(a, b) - radius, np.maximum(a, b) + radius)


def tube(points: Sequence[Sequence[float]], radius: float) -> Solid:
    """All points nearer than a radius to straight lines through points."""
    return union([capsule(a, b, radius) for a, b in pairwise(points)])


def hull(faces: Sequence[tuple[Sequence[float], float]], low: Sequence[float], high: Sequence[float]) -> Solid:
    """Where n · p < offset for all pairs of a normal and an offset."""

    def value(x: Array, y: Array, z: Array) -> Array:
        return np.max([(n[0] * x + n[1] * y + n[2] * z - off) / math.hypot(*n) for n, off in faces], axis=0)

    return Solid(value, low, high)


def circle(radius: float) -> Solid:
    return Solid(lambda x, y, z: np.hypot(x, y) - radius, [-radius, -radius, 0], [radius, radius, 1])


def rectangle(x: float, y: float, radius: float = 0) -> Solid:
    value: Value = lambda u, v, w: slabs([abs(u) - x / 2 + radius, abs(v) - y / 2 + radius]) - radius
    return Solid(value, [-x / 2, -y / 2, 0], [x / 2, y / 2, 1])


def polygon(points: Sequence[Sequence[float]]) -> Solid:
    corners = np.array(points, float)

    def value(x: Array, y: Array, z: Array) -> Array:
        least = np.full(np.broadcast(x, y).shape, np.inf)
        inside = np.zeros(least.shape, bool)
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            d = b - a
            t = np.clip(((x - a[0]) * d[0] + (y - a[1]) * d[1]) / (d @ d), 0, 1)
            least = np.minimum(least, np.hypot(x - a[0] - t * d[0], y - a[1] - t * d[1]))
            if d[1] != 0:
                inside ^= ((a[1] <= y) != (b[1] <= y)) & (x < a[0] + (y - a[1]) * d[0] / d[1])
        return np.where(inside, -least, least)

    return Solid(value, [*corners.min(axis=0), 0], [*corners.max(axis=0), 1])


def ngon(sides: int, radius: float) -> list[list[float]]:
    """The corners of a regular polygon, the first of them on the x axis."""
    return [[radius * math.cos(2 * PI * k / sides), radius * math.sin(2 * PI * k / sides)] for k in range(sides)]


def extrude(flat: Solid, height: float) -> Solid:
    value: Value = lambda x, y, z: slabs([flat.value(x, y, z), abs(z) - height / 2])
    return Solid(value, [*flat.low[:2], -height / 2], [*flat.high[:2], height / 2])


def revolve(points: Sequence[Sequence[float]]) -> Solid:
    """A polygon of radii and heights, turned about the z axis."""
    mirrored = [[-r, h] for r, h in reversed(points) if r > 0]
    flat = polygon([*points, *mirrored] if points[0][0] == 0 or points[-1][0] == 0 else points)
    reach = flat.high[0]
    value: Value = lambda x, y, z: flat.value(np.hypot(x, y), z, z)
    return Solid(value, [-reach, -reach, flat.low[1]], [reach, reach, flat.high[1]])


# Combinations and placements.


def union(solids: Sequence[Solid]) -> Solid:
    whole = solids[0]
    for solid in solids[1:]:
        whole = whole | solid
    return whole


def smooth_union(a: Solid, b: Solid, radius: float) -> Solid:
    """The polynomial smooth minimum of I. Quilez: min(a, b) − h² / (4 radius), h = max(radius − |a − b|, 0)."""

    def value(x: Array, y: Array, z: Array) -> Array:
        u, v = a.value(x, y, z), b.value(x, y, z)
        return np.minimum(u, v) - np.maximum(radius - abs(u - v), 0) ** 2 / (4 * radius)

    return Solid(value, np.minimum(a.low, b.low) - radius / 4, np.maximum(a.high, b.high) + radius / 4)


def smooth_difference(a: Solid, b: Solid, radius: float) -> Solid:
    def value(x: Array, y: Array, z: Array) -> Array:
        u, v = a.value(x, y, z), -b.value(x, y, z)
        return np.maximum(u, v) + np.maximum(radius - abs(u - v), 0) ** 2 / (4 * radius)

    return Solid(value, a.low, a.high)


def move(solid: Solid, x: float, y: float, z: float = 0) -> Solid:
    by = np.array([x, y, z], float)
    return Solid(lambda u, v, w: solid.value(u - x, v - y, w - z), solid.low + by, solid.high + by)


def turned(solid: Solid, matrix: Sequence[Sequence[float]]) -> Solid:
    """The solid after a rotation or mirroring by an orthogonal matrix."""
    m = np.array(matrix, float)

    def value(x: Array, y: Array, z: Array) -> Array:
        return solid.value(*(m[0, k] * x + m[1, k] * y + m[2, k] * z for k in range(3)))

    ends = m[:, :, None] * np.stack([solid.low, solid.high], axis=-1)[None]
    return Solid(value, ends.min(axis=2).sum(axis=1), ends.max(axis=2).sum(axis=1))


def rotate_x(solid: Solid, degrees: float) -> Solid:
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return turned(solid, [[1, 0, 0], [0, c, -s], [0, s, c]])


def rotate_y(solid: Solid, degrees: float) -> Solid:
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return turned(solid, [[c, 0, s], [0, 1, 0], [-s, 0, c]])


def rotate_z(solid: Solid, degrees: float) -> Solid:
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return turned(solid, [[c, -s, 0], [s, c, 0], [0, 0, 1]])


def polar(solid: Solid, count: int) -> Solid:
    return union([rotate_z(solid, 360 * k / count) for k in range(count)])


def linear(solid: Solid, count: int, x: float, y: float = 0, z: float = 0) -> Solid:
    return union([move(solid, k * x, k * y, k * z) for k in range(count)])


# Integrals by sampling: one random point in each cell of a lattice, so the error falls with its surface cells alone.


def sampled(solid: Solid, counts: Array, cell: Array, measure: float, seed: int) -> Estimate:
    """Counts cells along three axes, sampled a layer of z at a time; the error is that of pairs of neighbours along x."""
    random = np.random.default_rng(seed)
    n_x, n_y, n_z = (int(n) for n in counts)
    inside, changes = 0, 0
    for k in range(n_z):
        jitter = random.random((3, n_x, n_y))
        x = solid.low[0] + (np.arange(n_x)[:, None] + jitter[0]) * cell[0]
        y = solid.low[1] + (np.arange(n_y)[None, :] + jitter[1]) * cell[1]
        z = solid.low[2] + (k + jitter[2]) * cell[2]
        hit = solid.value(x, y, z) < 0
        inside += int(hit.sum())
        changes += int((hit[: n_x // 2 * 2 : 2] != hit[1::2]).sum())
    return Estimate(inside * measure, math.sqrt(changes) * measure)


def volume_of(solid: Solid, points: float = 6e6) -> Estimate:
    """The volume of a solid."""
    size = solid.high - solid.low
    counts = np.maximum(np.round(size / np.cbrt(size.prod() / points)), 8)
    cell = size / counts
    return sampled(solid, counts, cell, cell.prod(), 1)


def area_of(flat: Solid, points: float = 4e6) -> Estimate:
    """The area of a shape of the plane."""
    size = (flat.high - flat.low)[:2]
    counts = np.round(size / math.sqrt(size.prod() / points))
    cell = size / counts
    return sampled(flat, np.array([*counts, 1]), np.array([*cell, 1]), cell.prod(), 2)


# Closed forms.


def disc(radius: float) -> float:
    return PI * radius * radius


def ball(radius: float) -> float:
    return 4 / 3 * PI * radius**3


def frustum(bottom: float, top: float, height: float) -> float:
    """A cone between two radii."""
    return PI * height * (bottom * bottom + bottom * top + top * top) / 3


def ball_cap(radius: float, height: float) -> float:
    """What a plane cuts off a ball, this high."""
    return PI * height * height * (3 * radius - height) / 3


def circular_segment(radius: float, distance: float) -> float:
    """What a line at this distance from its centre cuts off a disc."""
    return radius * radius * math.acos(distance / radius) - distance * math.sqrt(radius * radius - distance * distance)


def lens(a: float, b: float, distance: float) -> float:
    """What two discs have in common."""
    x = (distance * distance + a * a - b * b) / (2 * distance)
    return circular_segment(a, x) + circular_segment(b, distance - x)


def regular(sides: int, radius: float) -> float:
    """A regular polygon with its corners at this radius."""
    return sides * radius * radius * math.sin(2 * PI / sides) / 2


def shoelace(points: Sequence[Sequence[float]]) -> float:
    """A polygon's area."""
    p = np.array(points, float)
    q = np.roll(p, -1, axis=0)
    return abs(float((p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum())) / 2


def lathe(points: Sequence[Sequence[float]]) -> float:
    """A polygon of radii and heights turned about the axis (Pappus): 2π times its first moment."""
    p = np.array(points, float)
    q = np.roll(p, -1, axis=0)
    cross = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    return 2 * PI * abs(float(((p[:, 0] + q[:, 0]) * cross).sum())) / 6


def round_rectangle(x: float, y: float, radius: float) -> float:
    return x * y - (4 - PI) * radius * radius


def round_box(x: float, y: float, z: float, radius: float) -> float:
    """A box of these full sizes with round edges and corners (Steiner)."""
    a, b, c = x - 2 * radius, y - 2 * radius, z - 2 * radius
    return a * b * c + 2 * radius * (a * b + b * c + c * a) + disc(radius) * (a + b + c) + ball(radius)


def ring_torus(major: float, minor: float) -> float:
    return 2 * PI * PI * major * minor * minor


def fillet_ring(radius: float, fillet: float) -> float:
    """A quarter-circle fillet around a boss of this radius on a plate (Pappus)."""
    return 2 * PI * (radius * (1 - PI / 4) * fillet**2 + (5 / 6 - PI / 4) * fillet**3)


def metric(major: float, pitch: float, clearance: float = 0) -> float:
    """The cross-section of a metric thread (ISO 68-1): crests P/8, roots P/4 wide, flanks at 60° to each other.

    Each section is the same shape, turned; along an angle the profile runs through one pitch, so the mean of r²/2 over it
    times 2π is the area. On a flank that of r² is (R² + R r + r²) / 3.
    """
    depth = 5 / 8 * math.sqrt(3) / 2 * pitch
    high, low = major / 2 - clearance, major / 2 - depth - clearance
    crest = pitch / 8 - 2 * clearance / math.sqrt(3)
    flanks = 2 * depth / math.sqrt(3)
    root = pitch - crest - flanks
    return PI / pitch * (high * high * crest + low * low * root + (high * high + high * low + low * low) / 3 * flanks)
