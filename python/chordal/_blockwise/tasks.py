"""The tasks of workers: reading a block of samples, meshing it, and simplifying the triangles of one or several blocks."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from chordal import _chordal
from chordal._array_to_volume import volume
from chordal._blockwise.packing import packed, unpacked
from chordal._errors import Error

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: The distance by which rounding to single precision moves a point, in units of the sum of its absolute coordinates: half a
#: unit in the last place of each, twice.
ROUNDING = 2.0**-23
#: Three numbers, as of an index.
Index = tuple[int, int, int]


@dataclass(frozen=True)
class Block:
    """A box of samples from `low` to `high`, both included; neighbouring blocks share the samples at their ends."""

    #: The index of its first sample along i, j and k.
    low: Index
    #: The index of its last sample.
    high: Index

    @property
    def slices(self) -> tuple[slice, slice, slice]:
        """The slices of the array with its samples."""
        i, j, k = (slice(low, high + 1) for low, high in zip(self.low, self.high, strict=True))
        return i, j, k

    def around(self, shape: Index) -> Block:
        """The block extended by one sample on each side, within the array."""
        low = [max(at - 1, 0) for at in self.low]
        high = [min(at + 1, n - 1) for at, n in zip(self.high, shape, strict=True)]
        return Block((low[0], low[1], low[2]), (high[0], high[1], high[2]))


@dataclass(frozen=True)
class Surface:
    """A surface of a volume: all that another process needs except the samples."""

    affine: tuple[tuple[float, ...], ...]
    shape: Index
    iso: float
    inside: str
    capped: bool
    #: The largest bound that a block should have, a share of the tolerance of the whole.
    wanted: float | None = None
    #: Whether vertices have normals, along the gradient of the samples.
    normals: bool = False

    def arguments(self, block: Block, offset: Index) -> _chordal.BlockArguments:
        """The arguments for a block whose samples begin at the index `offset`."""
        ends = [
            [self.capped and low == 0, self.capped and high + 1 == n]
            for low, high, n in zip(block.low, block.high, self.shape, strict=True)
        ]
        return {
            "iso": self.iso,
            "inside": self.inside,
            "capped": ends,
            "offset": list(offset),
            "affine": [list(row) for row in self.affine],
            "wanted": self.wanted,
        }

    def place(self, block: Block) -> _chordal.BoxArguments:
        """The box of a block, and the sides on which it has neighbours."""
        sides = zip(block.low, block.high, self.shape, strict=True)
        goes_on = [[low > 0, high + 1 < n] for low, high, n in sides]
        return {"low": list(block.low), "high": list(block.high), "goes_on": goes_on}

    def extent(self) -> float:
        """About the diagonal of the bounding box of the lattice."""
        sizes = [n - 1 for n in self.shape]
        return math.hypot(*(sum(abs(row[k]) * sizes[k] for k in range(3)) for row in self.affine))

    def farthest(self) -> float:
        """An upper bound of the sum of absolute coordinates, for all points of the lattice."""
        sizes = [n - 1 for n in self.shape]
        return sum(sum(abs(a) * n for a, n in zip(row, sizes, strict=False)) + abs(row[3]) for row in self.affine)

    def cell(self) -> float:
        """The shortest edge of a cell."""
        return min(math.hypot(*(row[k] for row in self.affine)) for k in range(3))

    def plan(self, sides: Index, source: str) -> dict[str, Any]:
        """The plan of a folder of results: the options that its results depend on."""
        return {
            "version": _chordal.VERSION,
            "source": source,
            "shape": list(self.shape),
            "affine": [list(row) for row in self.affine],
            "iso": self.iso,
            "inside": self.inside,
            "capped": self.capped,
            "normals": self.normals,
            "sides": list(sides),
        }


def read(array: Any, block: Block) -> NDArray[Any]:
    """The samples of a block."""
    import numpy as np

    try:
        samples: NDArray[Any] = np.asanyarray(array[block.slices])
    except Exception as error:
        raise Error(f"{named(block)} cannot be read: {error}") from error
    expected = tuple(high - low + 1 for low, high in zip(block.low, block.high, strict=True))
    if samples.shape != expected:
        raise Error(f"{named(block)} has {samples.shape} samples, not {expected}")
    return samples


def samples_of(array: Any, block: Block) -> _chordal.Source:
    """The samples of a block as a volume."""
    return volume(read(array, block))._source


def labelled(array: Any, block: Block) -> tuple[_chordal.Source, NDArray[Any] | None]:
    """The labels of a block as a volume. Labels beyond 32 bits are replaced by their ranks among the labels of the block, and
    the sorted labels are returned, too."""
    import numpy as np

    samples = read(array, block)
    is_long = samples.dtype.kind in "iu" and samples.dtype.itemsize == 8 and samples.size > 0
    if not is_long or (samples.min() >= 0 and samples.max() < 2**32):
        return volume(samples)._source, None
    if samples.min() < 0:
        raise Error(f"{named(block)} has the label {samples.min()}: labels are from 0 on")
    # Label 0, the background, is appended so that it is always there and has rank 0.
    names, ranks = np.unique(np.append(samples.ravel(), samples.dtype.type(0)), return_inverse=True)
    return volume(ranks.ravel()[:-1].reshape(samples.shape).astype(np.uint32))._source, names


def label_named(label: int, names: NDArray[Any] | None) -> int:
    """The label with a rank."""
    return label if names is None else int(names[label])


def named(block: Block) -> str:
    """The name of a block in messages."""
    return f"the block at {block.low}"


def meshed_block(surface: Surface, array: Any, block: Block) -> _chordal.Block:
    """The triangles of a block, with the keys by which vertices are matched exactly with those of its neighbours."""
    return _chordal.block(samples_of(array, block), surface.arguments(block, block.low))


def mesh_block(surface: Surface, array: Any, block: Block) -> bytes:
    """The result of `meshed_block` as bytes."""
    arrays, bound = meshed_block(surface, array, block).state()
    return packed({"bound": bound}, arrays)


def block_of(content: bytes) -> _chordal.Block:
    """Unpacks the bytes of `mesh_block`."""
    facts, arrays = unpacked(content)
    bound = facts["bound"]
    return _chordal.Block.of_state(arrays, None if bound is None else (bound[0], bound[1], bound[2]))


def mesh_labels(surface: Surface, only: frozenset[int] | None, array: Any, block: Block) -> bytes:
    """The triangles of each label of a block but 0, or of those in `only`, as bytes."""
    samples, names = labelled(array, block)
    labels: list[int] = []
    blocks: list[bytes] = []
    for rank, label_block in _chordal.label_blocks(samples, surface.arguments(block, block.low)):
        label = label_named(rank, names)
        if only is None or label in only:
            arrays, bound = label_block.state()
            labels.append(label)
            blocks.append(packed({"bound": bound}, arrays))
    return packed({"labels": labels}, blocks)


def labels_of(content: bytes) -> list[tuple[int, bytes]]:
    """Unpacks the bytes of `mesh_labels`: each label with the bytes of its block."""
    facts, arrays = unpacked(content)
    return list(zip(facts["labels"], arrays, strict=True))


def part_of_block(surface: Surface, array: Any, block: Block) -> _chordal.BlockPart | None:
    """The triangles of a block as a part that can be simplified; None if it has none."""
    arguments, place = surface.arguments(block, block.low), surface.place(block)
    if not surface.normals:
        return _chordal.part(samples_of(array, block), arguments, place, None)
    # Normals also need the samples around the block. Triangles and their bound are those of the block alone, since the
    # triangles beyond it belong to other parts.
    around = block.around(surface.shape)
    samples = read(array, around)
    ranges = zip(block.low, block.high, around.low, strict=True)
    inner = tuple(slice(low - first, high - first + 1) for low, high, first in ranges)
    beside = (volume(samples)._source, surface.arguments(block, around.low))
    return _chordal.part(volume(samples[inner])._source, arguments, place, beside)


def simplified_block(surface: Surface, tolerance: float, array: Any, block: Block) -> bytes:
    """The triangles of a block, simplified within a tolerance of its surface if the room allows it, as bytes."""
    part = part_of_block(surface, array, block)
    if part is not None and part.at_most < tolerance:
        part = part.simplified(tolerance - part.at_most)
    return packed_part(part)


def packed_part(part: _chordal.BlockPart | None) -> bytes:
    """A part as bytes."""
    if part is None:
        return packed({"bound": None}, [])
    content, bound = part.state()
    return packed({"bound": bound}, [content])


def part_of(content: bytes) -> _chordal.BlockPart | None:
    """Unpacks the bytes of `packed_part`."""
    facts, arrays = unpacked(content)
    bound = facts["bound"]
    return None if bound is None else _chordal.BlockPart.of_state(arrays[0], (bound[0], bound[1], bound[2]))
