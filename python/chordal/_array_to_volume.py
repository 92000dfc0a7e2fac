"""`volume` and `labels`: samples on a lattice, from arrays and files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, SupportsFloat, SupportsIndex

from chordal import _chordal
from chordal._arguments import text
from chordal._arrays import coordinates
from chordal._errors import ReadError
from chordal._hints import keywords_hinted
from chordal._images import lattice_of
from chordal._load import load
from chordal._sourced import plain_reading
from chordal._volume import Volume

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_TYPES = {"u1": "uint8", "i1": "int8", "u2": "uint16", "i2": "int16", "u4": "uint32", "i4": "int32"}
_TYPES |= {"u8": "uint64", "i8": "int64", "f4": "float", "f8": "double", "b1": "uint8"}


@keywords_hinted
def volume(
    array: ArrayLike | str | os.PathLike[str] | Any,
    *,
    spacing: SupportsFloat | Sequence[SupportsFloat] | None = None,
    origin: Sequence[SupportsFloat] | None = None,
    affine: ArrayLike | None = None,
    unit: str | None = None,
) -> Volume:
    """A volume from an array of three axes: `array[i, j, k]` is the sample at x = i, y = j, z = k.

    `spacing` is the step along each axis, one number or three, and `origin` the position of the first sample. Or `affine`
    is the 4 × 4 matrix, or its first three rows, that maps (i, j, k, 1) to space. The samples are copied in their own
    type; 64-bit integers must fit in 32 bits. NaN is outside, and so are masked samples of a masked array of floats.

    `array` may also be a file, an image of nibabel, SimpleITK or PyVista, or a DataArray of xarray, which know the positions of
    their samples: nibabel in its own coordinates (right, front, head), SimpleITK in its own (left, back, head), both in
    millimetres.

    >>> import chordal, numpy
    >>> chordal.volume(numpy.eye(4)[:, :, None] * numpy.ones(4), spacing=2)
    <Volume: 4 × 4 × 4 of float64, spacing 2, 2, 2>
    """
    import numpy as np

    if isinstance(array, (str, os.PathLike)):
        return _of_file(array, spacing, origin, affine, unit)
    lattice = lattice_of(array)
    if lattice is not None:
        if affine is not None or spacing is not None or origin is not None:
            raise TypeError("spacing, origin, affine: this image says them already; pass its array to say others")
        array, affine, unit = lattice.array, lattice.affine, unit or lattice.unit
    samples = np.asanyarray(array)
    kind = f"{samples.dtype.kind}{samples.dtype.itemsize}"
    if samples.ndim != 3:
        hint = "; of several volumes take one, as in array[..., 0] or image.slicer[..., 0]" if samples.ndim > 3 else ""
        raise ValueError(f"array: three axes, not {samples.ndim}{hint}")
    if min(samples.shape) < 2:
        sizes = ", ".join(f"{size} along {axis}" for axis, size in zip("xyz", samples.shape, strict=True) if size < 2)
        raise ValueError(f"array: 2 samples or more along each axis, not {sizes}")
    if isinstance(samples, np.ma.MaskedArray):
        samples = _filled(samples)
    if kind == "f2":
        samples, kind = samples.astype(np.float32), "f4"
    if kind not in _TYPES:
        raise TypeError(f"array: samples are numbers of up to 64 bits, not {samples.dtype}")
    steps = steps_of(spacing, origin, affine)
    # `repr` writes the shortest digits that read back as the same number, so that the text of the header rounds nothing.
    vectors = [",".join(repr(float(number)) for number in row) for row in steps]
    header = "\n".join(
        [
            "NRRD0004",
            f"type: {_TYPES[kind]}",
            "dimension: 3",
            "space dimension: 3",
            "sizes: " + " ".join(map(str, samples.shape)),
            "space directions: " + " ".join(f"({row})" for row in vectors[:3]),
            "endian: little",
            "encoding: raw",
            f"space origin: ({vectors[3]})",
            "",
            "",
        ]
    )
    try:
        source = _chordal.Source(_with_samples(header, samples), plain_reading("nrrd", text("unit", unit)))
    except ReadError as error:
        # The place of the error is in the file that was written here, which the caller has never seen.
        raise ValueError(f"array: {error.message}") from None
    return Volume(source)


#: The rows that are transposed at once, so that they fit a cache. Measured on 256³ samples: a seventh of the time of a single
#: transposition.
_TURNED = 32


def _with_samples(header: str, samples: NDArray[Any]) -> bytes:
    """A header followed by the samples, x fastest and little-endian."""
    import numpy as np

    turned = np.empty(samples.shape[::-1], samples.dtype.newbyteorder("<"))
    for j in range(samples.shape[1]):
        for i in range(0, samples.shape[0], _TURNED):
            turned[:, j, i : i + _TURNED] = samples[i : i + _TURNED, j].T
    return b"".join([header.encode(), turned.data])


def _filled(masked: Any) -> Any:
    """The samples without a mask: masked ones become NaN, which is outside."""
    import numpy as np

    if not np.any(masked.mask):
        return masked.data
    if masked.dtype.kind != "f":
        raise ValueError(
            f"array: some samples are masked, and {masked.dtype} has no NaN for them; say what they are, as in "
            "array.filled(0), or take array.astype(float)"
        )
    return masked.filled(np.nan)


@keywords_hinted
def labels(
    array: ArrayLike | str | os.PathLike[str] | Any,
    *,
    spacing: SupportsFloat | Sequence[SupportsFloat] | None = None,
    origin: Sequence[SupportsFloat] | None = None,
    affine: ArrayLike | None = None,
    unit: str | None = None,
    only: Sequence[SupportsIndex] | SupportsIndex | None = None,
) -> Volume:
    """A volume of labels, each with its own surface: `volume(…)` with `surface(labels=…)`, for all labels but 0, or for one or
    several in `only`. Labels may be whole numbers stored as floats, as nibabel's `get_fdata` returns them.

    >>> import chordal, numpy
    >>> halves = numpy.ones((6, 6, 6), numpy.uint8)
    >>> halves[3:] = 2
    >>> [part.name for part in chordal.labels(halves).mesh().parts]
    ['label 1', 'label 2']
    """
    labelled = volume(array, spacing=spacing, origin=origin, affine=affine, unit=unit)
    return labelled.surface(labels="all" if only is None else only)


def _of_file(path: Any, spacing: Any, origin: Any, affine: Any, unit: str | None) -> Volume:
    shape = load(path, unit=unit)
    if not isinstance(shape, Volume):
        raise TypeError(f"array: {os.fspath(path)} holds {shape.kind}, not samples on a lattice: load it")
    if spacing is None and origin is None and affine is None:
        return shape
    return volume(shape.array, spacing=spacing, origin=origin, affine=affine, unit=unit)


def steps_of(spacing: Any, origin: Any, affine: Any) -> Any:
    """The three steps and the origin, as four rows."""
    import numpy as np

    if affine is not None:
        if spacing is not None or origin is not None:
            raise TypeError("affine says spacing and origin already: give one or the other")
        rows = coordinates("affine", affine)
        if rows.shape not in ((3, 4), (4, 4)) or (len(rows) == 4 and rows[3].tolist() != [0, 0, 0, 1]):
            raise ValueError("affine: 3 × 4, or 4 × 4 with a last row of 0, 0, 0, 1")
        if np.linalg.matrix_rank(rows[:3, :3]) < 3:
            raise ValueError("affine: its three steps lie in a plane")
        # The columns of the matrix are the steps and the origin.
        return rows[:3].T
    step = coordinates("spacing", 1.0 if spacing is None else spacing)
    if step.shape not in ((), (3,)):
        raise ValueError("spacing: one number or three")
    zero_axes = [axis for axis, size in zip("xyz", np.broadcast_to(step, 3), strict=True) if size == 0]
    if zero_axes:
        raise ValueError(f"spacing: a step of 0 along {' and '.join(zero_axes)} leads nowhere")
    first = coordinates("origin", (0.0, 0.0, 0.0) if origin is None else origin)
    if first.shape != (3,):
        raise ValueError("origin: three numbers")
    return np.vstack([np.diag(np.broadcast_to(step, 3)), first])
