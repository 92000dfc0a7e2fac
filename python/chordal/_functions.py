"""Functions of points from users: checked once with a few points, and called with arrays."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from chordal._arguments import warn
from chordal._devices import wants_tensors, with_arrays

#: The points at which a function is tried. Chosen: some of them are inside a ball with a quarter of the box's size.
_N_TRIED = 64
#: Roberts' quasirandom sequence, whose points are spread evenly: powers of 1 over the root of x⁴ = x + 1. Source:
#: https://extremelearning.com.au/unreasonable-effectiveness-of-quasirandom-sequences/
_STEPS = (0.8191725133961645, 0.6710436067037893, 0.5497004779019703)
#: The hint for a function that only distinguishes inside from outside.
_OCCUPANCY = (
    "nothing says where between two points its surface is, and a mesh needs very many: take its samples on a lattice, as in "
    "chordal.volume(inside, spacing=…).surface(smooth=\"1vox\").mesh()"
)


def try_at_points(function: Callable[..., Any], box: Sequence[Sequence[float]] | None) -> None:
    """Calls a function with two points, to detect one that takes a single point, and with some more, to detect one that has only
    two values. Exceptions of the function are ignored here: it raises them again when it is used.
    """
    import numpy as np

    try:
        inspect.signature(function).bind(None)
    except TypeError as error:
        raise TypeError(
            f"what: a function of one array of points, n × 3, as in lambda p: p[:, 0] ** 2 + p[:, 1] ** 2 - 1: {error}"
        ) from None
    # Some compiled functions do not tell their parameters.
    except ValueError:
        pass
    low, high = ((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)) if box is None else box
    ends = np.array([low, high]) if np.isfinite([low, high]).all() else np.array([[-1.0] * 3, [1.0] * 3])
    # Neither the ends nor the middle, where many functions have no derivative.
    points = ends[0] + np.array([[0.25], [0.625]]) * (ends[1] - ends[0])
    try:
        result = function(points)
        shape = np.shape(result)
    except Exception as error:
        if wants_tensors(function, points):
            message = str(error).splitlines()[0]
            raise TypeError(f"what: {message}; with like=torch.empty(0), say, it is called with tensors like that one") from error
        # Left to the calls that mesh the shape, which report it.
        return
    if shape not in ((2,), (2, 1)):
        raise ValueError(
            f"the function gave back {shape} for 2 points, n × 3; it is to give one number for each, as "
            "numpy.linalg.norm(p, axis=1) does"
        )
    if getattr(result, "dtype", None) == bool:  # noqa: E721 (a dtype equals its type, and is not it)
        raise TypeError(f"what: the function gave back truth values; {_OCCUPANCY}")
    spread = ends[0] + np.modf(np.outer(np.arange(1, _N_TRIED + 1), _STEPS))[0] * (ends[1] - ends[0])
    try:
        values = np.unique(np.ravel(np.asarray(function(spread))))
    except Exception:
        return
    if values.dtype.kind in "fiu" and len(values) == 2 and values[0] < 0 < values[1]:
        warn(f"what: the function has two values alone, as it seems; {_OCCUPANCY}")


def of_bytes(
    function: Callable[..., Any],
    name: str,
    shapes: Callable[[int], tuple[tuple[int, ...], ...]],
    like: Any | None,
    turned: Callable[[Any], Any] | None = None,
) -> Callable[[bytes], bytes]:
    """A function from the bytes of points to the bytes of an array with one of some shapes, for which `turned` may change the
    sign or the level.
    """
    called = with_arrays(function, like)

    def values(point_bytes: bytes) -> bytes:
        import numpy as np

        points = np.frombuffer(point_bytes).reshape(-1, 3)
        result = called(points)
        if np.iscomplexobj(result):
            raise TypeError(f"the {name} gave back complex numbers")
        array = np.ascontiguousarray(result, dtype=np.float64)
        if array.shape not in shapes(len(points)):
            raise ValueError(f"the {name} gave back {array.shape} for {len(points)} points")
        return (array if turned is None else np.ascontiguousarray(turned(array))).tobytes()

    return values


@dataclass(frozen=True)
class Sided:
    """The level of a function's surface, and the side of it that is inside."""

    level: float
    is_high: bool

    def value(self, values: Any) -> Any:
        """The values of the function, converted to a surface at 0 and negative inside."""
        return self.level - values if self.is_high else values - self.level

    def slope(self, derivatives: Any) -> Any:
        """The same for derivatives."""
        return -derivatives if self.is_high else derivatives


def warn_of_complement(values: Callable[[bytes], bytes], box: Sequence[Sequence[float]]) -> None:
    """Warns of a function that seems to be positive inside: if it is negative all around its box and positive somewhere within,
    the shape is the complement of the intended one. Exceptions are ignored: the function raises them again when it is used.
    """
    import numpy as np

    low, high = (np.asarray(end) for end in box)
    # Points within the box; and on each of its sides, with two of the three coordinates of Roberts' points.
    inner = np.modf(np.outer(np.arange(1, _N_TRIED + 1), _STEPS))[0]
    sides = [np.insert(inner[: _N_TRIED // 4, :2], axis, end, axis=1) for axis in range(3) for end in (0.0, 1.0)]
    corners = np.indices((2, 2, 2)).reshape(3, -1).T.astype(float)
    outer = np.vstack([*sides, corners])
    points = low + np.vstack([outer, inner]) * (high - low)
    try:
        samples = np.frombuffer(values(np.ascontiguousarray(points).tobytes()))
    except Exception:
        return
    around, within = samples[: len(outer)], samples[len(outer) :]
    if np.all(around < 0) and np.any(within > 0):
        warn(
            "what: the function is negative all around its bounds and positive within them, so that the shape is the box without "
            "what is in it, for negative is inside; where the function is positive inside, say inside='high'"
        )
