"""Arrays that people pass: whatever numpy can read, as numbers in double precision of our own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


def coordinates(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """Finite numbers, copied in rows.

    Other number types, byte orders and memory layouts are converted. What is no array of real numbers is a
    `TypeError`; numbers that are not finite, or that double precision cannot hold, are a `ValueError`. Both name the
    argument. All checks look at the copy: another thread may be writing to the original.
    """
    import numpy as np

    try:
        found = np.asanyarray(value)
    except ValueError as error:
        raise ValueError(f"{name}: rows of different lengths are no array") from error
    if found.dtype.kind not in "fiu":
        raise TypeError(f"{name}: an array of real numbers, not of {found.dtype}")
    if isinstance(found, np.ma.MaskedArray) and np.any(found.mask):
        raise ValueError(f"{name}: some numbers are masked; fill them or leave their curves out")
    own = np.array(found, order="C", copy=True, subok=False)
    copied: NDArray[np.float64] = own.astype(np.float64, order="C", copy=False)
    if _can_lose(own.dtype):
        with np.errstate(invalid="ignore"):
            same = np.array_equal(copied.astype(own.dtype), own, equal_nan=own.dtype.kind == "f")
        if not same:
            raise ValueError(f"{name}: double precision cannot hold all of these {own.dtype} numbers")
    # A sum of finite numbers that overflows is found to be finite on the second look.
    with np.errstate(over="ignore", invalid="ignore"):
        seems_finite = bool(np.isfinite(copied.sum()))
    bad = [] if seems_finite else np.argwhere(~np.isfinite(copied)).tolist()
    if len(bad):
        place = tuple(int(index) for index in bad[0])
        raise ValueError(f"{name}: the number at {place} is not finite: {copied[place]}")
    return copied


def indices(name: str, value: ArrayLike) -> NDArray[np.uint32]:
    """Whole numbers from 0 on that 32 bits can hold, copied in rows."""
    import numpy as np

    try:
        found = np.asanyarray(value)
    except ValueError as error:
        raise ValueError(f"{name}: rows of different lengths are no array") from error
    if found.size == 0:
        return np.zeros(found.shape if found.ndim == 2 else (0, 3), np.uint32)
    if found.dtype.kind not in "iu":
        raise TypeError(f"{name}: an array of whole numbers, not of {found.dtype}")
    if found.min() < 0 or found.max() > 2**32 - 1:
        bad = np.argwhere((found < 0) | (found > 2**32 - 1))
        place = tuple(int(index) for index in bad[0])
        raise ValueError(f"{name}: the number at {place} is no index: {found[place]}")
    # Where another thread writes meanwhile, these are other numbers, and still 32 bits.
    return found.astype(np.uint32, order="C", copy=True, subok=False)


def as_asked(array: NDArray[Any], dtype: Any, copy: bool | None) -> NDArray[Any]:
    """An array as numpy's `__array__` is asked for it."""
    import numpy as np

    return np.array(array, dtype=dtype, copy=True) if copy else np.asarray(array, dtype=dtype)


def _can_lose(dtype: np.dtype[Any]) -> bool:
    """Whether there are numbers of this type that double precision rounds."""
    return dtype.itemsize > (8 if dtype.kind == "f" else 4)
