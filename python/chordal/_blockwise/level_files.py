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

    #: The distance of its triangles, as stored in the file, from the label's true surface.
    bound: Bound
    #: The number of its triangles.
    triangles: int
    #: The number of its fragments.
    fragments: int


class Fragment(NamedTuple):
    """The fragment of a label in a cube."""

    label: int
    #: The tolerance of the next simplification of its part, and the number of the part's triangles.
    length: float
    n_faces: int
    #: The number of triangles in the fragment, where some of the part's are cut.
    triangles: int
    at_most: float
    #: The octants of the cube that have triangles, as bits.
    octants: int
    #: The bytes of the fragment.
    size: int


def fragments_of(cube: Cube) -> str:
    """The name under which the fragments of a cube are kept."""
    return f"{cube.kept}_fragments"


class LevelFiles:
    """The levels of each label, and their files, from the fragments in each cube of each level."""

    def __init__(self, cubes: Cubes, fragments: Sequence[Mapping[Cube, Sequence[Fragment]]]) -> None:
        self._cubes: Final = cubes
        #: For each label and level, the fragments by their places, along a Z-curve.
        self.by_label: Final[dict[int, list[dict[Index, Fragment]]]] = {}
        self._order: Final = [sorted(level, key=lambda cube: _on_curve(cube.place)) for level in fragments]
        for level, sorted_cubes in enumerate(self._order):
            for cube in sorted_cubes:
                for fragment in fragments[level][cube]:
                    levels = self.by_label.setdefault(fragment.label, [])
                    if len(levels) == level:
                        levels.append({})
                    levels[level][cube.place] = fragment
        # A coarsest level that saves few triangles over a single finer fragment is dropped.
        for levels in self.by_label.values():
            while len(levels) > 1 and len(levels[-2]) == 1 and _n_faces(levels[-1]) > WORTH_IT * _n_faces(levels[-2]):
                levels.pop()

    def write(self, target: str, kept: KeptFolder, affine: Sequence[Sequence[float]]) -> None:
        """Writes the files of all labels. Fragments are kept by cube, so they are appended to the files of their labels first."""
        step = least_step(affine)
        for path in left_over(target):
            os.unlink(path)
        for level, sorted_cubes in enumerate(self._order):
            for cube in sorted_cubes:
                facts, arrays = unpacked(kept.whole(fragments_of(cube), self._cubes.named(cube)))
                for row, content in zip(facts["fragments"], arrays, strict=True):
                    # A coarsest level that was dropped above is not written.
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
        levels = [{place: fragment.size for place, fragment in level.items()} for level in self.by_label[label]]
        for level in range(1, len(levels)):
            for place in _without_child(self.by_label[label][level], levels[level - 1]):
                # The finer level has no fragment here. An empty one tells viewers so: they show it in place of the coarser level.
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
        """The error of each level in units of the lattice. A viewer shows a level where its error is about a pixel, or as many
        as it is set to. Errors increase from level to level, also in single precision."""
        scales: list[float] = []
        for level in self.by_label[label]:
            least = _single_up(max(fragment.at_most for fragment in level.values()) / step)
            scales.append(max(least, _single_up(math.nextafter(scales[-1], math.inf))) if scales else least)
        return scales

    def facts(self) -> dict[int, tuple[MeshLevel, ...]]:
        """The levels of each label, as they are returned."""
        return {label: tuple(map(_fact, self.by_label[label])) for label in sorted(self.by_label)}


def _fact(level: Mapping[Index, Fragment]) -> MeshLevel:
    at_most = max(fragment.at_most for fragment in level.values())
    bound = Bound(0.0, at_most, "proved", "hausdorff", "trilinear interpolant")
    return MeshLevel(bound, sum(fragment.triangles for fragment in level.values()), len(level))


def _n_faces(level: Mapping[Index, Fragment]) -> int:
    return sum(fragment.n_faces for fragment in level.values())


def _aside(target: str, label: int) -> str:
    """The path of a label's fragments while they are being written."""
    return os.path.join(target, f".chordal-{label}.tmp")


def _without_child(level: Mapping[Index, Fragment], below: Iterable[Index]) -> Iterator[Index]:
    """The octants of fragments that have triangles, but no fragment at the level below."""
    finer = set(below)
    for (i, j, k), fragment in level.items():
        for octant in range(8):
            place = (2 * i + (octant & 1), 2 * j + (octant >> 1 & 1), 2 * k + (octant >> 2))
            if fragment.octants >> octant & 1 and place not in finer:
                yield place


def _on_curve(place: Index) -> int:
    """The position of a place on a Z-curve (its Morton code): the bits of its indices interleaved, that of i the lowest."""
    code = 0
    for bit in range(max(place).bit_length()):
        for axis in range(3):
            code |= (place[axis] >> bit & 1) << (3 * bit + axis)
    return code


def least_step(affine: Sequence[Sequence[float]]) -> float:
    """A lower bound of the apparent length of the lattice's longest step, seen from any direction.

    A viewer takes the longest projected step for the size of a cell on the screen. Let G be the matrix of the steps' scalar
    products, with the eigenvalues a ≥ b ≥ c. The largest of three squared lengths is at least a third of their sum, and a
    projection along a direction reduces the sum by at most a. So the square is at least (b + c) / 3, with equality for
    cubes. With eigenvalues scaled to a sum of 1, b + c = 1 - a ≥ (1 - b) (b + c) = (a + c) (b + c) ≥ ab + bc + ca."""
    steps = [[row[k] for row in affine] for k in range(3)]
    products = [[sum(x * y for x, y in zip(u, v, strict=True)) for v in steps] for u in steps]
    total = products[0][0] + products[1][1] + products[2][2]
    g = [[x / total for x in row] for row in products]
    minors = sum(g[i][i] * g[j][j] - g[i][j] * g[j][i] for i, j in ((0, 1), (0, 2), (1, 2)))
    for _ in range(_SQUARED):
        g = [[sum(g[i][k] * g[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    # The trace of a power of G is the sum of powers of its eigenvalues, so its root is an upper bound of the largest.
    largest = g[0][0] + g[1][1] + g[2][2]
    for _ in range(_SQUARED):
        largest = math.sqrt(largest)
    # `1 - largest` loses its digits if the largest is nearly 1. The minors, ab + bc + ca, are less but keep theirs.
    rest = max(1.0 - largest - _SLACK, minors * (1.0 - _SLACK))
    return math.sqrt(total * rest / 3) * (1.0 - _SLACK)


#: How often the matrix in `least_step` is squared. Chosen: the root of a sum of three equal powers is then 3.5 % too large.
_SQUARED = 5
#: Room for the roundings in `least_step`. Derived: some hundred roundings of numbers up to 1, and a margin.
_SLACK = 2.0**-40


def _single_up(x: float) -> float:
    """The smallest number in single precision that is not below `x`."""
    (nearest,) = struct.unpack("<f", struct.pack("<f", x))
    if nearest >= x:
        return float(nearest)
    (bits,) = struct.unpack("<I", struct.pack("<f", nearest))
    (above,) = struct.unpack("<f", struct.pack("<I", bits + 1))
    return float(above)
