"""`FieldSamples`: the values of a field on a lattice that nobody holds: they are computed where they are read, and boxes in
which intervals prove that there is no surface are not read at all.
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

#: So many samples along each axis tell a field from another. Chosen.
_LOOKED_AT = 8
#: How many points a field is asked for at once. Chosen: enough for numpy and for networks, a megabyte or so.
_BATCH = 16_384
#: By what share a length is taken to be longer, when its steps are counted: rounding of a sum and of a quotient, and room.
_ROUNDING = 2.0**-40


@dataclass(frozen=True)
class FieldSamples:
    """An array whose samples are a field's values at the points of a lattice."""

    field: Field
    #: Where the first sample is, and the step along each axis.
    origin: tuple[float, float, float]
    steps: tuple[float, float, float]
    shape: Index

    @staticmethod
    def of(field: Field, steps: Sequence[float], origin: Sequence[float] | None) -> FieldSamples:
        """The lattice over the box of a field, with a cell around it. Where the field is cut off at a box it has as many whole
        steps as are in that."""
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
        # A length that is so many steps but for rounding is that many.
        whole = [math.floor(n * (1 + _ROUNDING)) if cut is not None else math.ceil(n) + room for n in lengths]
        i, j, k = (n + 1 for n in whole)
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
        # The points of all would take three times the memory of the values. Each call has as many, since the last digits of
        # a network depend on that, and blocks that share a point are to have the same value there.
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
        """What tells it from others, for a folder of results."""
        steps = [slice(None, None, max(1, n // _LOOKED_AT)) for n in self.shape]
        known = self[steps[0], steps[1], steps[2]].tobytes()
        # How it was made, where that can be written down: of a function its name.
        with contextlib.suppress(Exception):
            known += pickle.dumps(self.field)
        return f"{self.field!r} {self.origin} {self.steps} {hashlib.sha256(known).hexdigest()}"

    def crosses(self, blocks: Sequence[Block], surface: Surface) -> list[bool]:
        """For each block whether it may have triangles. Of a field whose ranges rest on somebody's word all may have some,
        since bounds of what is made do not tell of that."""
        import numpy as np

        if self.field.evidence != "proved":
            return [True] * len(blocks)
        corners = np.empty((len(blocks), 2, 3))
        for end, at in enumerate(("low", "high")):
            index = np.array([getattr(block, at) for block in blocks]).reshape(-1, 3)
            # As the samples between are: rounding keeps their order.
            corners[:, end] = np.stack([self._along(k, index[:, k]) for k in range(3)], axis=1)
        ends = np.frombuffer(self.field._value.ranges(corners.tobytes())).reshape(-1, 2)
        low, high = ends[:, 1] < surface.iso, ends[:, 0] > surface.iso
        filled, empty = (low, high) if surface.inside == "low" else (high, low)
        if surface.capped:
            # What is filled up to the end of the lattice is closed there.
            filled = filled & ~np.array([self._is_at_an_end(block) for block in blocks], dtype=bool)
        found: list[bool] = (~(filled | empty)).tolist()
        return found

    def _along(self, axis: int, index: NDArray[Any]) -> NDArray[np.float64]:
        found: NDArray[np.float64] = index * self.steps[axis] + self.origin[axis]
        return found

    def _is_at_an_end(self, block: Block) -> bool:
        ends = zip(block.low, block.high, self.shape, strict=True)
        return any(low == 0 or high == n - 1 for low, high, n in ends)


def crossed(array: Any, blocks: Sequence[Block], surface: Surface) -> list[Block]:
    """The blocks of an array that may have triangles, of many at once where it is a field; of samples nobody knows it."""
    if not isinstance(array, FieldSamples):
        return list(blocks)
    found: list[Block] = []
    for first in range(0, len(blocks), _AT_ONCE):
        some = blocks[first : first + _AT_ONCE]
        found += [block for block, is_crossed in zip(some, array.crosses(some, surface), strict=True) if is_crossed]
    return found


#: Boxes whose ranges are computed at once. Chosen: a megabyte or so of numbers.
_AT_ONCE = 16_384
