"""The verdict on a mesh that claims to be within a distance of the surface of a solid, in both directions."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from . import surface
from .mesh import Grid, Mesh, crossing_pairs, folded_edges, topology, true_distances, twins
from .ranges import Array
from .words import Solid

#: What rounding may move a point or a value by, as a share of the largest coordinate.
ROUNDING = 1e-12
#: How much farther than claimed counts: the rounding of distances themselves.
MARGIN = 1e-9
#: Pieces of a ball that ranges look at, for one point, before it is left undecided.
PIECES = 1 << 17
#: Points of triangles whose balls are searched by ranges at most; more than that fail for one reason.
MOST_PROOFS = 24
#: Directions of a search, and shares of the radius.
DIRECTIONS = 96
SHARES = (1.0, 0.5, 0.75, 0.25, 0.1, 0.02)


@dataclass
class Verdict:
    """What is wrong with a mesh, and what was looked at."""

    wrong: list[str] = field(default_factory=list)
    #: The largest distance from a point of the surface to the mesh.
    to_mesh: float = 0.0
    n_surface: int = 0
    n_mesh: int = 0
    #: Points of triangles near which neither a surface was found nor shown to be absent.
    undecided: int = 0

    def __str__(self) -> str:
        looked = f"{self.n_surface} points of the surface, at most {self.to_mesh:.6g} away; {self.n_mesh} of the mesh"
        return "; ".join([*self.wrong, looked, f"{self.undecided} undecided"])


def judge(solid: Solid, mesh: Mesh, at_most: float, seed: int = 1, work: float = surface.WORK) -> Verdict:
    """Everything that can be held against a mesh with a bound."""
    verdict = Verdict(faults_of(mesh))
    from_surface(solid, mesh, at_most, seed, verdict, work)
    from_mesh(solid, mesh, at_most, seed, verdict)
    against = turned_faces(solid, mesh, at_most)
    if against:
        verdict.wrong.append(f"{against} faces point inward")
    return verdict


def faults_of(mesh: Mesh) -> list[str]:
    """What can be held against a mesh whatever it stands for: that it is no closed manifold, or runs through itself."""
    wrong = topology(mesh)
    n_folded = 0 if wrong else folded_edges(mesh)
    if n_folded:
        wrong.append(f"the faces of {n_folded} edges lie on each other")
    n_crossing = len(crossing_pairs(mesh))
    if n_crossing:
        wrong.append(f"{n_crossing} pairs of triangles cross")
    return wrong


def crease_gap(mesh: Mesh, creases: Array, least_deg: float) -> float:
    """How far points of creases are at most from an edge of the mesh at which its faces turn by so many degrees."""
    start, end = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    across = mesh.normals() / np.sqrt((mesh.normals() ** 2).sum(axis=1, keepdims=True))
    face, other = np.arange(len(start)) // 3, twins(mesh) // 3
    sharp = (across[face] * across[other]).sum(axis=1) < np.cos(np.radians(least_deg))
    if not sharp.any():
        return float("inf")
    # An edge is a triangle without an inside.
    edges = Mesh(mesh.points, np.stack([start[sharp], end[sharp], end[sharp]], axis=1))
    return float(true_distances(edges, creases).max())


def from_surface(solid: Solid, mesh: Mesh, at_most: float, seed: int, verdict: Verdict, work: float) -> None:
    """Whether each point of the surface is near the mesh."""
    points, near = surface.samples(solid, seed, work=work)
    verdict.n_surface = len(points)
    allowed = at_most * (1 + MARGIN) + near + ROUNDING * mesh.size()
    distances = Grid(mesh, allowed * 1.001).distances(points)
    far = np.flatnonzero(distances > allowed)
    verdict.to_mesh = float(distances[distances <= allowed].max(initial=0.0))
    if len(far):
        few = far[np.linspace(0, len(far) - 1, min(len(far), 16)).astype(int)]
        true = true_distances(mesh, points[few])
        verdict.to_mesh = float(true.max())
        place = points[few[int(true.argmax())]]
        verdict.wrong.append(
            f"{len(far)} of {len(points)} points of the surface are farther than {at_most:.6g} from the mesh, "
            f"one at {place} by {verdict.to_mesh:.6g}"
        )


def mesh_samples(mesh: Mesh, random: np.random.Generator, count: int) -> Array:
    """Corners, middles of edges and points within; more of large faces, and of thin ones along their length."""
    a, b, c = mesh.corners()
    found = [mesh.points[np.unique(mesh.faces)], 0.5 * (a + b), (a + b + c) / 3]
    area = np.sqrt((mesh.normals() ** 2).sum(axis=1))
    longest = np.sqrt(np.maximum.reduce([((q - p) ** 2).sum(axis=1) for p, q in ((a, b), (b, c), (c, a))]))
    for weight in (area, longest):
        total = weight.sum()
        if total > 0:
            row = random.choice(len(weight), count, p=weight / total)
            u, v = random.uniform(0, 1, (2, count))
            flip = u + v > 1
            u, v = np.where(flip, 1 - u, u)[:, None], np.where(flip, 1 - v, v)[:, None]
            found.append(a[row] + u * (b[row] - a[row]) + v * (c[row] - a[row]))
    points = np.concatenate(found)
    if len(points) > 8 * count:
        points = points[random.choice(len(points), 8 * count, replace=False)]
    return points


def from_mesh(solid: Solid, mesh: Mesh, at_most: float, seed: int, verdict: Verdict) -> None:
    """Whether the surface is near each point of the mesh: a sign changes, or a value vanishes, within the distance."""
    random = np.random.default_rng(seed)
    count = int(np.clip(surface.WORK / (400 * solid.weight), 500, 6000))
    points = mesh_samples(mesh, random, count)
    verdict.n_mesh = len(points)
    left = points[~has_surface_near(solid, points, at_most)]
    if not len(left):
        return
    chosen = left[random.permutation(len(left))[:MOST_PROOFS]]
    found = [decide(solid, p, at_most * (1 + MARGIN)) for p in chosen]
    verdict.undecided += found.count(None)
    shown = [p for p, has_surface in zip(chosen, found, strict=True) if has_surface is False]
    if shown:
        value = float(solid.at(np.array([shown[0]]))[0])
        verdict.wrong.append(
            f"{len(shown)} of {len(chosen)} doubtful points of triangles ({len(left)} in all) have no surface "
            f"within {at_most:.6g}, one at {shown[0]}, where the value is {value:.6g}"
        )


def has_surface_near(solid: Solid, points: Array, reach: float) -> surface.Flags:
    """Whether a change of sign was found within a ball; a quick search, which may miss one."""
    values = solid.at(points)
    size = np.abs(points).max(initial=0.0)
    found: surface.Flags = np.abs(values) <= ROUNDING * size
    step = max(1e-4 * reach, 1e-9 * size)
    slope = surface.slope_of(solid.value, points, step)
    length = np.sqrt((slope * slope).sum(axis=1, keepdims=True))
    down = np.nan_to_num(-np.sign(values)[:, None] * slope / np.where(length > 0, length, 1.0))
    ways = [down]
    k = np.arange(DIRECTIONS) + 0.5
    # Spread evenly over the sphere along a spiral.
    polar, around = np.arccos(1 - 2 * k / DIRECTIONS), np.pi * (1 + 5**0.5) * k
    ways += list(np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=1))
    for way in ways:
        for share in SHARES:
            left = np.flatnonzero(~found)
            if not len(left):
                return found
            there = points[left] + (way[left] if way.ndim == 2 else way) * (share * reach)
            now = solid.at(there)
            found[left] = ((now < 0) != (values[left] < 0)) | (np.abs(now) <= ROUNDING * size)
    return found


def decide(solid: Solid, point: Array, reach: float) -> bool | None:
    """Whether a ball holds a change of sign, by ranges over smaller and smaller boxes; nothing where it stays open."""
    negative = bool(solid.at(point[None])[0] < 0)
    slack = ROUNDING * float(np.abs(point).max())
    centres, half = point[None].copy(), reach
    looked = 0
    corners = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    while len(centres):
        looked += len(centres)
        if looked > PIECES:
            return None
        values = solid.at(centres)
        off = np.sqrt(((centres - point) ** 2).sum(axis=1))
        if (((values < 0) != negative) | (np.abs(values) <= slack))[off <= reach].any():
            return True
        lo, hi = solid.over(centres - half, centres + half)
        clear = (hi < 0) if negative else (lo >= 0)
        open_boxes = centres[~clear]
        centres = (open_boxes[:, None, :] + half * corners).reshape(-1, 3)
        half *= 0.5
        nearest = np.maximum(np.abs(centres - point) - half, 0.0)
        centres = centres[np.sqrt((nearest**2).sum(axis=1)) <= reach]
    return False


def turned_faces(solid: Solid, mesh: Mesh, at_most: float) -> int:
    """Faces that surely point inward: along the normal from the middle lies the inside, against it the outside, and
    the values rise against it, at several distances beyond the bound and at several places of the face."""
    n = mesh.normals()
    length = np.sqrt((n * n).sum(axis=1))
    a, b, c = mesh.corners()
    # Of slivers the normal says nothing.
    longest = np.sqrt(np.maximum.reduce([((q - p) ** 2).sum(axis=1) for p, q in ((a, b), (b, c), (c, a))]))
    rows = np.flatnonzero(length > 4 * at_most * longest)
    rows = rows[:: max(1, int(len(rows) * solid.weight // 2_000_000))]
    if not len(rows):
        return 0
    unit = n[rows] / length[rows][:, None]
    a, b, c = a[rows], b[rows], c[rows]
    against = np.ones(len(rows), bool)
    for u, v, w in ((1, 1, 1), (6, 1, 1), (1, 6, 1), (1, 1, 6)):
        middle = (u * a + v * b + w * c) / (u + v + w)
        for share in (1.01, 1.5, 2.0, 3.0):
            by = unit * (share * at_most)
            ahead, behind = solid.at(middle + by), solid.at(middle - by)
            against &= (ahead < 0) & (behind > 0)
    return int(against.sum())
