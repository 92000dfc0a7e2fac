"""Points of the surface of a solid: between two points of opposite sign, on its leaves, and where leaves meet."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .ranges import Array
from .words import Function, Solid

Flags = npt.NDArray[np.bool_]
#: Operations on numbers that a lattice may cost: about a second of numpy.
WORK = 3e8
#: Steps along a side of the lattice at most and at least.
FINEST, COARSEST = 96, 20
#: Halvings of a way between two signs: below a unit in the last place of what is left.
HALVINGS = 56
#: Newton's steps onto leaves; from nearby five are enough, and what has not come is dropped.
STEPS = 12
#: A lattice whose planes lie on no plane of a script with round numbers; the golden ratio's digits.
SHIFT = np.array([0.618033988749895, 0.381966011250105, 0.236067977499790])


def box_of(solid: Solid) -> tuple[Array, Array]:
    """The solid's box, grown by a hundredth so that the surface lies within it."""
    low, high = solid.bounds
    assert np.isfinite(low).all() and np.isfinite(high).all(), "a solid without end has no mesh"
    slack = 0.01 * float((high - low).max())
    return low - slack, high + slack


def inside(solid: Solid, points: Array) -> Flags:
    """Whether points are inside, in batches that fit the caches."""
    parts = [solid.at(part) < 0 for part in np.array_split(points, max(1, len(points) >> 15))]
    return np.concatenate(parts) if parts else np.zeros(0, bool)


def bracketed(solid: Solid, start: Array, end: Array) -> Array:
    """A point of the surface between each two points of opposite sign, to rounding."""
    first = inside(solid, start)
    for _ in range(HALVINGS):
        middle = 0.5 * (start + end)
        same = (inside(solid, middle) == first)[:, None]
        start, end = np.where(same, middle, start), np.where(same, end, middle)
    return 0.5 * (start + end)


def on_lattice(solid: Solid, work: float = WORK) -> Array:
    """Crossings of the edges of a lattice."""
    low, high = box_of(solid)
    steps = int(np.clip((work / solid.weight) ** (1 / 3), COARSEST, FINEST))
    # One side for all axes, so that flat solids are seen as finely as long ones.
    side = float((high - low).max()) / steps
    counts = np.ceil((high - low) / side).astype(int) + 2
    axes = [low[k] + side * (np.arange(counts[k]) - SHIFT[k]) for k in range(3)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    sign = inside(solid, points.reshape(-1, 3)).reshape(points.shape[:3])
    starts, ends = [], []
    for k in range(3):
        here = tuple(slice(0, -1) if i == k else slice(None) for i in range(3))
        there = tuple(slice(1, None) if i == k else slice(None) for i in range(3))
        differ = sign[here] != sign[there]
        starts.append(points[here][differ])
        ends.append(points[there][differ])
    return bracketed(solid, np.concatenate(starts), np.concatenate(ends))


def on_lines(solid: Solid, random: np.random.Generator, count: int) -> Array:
    """Crossings of random lines through the box."""
    low, high = box_of(solid)
    steps = 64
    a, b = (random.uniform(low, high, (count, 3)) for _ in range(2))
    t = np.linspace(0, 1, steps)[None, :, None]
    points = a[:, None, :] + t * (b - a)[:, None, :]
    sign = inside(solid, points.reshape(-1, 3)).reshape(count, steps)
    line, k = np.nonzero(sign[:, 1:] != sign[:, :-1])
    return bracketed(solid, points[line, k], points[line, k + 1])


def value_of(leaf: Function, points: Array) -> Array:
    """The values of one leaf."""
    with np.errstate(all="ignore"):
        value = leaf(points[:, 0], points[:, 1], points[:, 2])
    return np.broadcast_to(np.asarray(value, np.float64), len(points)).copy()


def slope_of(leaf: Function, points: Array, step: float) -> Array:
    """The gradient of a leaf by differences."""
    columns = []
    for k in range(3):
        by = np.zeros(3)
        by[k] = step
        columns.append((value_of(leaf, points + by) - value_of(leaf, points - by)) / (2 * step))
    return np.stack(columns, axis=1)


def on_leaves(solid: Solid, random: np.random.Generator, count: int, together: int) -> tuple[Array, float]:
    """Points of the surface at which so many leaves vanish together, and how far off they may be.

    Seeds are thrown into the box and led onto the leaves by Newton's steps of least length. What has both signs
    about it, within the distance that is returned, is on the surface. So walls, rims and corners are found that no
    lattice is fine enough for.
    """
    low, high = box_of(solid)
    extent = float((high - low).max())
    near, step = 1e-8 * extent, 1e-6 * extent
    found: list[Array] = [np.zeros((0, 3))]
    if len(solid.leaves) < together:
        return found[0], near
    rounds = min(24, max(1, len(solid.leaves) * 2)) if together == 1 else 24
    for _ in range(rounds):
        chosen = random.choice(len(solid.leaves), together, replace=False)
        leaves = [solid.leaves[k] for k in chosen]
        points = random.uniform(low, high, (max(8, count // rounds), 3))
        for _ in range(STEPS):
            values = np.stack([value_of(leaf, points) for leaf in leaves], axis=1)
            slopes = np.stack([slope_of(leaf, points, step) for leaf in leaves], axis=1)
            inverse = np.linalg.pinv(np.nan_to_num(slopes, posinf=0.0, neginf=0.0), rcond=1e-9)
            move = -np.einsum("nij,nj->ni", inverse, np.nan_to_num(values, posinf=0.0, neginf=0.0))
            size = np.sqrt((move * move).sum(axis=1, keepdims=True))
            points = points + move * np.minimum(1.0, 0.25 * extent / np.maximum(size, 1e-300))
        points = points[((points >= low) & (points <= high)).all(axis=1)]
        if len(points):
            slopes = np.stack([slope_of(leaf, points, step) for leaf in leaves], axis=1)
            found.append(points[has_both_signs(solid, points, slopes, near)])
    return np.concatenate(found), near


def has_both_signs(solid: Solid, points: Array, slopes: Array, near: float) -> Flags:
    """Whether there are points inside and outside within `near` of each point, one tried in each sector of its leaves.

    The point itself has no say: on faces that coincide it may be on either side by rounding.
    """
    n = slopes.shape[1]
    inverse = np.linalg.pinv(np.nan_to_num(slopes, posinf=0.0, neginf=0.0), rcond=1e-9)
    n_inside = np.zeros(len(points), int)
    for k in range(2**n):
        side = np.array([1.0 if k >> i & 1 else -1.0 for i in range(n)])
        way = np.einsum("nij,j->ni", inverse, side)
        size = np.sqrt((way * way).sum(axis=1, keepdims=True))
        n_inside += inside(solid, points + way / np.maximum(size, 1e-300) * (0.99 * near))
    return np.asarray((n_inside > 0) & (n_inside < 2**n), np.bool_)


def samples(solid: Solid, seed: int, count: int = 4000, work: float = WORK) -> tuple[Array, float]:
    """Points of the surface of all kinds, and how far from it they may be at most."""
    random = np.random.default_rng(seed)
    found = [on_lattice(solid, work), on_lines(solid, random, count // 4)]
    near = 0.0
    for together in (1, 2, 3):
        points, near = on_leaves(solid, random, count, together)
        found.append(points)
    return np.concatenate(found), near
