"""`FieldSamples`: the values of a field on a lattice, which are computed when they are read. Boxes in which intervals prove
that there is no surface are not read at all.
"""

from __future__ import annotations

import contextlib
import hashlib
import math
import pickle
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from chordal import _chordal
from chordal._blockwise.tasks import Block, Index, Surface
from chordal._field import Field

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

#: The samples along each axis that identify a field. Chosen: more tell similar fields apart more often, and cost more time
#: before the first block.
_N_IDENTIFYING = 8
#: The points that a field is evaluated at in one call. Chosen: enough for numpy and for networks, about a megabyte.
_BATCH = 16_384
#: The share by which a length is extended before its steps are counted: the rounding of a sum and of a quotient, and room.
_ROUNDING = 2.0**-40


@dataclass(frozen=True)
class FieldSamples:
    """An array whose samples are a field's values at the points of a lattice."""

    field: Field
    #: The position of the first sample, and the step along each axis.
    origin: tuple[float, float, float]
    steps: tuple[float, float, float]
    shape: Index

    @staticmethod
    def of(field: Field, steps: Sequence[float], origin: Sequence[float] | None) -> FieldSamples:
        """The lattice over the box of a field, with a margin of a cell. If the field is cut off at a box, the lattice has as many
        whole steps as fit in it."""
        cut = _chordal.region_of(field._source)
        low, high = field.bounds if cut is None else cut
        if not all(map(math.isfinite, (*low, *high))):
            raise ValueError("field: its box is not known; say it, as in field.within((-1, -1, -1), (1, 1, 1))")
        room = 1 if cut is None else 0
        first = [a - room * step for a, step in zip(low, steps, strict=True)] if origin is None else origin
        if cut is not None and any(a < b for a, b in zip(first, low, strict=True)):
            raise ValueError(f"origin: in the box that the field is cut off at, which begins at {tuple(low)}")
        if any(a >= b for a, b in zip(first, high, strict=True)):
            raise ValueError(f"origin: below the highest corner of the field's box, {tuple(high)}")
        lengths = [(b - a) / step for a, b, step in zip(first, high, steps, strict=True)]
        # A length that is a whole number of steps but for rounding counts as that number.
        n_steps = [math.floor(n * (1 + _ROUNDING)) if cut is not None else math.ceil(n) + room for n in lengths]
        i, j, k = (n + 1 for n in n_steps)
        (x, y, z), (dx, dy, dz) = first, steps
        return FieldSamples(field, (x, y, z), (dx, dy, dz), (i, j, k))

    @property
    def dtype(self) -> np.dtype[Any]:
        """Double precision."""
        import numpy as np

        return np.dtype(np.float64)

    def __getitem__(self, places: tuple[slice, slice, slice]) -> NDArray[np.float64]:
        import numpy as np

        indices = [np.arange(*place.indices(n)) for place, n in zip(places, self.shape, strict=True)]
        xs, ys, zs = (self._along(k, index) for k, index in enumerate(indices))
        # In batches, since all points would take three times the memory of the values. All batches have the same size: the last
        # digits of a network's values depend on it, and blocks that share a point need the same value there.
        values = np.empty(len(xs) * len(ys) * len(zs))
        points = np.zeros((_BATCH, 3))
        for first in range(0, len(values), _BATCH):
            at = np.arange(first, min(first + _BATCH, len(values)))
            row, k = np.divmod(at, len(zs))
            i, j = np.divmod(row, len(ys))
            points[: len(at), 0], points[: len(at), 1], points[: len(at), 2] = xs[i], ys[j], zs[k]
            points[len(at) :] = points[0]
            values[at] = self.field(points)[: len(at)]
        return values.reshape(len(xs), len(ys), len(zs))

    def source(self) -> str:
        """A text that identifies the samples, for a folder of results."""
        steps = [slice(None, None, max(1, n // _N_IDENTIFYING)) for n in self.shape]
        identity = self[steps[0], steps[1], steps[2]].tobytes()
        # The recipe of the field, if it can be pickled; a function is pickled by its name.
        with contextlib.suppress(Exception):
            identity += pickle.dumps(self.field)
        return f"{self.field!r} {self.origin} {self.steps} {hashlib.sha256(identity).hexdigest()}"

    def crosses(self, blocks: Sequence[Block], surface: Surface) -> list[bool]:
        """For each block, whether it may have triangles. For a field whose ranges rest on a promise, every block may have some:
        the bound of the result would not state that assumption."""
        import numpy as np

        if self.field.evidence != "proved":
            return [True] * len(blocks)
        corners = np.empty((len(blocks), 2, 3))
        for end, at in enumerate(("low", "high")):
            index = np.array([getattr(block, at) for block in blocks]).reshape(-1, 3)
            # Computed as the positions of samples are: rounding is monotone, so no sample lies outside.
            corners[:, end] = np.stack([self._along(k, index[:, k]) for k in range(3)], axis=1)
        ends = np.frombuffer(self.field._value.ranges(corners.tobytes())).reshape(-1, 2)
        low, high = ends[:, 1] < surface.iso, ends[:, 0] > surface.iso
        filled, empty = (low, high) if surface.inside == "low" else (high, low)
        if surface.capped:
            # A filled block at the end of the lattice gets the triangles that close the surface there.
            filled = filled & ~np.array([self._is_at_an_end(block) for block in blocks], dtype=bool)
        crosses: list[bool] = (~(filled | empty)).tolist()
        return crosses

    def _along(self, axis: int, index: NDArray[Any]) -> NDArray[np.float64]:
        """The coordinates of samples along an axis."""
        positions: NDArray[np.float64] = index * self.steps[axis] + self.origin[axis]
        return positions

    def _is_at_an_end(self, block: Block) -> bool:
        ends = zip(block.low, block.high, self.shape, strict=True)
        return any(low == 0 or high == n - 1 for low, high, n in ends)


def crossed(array: Any, blocks: Sequence[Block], surface: Surface) -> list[Block]:
    """The blocks of an array that may have triangles: for stored samples all of them, since that is unknown before they are
    read."""
    if not isinstance(array, FieldSamples):
        return list(blocks)
    crossed_blocks: list[Block] = []
    for first in range(0, len(blocks), _AT_ONCE):
        batch = blocks[first : first + _AT_ONCE]
        crossed_blocks += [block for block, crosses in zip(batch, array.crosses(batch, surface), strict=True) if crosses]
    return crossed_blocks


#: Boxes whose ranges are computed at once. Chosen: a megabyte or so of numbers.
_AT_ONCE = 16_384
