"""`Cubes`: the blocks of a volume, cubes of eight blocks, and so on up to a single one: an octree in which parts are joined."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

from chordal._blockwise.tasks import Block, Index, named

#: About the most triangles of a part: parts that together have more than twice as many are simplified before they are joined.
#: Chosen as for the levels of a mesh in memory.
MOST = 65_536
#: A simplified part replaces the finer one if it has at most this fraction of its triangles. Chosen as for the levels of a mesh.
WORTH_IT = 0.8
#: How often parts are simplified before they are joined even if they are too large, as when their borders alone, which are
#: kept, have too many triangles. Chosen: each try doubles the tolerance, so more would coarsen the parts without need.
MOST_TRIES = 6
#: About the most triangles of the coarsest part. Chosen as for the levels of a mesh in memory.
ENOUGH = 64
#: The tolerance of the first coarser level if the finest is exact, as a fraction of a cell. Chosen: smaller values add levels
#: that save few triangles, larger ones leave a gap between the levels.
FIRST = 0.25


@dataclass(frozen=True)
class Cube:
    """A block (level 0), or a cube of eight cubes of the level below: its level, and its place within the level."""

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
    """The cubes of a lattice. Levels above the root have one cube each, larger than the lattice."""

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
        """The number of cubes, including the root."""
        return sum(math.prod(self.counts(level)) for level in range(root.level + 1))

    def counts(self, level: int) -> Index:
        """The number of cubes of a level along each axis."""
        # Rounded up, of n − 1 cells between n samples.
        sizes = zip(self.shape, self.sides, strict=True)
        i, j, k = (-(-(n - 1) // (side << level)) for n, side in sizes)
        return i, j, k

    def of_level(self, level: int) -> Iterator[Cube]:
        """All cubes of a level, in the order of the array."""
        for i, j, k in product(*map(range, self.counts(level))):
            yield Cube(level, (i, j, k))

    def children(self, cube: Cube) -> Iterator[Cube]:
        """The children of a cube, in the order of the array."""
        counts = self.counts(cube.level - 1)
        for corner in product((0, 1), repeat=3):
            child = cube.child((corner[0], corner[1], corner[2]))
            if all(at < n for at, n in zip(child.place, counts, strict=True)):
                yield child

    def sides_of(self, cube: Cube) -> Index:
        """The cells of a cube along each axis, including those beyond the end of the lattice."""
        i, j, k = (side << cube.level for side in self.sides)
        return i, j, k

    def low(self, cube: Cube) -> Index:
        """The index of its first sample."""
        i, j, k = (at * side for at, side in zip(cube.place, self.sides_of(cube), strict=True))
        return i, j, k

    def block(self, cube: Cube) -> Block:
        """The samples of a cube, within the lattice."""
        low = self.low(cube)
        sizes = zip(low, self.sides_of(cube), self.shape, strict=True)
        # Inclusive: the last layer of samples is also the first of the next block.
        i, j, k = (min(at + side, n - 1) for at, side, n in sizes)
        return Block(low, (i, j, k))

    def named(self, cube: Cube) -> str:
        """The name of a cube in messages."""
        block = self.block(cube)
        return named(block) if cube.level == 0 else f"the cube of blocks from {block.low} to {block.high}"
