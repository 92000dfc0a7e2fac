"""Functions of points that users give: asked once whether they are such functions, and called with arrays."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from chordal._arguments import warn
from chordal._devices import wants_tensors, with_arrays

#: Points where a function is asked for its values. Chosen: of these some are inside a ball of a quarter of the box.
_N_TRIED = 64
#: Roberts' sequence, whose points are spread evenly: powers of 1 over the root of x⁴ = x + 1. Source:
#: https://extremelearning.com.au/unreasonable-effectiveness-of-quasirandom-sequences/
_STEPS = (0.8191725133961645, 0.6710436067037893, 0.5497004779019703)
#: What is said of a function that only knows inside from outside.
_OCCUPANCY = (
    "nothing says where between two points its surface is, and a mesh needs very many: take its samples on a lattice, as in "
    "chordal.volume(inside, spacing=…).surface(smooth=\"1vox\").mesh()"
)


def try_at_points(function: Callable[..., Any], box: Sequence[Sequence[float]] | None) -> None:
    """Asks a function for two points at once, so that one that takes a single point is known at once, and for some more, to know
    one that has two values alone. What it raises here
    it raises again where it is used, and to whoever waits for that.
    """
    import numpy as np

    try:
        inspect.signature(function).bind(None)
    except TypeError as error:
        raise TypeError(
            f"what: a function of one array of points, n × 3, as in lambda p: p[:, 0] ** 2 + p[:, 1] ** 2 - 1: {error}"
        ) from None
    except ValueError:
        pass
    low, high = ((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)) if box is None else box
    ends = np.array([low, high]) if np.isfinite([low, high]).all() else np.array([[-1.0] * 3, [1.0] * 3])
    # Not at the ends or in the middle, where many functions have no derivative.
    points = ends[0] + np.array([[0.25], [0.625]]) * (ends[1] - ends[0])
    try:
        given = function(points)
        found = np.shape(given)
    except Exception as error:
        if wants_tensors(function, points):
            told = str(error).splitlines()[0]
            raise TypeError(f"what: {told}; with like=torch.empty(0), say, it is called with tensors like that one") from error
        return
    if found not in ((2,), (2, 1)):
        raise ValueError(
            f"the function gave back {found} for 2 points, n × 3; it is to give one number for each, as "
            "numpy.linalg.norm(p, axis=1) does"
        )
    if getattr(given, "dtype", None) == bool:  # noqa: E721 (a dtype equals its type, and is not it)
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
    """The function of the bytes of points, which gives back the bytes of an array of one of these shapes, turned if need be."""
    called = with_arrays(function, like)

    def values(asked: bytes) -> bytes:
        import numpy as np

        points = np.frombuffer(asked).reshape(-1, 3)
        given = called(points)
        if np.iscomplexobj(given):
            raise TypeError(f"the {name} gave back complex numbers")
        found = np.ascontiguousarray(given, dtype=np.float64)
        if found.shape not in shapes(len(points)):
            raise ValueError(f"the {name} gave back {found.shape} for {len(points)} points")
        return (found if turned is None else np.ascontiguousarray(turned(found))).tobytes()

    return values


@dataclass(frozen=True)
class Sided:
    """Where the surface of a function is, and on which side of that its inside."""

    level: float
    is_high: bool

    def value(self, found: Any) -> Any:
        """The values of a function, with the surface at 0 and negative inside."""
        return self.level - found if self.is_high else found - self.level

    def slope(self, found: Any) -> Any:
        """The same for derivatives."""
        return -found if self.is_high else found


def warn_of_complement(values: Callable[[bytes], bytes], box: Sequence[Sequence[float]]) -> None:
    """Says it where a function seems to be positive inside: it is negative all around its box and positive somewhere within,
    so that the shape is the box without what was meant. What it raises it raises again where it is used.
    """
    import numpy as np

    low, high = (np.asarray(end) for end in box)
    # Two of the three coordinates of Roberts' points, on each side of the box; and within it.
    inner = np.modf(np.outer(np.arange(1, _N_TRIED + 1), _STEPS))[0]
    sides = [np.insert(inner[: _N_TRIED // 4, :2], axis, end, axis=1) for axis in range(3) for end in (0.0, 1.0)]
    corners = np.indices((2, 2, 2)).reshape(3, -1).T.astype(float)
    outer = np.vstack([*sides, corners])
    points = low + np.vstack([outer, inner]) * (high - low)
    try:
        found = np.frombuffer(values(np.ascontiguousarray(points).tobytes()))
    except Exception:
        return
    around, within = found[: len(outer)], found[len(outer) :]
    if np.all(around < 0) and np.any(within > 0):
        warn(
            "what: the function is negative all around its bounds and positive within them, so that the shape is the box without "
            "what is in it, for negative is inside; where the function is positive inside, say inside='high'"
        )
