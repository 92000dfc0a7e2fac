"""`LevelFiles`: `<label>.index`, the list of a label's levels, and `<label>`, their fragments, as Neuroglancer reads them.

Source: Neuroglancer, *Precomputed mesh format*, multi-resolution, unsharded.
"""

from __future__ import annotations

import math
import os
import struct
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

from chordal._blockwise.cubes import WORTH_IT, Cube, Cubes
from chordal._blockwise.folder import KeptFolder, left_over, written
from chordal._blockwise.packing import unpacked
from chordal._blockwise.tasks import Index
from chordal._bound import Bound


@dataclass(frozen=True)
class MeshLevel:
    """A level of a label's mesh, as `BlockVolume.precomputed_levels` wrote it."""

    #: How far its triangles are from the label's true surface, as the file has them.
    bound: Bound
    #: Its triangles.
    triangles: int
    #: How many fragments they are in.
    fragments: int


class Fragment(NamedTuple):
    """A label in a cube: what is known of its fragment."""

    label: int
    #: The length by which its part is simplified next, and the triangles of the part.
    length: float
    n_faces: int
    #: Those of the fragment, where some are cut.
    triangles: int
    at_most: float
    #: The eighths of the cube that have triangles, as bits.
    octants: int
    #: The bytes of the fragment.
    size: int


def fragments_of(cube: Cube) -> str:
    """The name under which the fragments of a cube are kept."""
    return f"{cube.kept}_fragments"


class LevelFiles:
    """The levels of each label, and their files, by what is known of each cube of each level."""

    def __init__(self, cubes: Cubes, found: Sequence[Mapping[Cube, Sequence[Fragment]]]) -> None:
        self._cubes: Final = cubes
        #: For each label and level the places of its fragments, along a Z-curve.
        self.by_label: Final[dict[int, list[dict[Index, Fragment]]]] = {}
        self._order: Final = [sorted(level, key=lambda cube: _on_curve(cube.place)) for level in found]
        for level, places in enumerate(self._order):
            for cube in places:
                for one in found[level][cube]:
                    levels = self.by_label.setdefault(one.label, [])
                    if len(levels) == level:
                        levels.append({})
                    levels[level][cube.place] = one
        for levels in self.by_label.values():
            while len(levels) > 1 and len(levels[-2]) == 1 and _n_faces(levels[-1]) > WORTH_IT * _n_faces(levels[-2]):
                levels.pop()

    def write(self, target: str, kept: KeptFolder, affine: Sequence[Sequence[float]]) -> None:
        """The files of all labels: first those of fragments, which are read cube by cube."""
        step = least_step(affine)
        for path in left_over(target):
            os.unlink(path)
        for level, places in enumerate(self._order):
            for cube in places:
                facts, arrays = unpacked(kept.whole(fragments_of(cube), self._cubes.named(cube)))
                for row, content in zip(facts["fragments"], arrays, strict=True):
                    if level < len(self.by_label[row[0]]):
                        with open(_aside(target, row[0]), "ab") as file:
                            file.write(content)
        for label in sorted(self.by_label):
            with open(_aside(target, label), "rb+") as file:
                os.fsync(file.fileno())
            os.replace(_aside(target, label), os.path.join(target, f"{label}"))
            written(os.path.join(target, f"{label}.index"), self._index(label, step))

    def _index(self, label: int, step: float) -> bytes:
        """The list of a label's levels and fragments."""
        levels = [{place: one.size for place, one in level.items()} for level in self.by_label[label]]
        for level in range(1, len(levels)):
            for place in _without_child(self.by_label[label][level], levels[level - 1]):
                # Nothing is there at the finer level. Said so, it takes the place of what the coarser level has there.
                levels[level - 1][place] = 0
        rows = [sorted(level.items(), key=lambda item: _on_curve(item[0])) for level in levels]
        n = len(rows)
        parts = [struct.pack("<3f3fI", *self._cubes.sides, 0.0, 0.0, 0.0, n)]
        parts.append(struct.pack(f"<{n}f", *self._scales(label, step)))
        parts.append(struct.pack(f"<{3 * n}f", *[0.0] * (3 * n)))
        parts.append(struct.pack(f"<{n}I", *map(len, rows)))
        for row in rows:
            for axis in range(3):
                parts.append(struct.pack(f"<{len(row)}I", *(place[axis] for place, _ in row)))
            parts.append(struct.pack(f"<{len(row)}I", *(size for _, size in row)))
        return b"".join(parts)

    def _scales(self, label: int, step: float) -> list[float]:
        """The error of each level in units of the lattice: a viewer shows it where that is a pixel, or what it is set to. Each
        is above the one before in single precision."""
        scales: list[float] = []
        for level in self.by_label[label]:
            least = _single_up(max(one.at_most for one in level.values()) / step)
            scales.append(max(least, _single_up(math.nextafter(scales[-1], math.inf))) if scales else least)
        return scales

    def facts(self) -> dict[int, tuple[MeshLevel, ...]]:
        """What is said of each label."""
        return {label: tuple(map(_fact, self.by_label[label])) for label in sorted(self.by_label)}


def _fact(level: Mapping[Index, Fragment]) -> MeshLevel:
    at_most = max(one.at_most for one in level.values())
    bound = Bound(0.0, at_most, "proved", "hausdorff", "trilinear interpolant")
    return MeshLevel(bound, sum(one.triangles for one in level.values()), len(level))


def _n_faces(level: Mapping[Index, Fragment]) -> int:
    return sum(one.n_faces for one in level.values())


def _aside(target: str, label: int) -> str:
    """The name of a label's fragments while they are written."""
    return os.path.join(target, f".chordal-{label}.tmp")


def _without_child(level: Mapping[Index, Fragment], below: Iterable[Index]) -> Iterator[Index]:
    """The eighths of fragments that have triangles, while no fragment is there at the level below."""
    known = set(below)
    for (i, j, k), one in level.items():
        for eighth in range(8):
            place = (2 * i + (eighth & 1), 2 * j + (eighth >> 1 & 1), 2 * k + (eighth >> 2))
            if one.octants >> eighth & 1 and place not in known:
                yield place


def _on_curve(place: Index) -> int:
    """Where a place is on a Z-curve: the bits of its indices by turns, that of i the lowest."""
    at = 0
    for bit in range(max(place).bit_length()):
        for axis in range(3):
            at |= (place[axis] >> bit & 1) << (3 * bit + axis)
    return at


def least_step(affine: Sequence[Sequence[float]]) -> float:
    """The least length that the longest of the lattice's steps seems to have, seen from any direction; no more than it.

    A viewer takes the longest for the size of a cell on the screen. Let G be the matrix of the steps' scalar products, with
    the eigenvalues a ≥ b ≥ c. Of three lengths the largest squared is at least a third of the sum of all squared, which
    seen along one direction is less by at most a: it is at least (b + c) / 3, and for cubes no more than that. By the sum of
    eigenvalues being 1, b + c = 1 - a ≥ (1 - b) (b + c) = (a + c) (b + c) ≥ ab + bc + ca."""
    steps = [[row[k] for row in affine] for k in range(3)]
    products = [[sum(x * y for x, y in zip(u, v, strict=True)) for v in steps] for u in steps]
    total = products[0][0] + products[1][1] + products[2][2]
    g = [[x / total for x in row] for row in products]
    minors = sum(g[i][i] * g[j][j] - g[i][j] * g[j][i] for i, j in ((0, 1), (0, 2), (1, 2)))
    for _ in range(_SQUARED):
        g = [[sum(g[i][k] * g[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    # No eigenvalue is above the root of the sum of powers of all.
    largest = g[0][0] + g[1][1] + g[2][2]
    for _ in range(_SQUARED):
        largest = math.sqrt(largest)
    rest = max(1.0 - largest - _SLACK, minors * (1.0 - _SLACK))
    return math.sqrt(total * rest / 3) * (1.0 - _SLACK)


#: How often the matrix in `least_step` is squared: so the root of a sum of three equal powers is 3.5 % too large. Chosen.
_SQUARED = 5
#: Room for some hundred roundings of numbers up to 1 in `least_step`. Derived, and then some.
_SLACK = 2.0**-40


def _single_up(x: float) -> float:
    """The least number of single precision that is not below."""
    (nearest,) = struct.unpack("<f", struct.pack("<f", x))
    if nearest >= x:
        return float(nearest)
    (bits,) = struct.unpack("<I", struct.pack("<f", nearest))
    (above,) = struct.unpack("<f", struct.pack("<I", bits + 1))
    return float(above)
