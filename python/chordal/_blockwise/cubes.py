"""`Cubes`: the blocks of a volume, eights of these, and so on to one: what parts of a surface are joined in."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

from chordal._blockwise.tasks import Block, Index, named

#: The most triangles of a part, about: parts that together have twice as many get coarser before they are joined. As in
#: the levels of a mesh in memory.
MOST = 65_536
#: Coarser triangles that are more than this fraction of those that they replace are not taken. As there.
WORTH_IT = 0.8
#: How often parts get coarser before they are joined all the same: where their borders alone are too many. Chosen.
MOST_TRIES = 6
#: The coarsest part has about so many triangles at most. As in the levels of a mesh in memory.
ENOUGH = 64
#: The first error beyond the finest, where nobody says one and triangles are exact, as a fraction of a cell. Chosen.
FIRST = 0.25


@dataclass(frozen=True)
class Cube:
    """A block, or eight times eight … of them: its level, and its place among those of the level."""

    level: int
    place: Index

    @property
    def name(self) -> str:
        return f"{self.level}/{'_'.join(map(str, self.place))}"

    @property
    def kept(self) -> str:
        """The name of its result in a folder."""
        return self.name.replace("/", "_")

    def child(self, corner: Index) -> Cube:
        i, j, k = (2 * at + offset for at, offset in zip(self.place, corner, strict=True))
        return Cube(self.level - 1, (i, j, k))

    @property
    def parent(self) -> Cube:
        i, j, k = (at // 2 for at in self.place)
        return Cube(self.level + 1, (i, j, k))


@dataclass(frozen=True)
class Cubes:
    """Those of a lattice. Levels beyond the root have one cube each, larger than the lattice."""

    #: The samples of the lattice along each axis.
    shape: Index
    #: The cells of a block along each axis.
    sides: Index

    def root(self) -> Cube:
        level = 0
        while any(n > 1 for n in self.counts(level)):
            level += 1
        return Cube(level, (0, 0, 0))

    def n_below(self, root: Cube) -> int:
        """How many cubes there are, with the root."""
        return sum(math.prod(self.counts(level)) for level in range(root.level + 1))

    def counts(self, level: int) -> Index:
        """How many cubes a level has along each axis."""
        sizes = zip(self.shape, self.sides, strict=True)
        i, j, k = (-(-(n - 1) // (side << level)) for n, side in sizes)
        return i, j, k

    def of_level(self, level: int) -> Iterator[Cube]:
        """All of a level, in the order of the array."""
        for i, j, k in product(*map(range, self.counts(level))):
            yield Cube(level, (i, j, k))

    def children(self, cube: Cube) -> Iterator[Cube]:
        """The cubes of one, in the order of the array."""
        counts = self.counts(cube.level - 1)
        for corner in product((0, 1), repeat=3):
            child = cube.child((corner[0], corner[1], corner[2]))
            if all(at < n for at, n in zip(child.place, counts, strict=True)):
                yield child

    def sides_of(self, cube: Cube) -> Index:
        """The cells of a cube along each axis, also where the lattice ends before."""
        i, j, k = (side << cube.level for side in self.sides)
        return i, j, k

    def low(self, cube: Cube) -> Index:
        """The index of its first sample."""
        i, j, k = (at * side for at, side in zip(cube.place, self.sides_of(cube), strict=True))
        return i, j, k

    def block(self, cube: Cube) -> Block:
        """Its samples."""
        low = self.low(cube)
        sizes = zip(low, self.sides_of(cube), self.shape, strict=True)
        i, j, k = (min(at + side, n - 1) for at, side, n in sizes)
        return Block(low, (i, j, k))

    def named(self, cube: Cube) -> str:
        """A cube, as messages call it."""
        block = self.block(cube)
        return named(block) if cube.level == 0 else f"the cube of blocks from {block.low} to {block.high}"
