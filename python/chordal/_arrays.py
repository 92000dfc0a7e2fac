"""Array arguments: converts anything that numpy accepts to arrays of our own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


def coordinates(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """A copy of finite numbers in double precision, in C order.

    Other number types, byte orders and memory layouts are converted. Raises `TypeError` for anything but an array of real
    numbers, and `ValueError` for numbers that are not finite or do not fit double precision. Both name the argument. All
    checks look at the copy, since another thread may write to the original.
    """
    import numpy as np

    try:
        array = np.asanyarray(value)
    except ValueError as error:
        raise ValueError(f"{name}: rows of different lengths are no array") from error
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: an array of real numbers, not of {array.dtype}")
    if isinstance(array, np.ma.MaskedArray) and np.any(array.mask):
        raise ValueError(f"{name}: some numbers are masked; fill them or leave their curves out")
    original = np.array(array, order="C", copy=True, subok=False)
    copied: NDArray[np.float64] = original.astype(np.float64, order="C", copy=False)
    if _can_lose(original.dtype):
        # What double precision holds comes back from it unchanged.
        with np.errstate(invalid="ignore"):
            same = np.array_equal(copied.astype(original.dtype), original, equal_nan=original.dtype.kind == "f")
        if not same:
            raise ValueError(f"{name}: double precision cannot hold all of these {original.dtype} numbers")
    # A sum is quick to compute and finite only if all numbers are. If it is not, it may still have overflowed.
    with np.errstate(over="ignore", invalid="ignore"):
        seems_finite = bool(np.isfinite(copied.sum()))
    bad = [] if seems_finite else np.argwhere(~np.isfinite(copied)).tolist()
    if len(bad):
        place = tuple(int(index) for index in bad[0])
        raise ValueError(f"{name}: the number at {place} is not finite: {copied[place]}")
    return copied


def indices(name: str, value: ArrayLike) -> NDArray[np.uint32]:
    """A copy of whole numbers from 0 on that fit 32 bits, in C order."""
    import numpy as np

    try:
        array = np.asanyarray(value)
    except ValueError as error:
        raise ValueError(f"{name}: rows of different lengths are no array") from error
    if array.size == 0:
        return np.zeros(array.shape if array.ndim == 2 else (0, 3), np.uint32)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name}: an array of whole numbers, not of {array.dtype}")
    if array.min() < 0 or array.max() > 2**32 - 1:
        bad = np.argwhere((array < 0) | (array > 2**32 - 1))
        place = tuple(int(index) for index in bad[0])
        raise ValueError(f"{name}: the number at {place} is no index: {array[place]}")
    # If another thread writes meanwhile, the copy has other numbers, but still numbers of 32 bits.
    return array.astype(np.uint32, order="C", copy=True, subok=False)


def as_asked(array: NDArray[Any], dtype: Any, copy: bool | None) -> NDArray[Any]:
    """An array with the type and the copy that a caller of `__array__` requests."""
    import numpy as np

    return np.array(array, dtype=dtype, copy=True) if copy else np.asarray(array, dtype=dtype)


def _can_lose(dtype: np.dtype[Any]) -> bool:
    """Whether double precision rounds some numbers of a type."""
    return dtype.itemsize > (8 if dtype.kind == "f" else 4)
