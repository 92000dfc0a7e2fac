"""`volume`, `labels` and `Volume`: samples on a lattice, and their surfaces."""

from __future__ import annotations

import base64
import json
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat, SupportsIndex

from chordal import _chordal
from chordal._arguments import text
from chordal._array_to_png import slice_to_png
from chordal._arrays import as_asked, coordinates
from chordal._bound import Bound, bound_of
from chordal._errors import ReadError
from chordal._hints import keywords_hinted
from chordal._images import Imaged, lattice_of
from chordal._meant import meant, meant_of
from chordal._report import Report
from chordal._shape import Shape
from chordal._sourced import plain_reading
from chordal._table import table
from chordal._units import unit_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

_TYPES = {"u1": "uint8", "i1": "int8", "u2": "uint16", "i2": "int16", "u4": "uint32", "i4": "int32"}
_TYPES |= {"u8": "uint64", "i8": "int64", "f4": "float", "f8": "double", "b1": "uint8"}


class Volume(Shape, Imaged):
    """Samples on a lattice: `volume` takes them from an array, `load` from a file, and `bake` samples another shape.

    >>> import chordal, numpy
    >>> i, j, k = numpy.indices((9, 9, 9)) - 4.0
    >>> ball = chordal.volume(numpy.sqrt(i * i + j * j + k * k) - 3, spacing=0.5, origin=(-2, -2, -2))
    >>> ball.shape, ball.spacing, ball.origin
    ((9, 9, 9), (0.5, 0.5, 0.5), (-2.0, -2.0, -2.0))
    >>> round(float(ball.mesh(iso=0).vertices.max()), 3)
    1.5
    """

    __slots__ = ("_meant", "_report", "_runs_backwards")

    def __init__(
        self,
        source: _chordal.Source,
        report: str | None = None,
        meant: dict[str, Any] | None = None,
        runs_backwards: bool | None = None,
    ) -> None:
        super().__init__(source)
        self._report = report
        self._meant = meant or {}
        # An .npy in C order is kept as it lies in memory. Its last index runs fastest there, which is x of the lattice; for numpy
        # and for `array` it is z.
        is_reversed = source.format in ("npy", "npz") and _chordal.samples(source)[1] == _LAST_FASTEST
        self._runs_backwards = is_reversed if runs_backwards is None else runs_backwards

    @property
    def array(self) -> NDArray[Any]:
        """The samples in their own type: `array[i, j, k]` is the one at x = i, y = j, z = k of the lattice; an .npy is indexed as
        in numpy. Not copied, read-only; x runs fastest in memory, except for an .npy in C order.
        """
        import numpy as np

        samples = _chordal.samples(self._source)[0]
        array: NDArray[Any] = np.asarray(samples)
        return array if self._runs_backwards else array.T

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return as_asked(self.array, dtype, copy)

    @property
    def shape(self) -> tuple[int, int, int]:
        """The number of samples along i, j and k."""
        i, j, k = self.array.shape
        return i, j, k

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type of a sample."""
        return self.array.dtype

    @property
    def affine(self) -> NDArray[np.float64]:
        """The 4 × 4 matrix that maps (i, j, k, 1) to space."""
        import numpy as np

        rows = _chordal.samples(self._source)[1]
        matrix = np.array([*rows, (0.0, 0.0, 0.0, 1.0)])
        return matrix[:, [2, 1, 0, 3]] if self._runs_backwards else matrix

    @property
    def spacing(self) -> tuple[float, float, float]:
        """The distances between neighbours along i, j and k."""
        import numpy as np

        i, j, k = np.linalg.norm(self.affine[:3, :3], axis=0)
        return float(i), float(j), float(k)

    @property
    def origin(self) -> tuple[float, float, float]:
        """The position of the first sample."""
        x, y, z = self.affine[:3, 3]
        return float(x), float(y), float(z)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """The lowest and the highest corner of the bounding box of all samples, 2 × 3."""
        import numpy as np

        corners = np.array(np.meshgrid(*[(0, size - 1) for size in self.shape])).reshape(3, -1)
        places = self.affine[:3, :3] @ corners + self.affine[:3, 3:]
        return np.array([places.min(axis=1), places.max(axis=1)])

    @property
    def unit(self) -> str | None:
        """The unit of its coordinates, as in "mm"; None if it is unknown or has no name."""
        return unit_of(_chordal.samples(self._source)[2])

    @property
    def report(self) -> Report | None:
        """The report of `chordal bake`, if the samples are baked: the errors of the distances, and how inside was decided."""
        return None if self._report is None else Report(json.loads(self._report))

    @property
    def bound(self) -> Bound | None:
        """The distance between the zero surface of the interpolant and the shape that was baked, if it is proved."""
        facts = None if self._report is None else json.loads(self._report)["certificate"]["bound"]
        return None if facts is None else bound_of(facts)

    @keywords_hinted
    def surface(
        self,
        *,
        iso: SupportsFloat | None = None,
        inside: Literal["high", "low"] | None = None,
        border: Literal["capped", "open"] | None = None,
        labels: Sequence[SupportsIndex] | SupportsIndex | Literal["all"] | None = None,
        smooth: str | SupportsFloat | None = None,
    ) -> Volume:
        """The same samples, with the surface that `mesh`, `lod`, `render` and other methods use.

        It is the isosurface at the level `iso`: by default 0.5 for masks and occupancies and 0 for distances; other samples
        without a level are `Refused`. `inside` is the side of the level that is inside: by default the high one. At level 0 of
        samples with both signs, the default is that the sign of most samples at the ends of the lattice is outside, as for
        distances or for a scan in air. A shape that reaches the border is closed there, unless `border` is "open".

        With `labels` (one, a list or "all") every label has its own surface. Within a budget, two labels that meet still share
        the triangles between them; a number of triangles is the total of all labels. `smooth`, as in "1.5mm", "0.8vox" or
        1.5, is the standard deviation of a Gaussian filter of a mask. The bound is still against the unsmoothed mask, and
        `report["certificate"]["smoothed"]` is the error that smoothing added.

        >>> import chordal, numpy
        >>> i, j, k = numpy.indices((9, 9, 9)) - 4.0
        >>> scan = chordal.volume(1000 - 200 * numpy.sqrt(i * i + j * j + k * k))
        >>> len(scan.surface(iso=500).lod(tol=0.05)) > 1
        True
        """
        words = {"iso": iso, "inside": inside, "border": border, "labels": labels, "smooth": smooth}
        options = meant_of(self._meant, words)
        source = meant(self._source, **dict.fromkeys(words) | options)
        return Volume(source, self._report, options, self._runs_backwards)

    def __reduce__(self) -> Any:
        content = _chordal.convert(self._source, "nrrd", (False, None), None, None).write()
        return _again, (content, self._report, self._meant, self._runs_backwards)

    def _repr_html_(self) -> str:
        i, j, k = self.shape
        box = " to ".join(f"({', '.join(f'{x:.6g}' for x in corner)})" for corner in self.bounds.tolist())
        steps = ", ".join(f"{step:.6g}" for step in self.spacing)
        rows = [("samples", f"{i} × {j} × {k} of {self.dtype}"), ("spacing", steps), ("box", box)]
        rows += [] if not self._meant else [("surface", ", ".join(f"{name}={value!r}" for name, value in self._meant.items()))]
        rows += [] if self.bound is None else [("bound", self.bound.sentence())]
        layer = base64.b64encode(slice_to_png(self.array[:, :, k // 2])).decode()
        title = f"the layer of samples at k = {k // 2}, x to the right and y up"
        style = f"width:160px;aspect-ratio:{i * self.spacing[0]:.6g}/{j * self.spacing[1]:.6g};image-rendering:pixelated"
        return f'<img alt="{title}" title="{title}" style="{style}" src="data:image/png;base64,{layer}">{table("Volume", rows)}'

    def __repr__(self) -> str:
        i, j, k = self.shape
        steps = ", ".join(f"{step:.6g}" for step in self.spacing)
        return f"<Volume: {i} × {j} × {k} of {self.dtype}, spacing {steps}>"


#: The rows of the map from lattice to space if the last index is x.
_LAST_FASTEST = [[0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]]


def _again(content: bytes, report: str | None, words: dict[str, Any], runs_backwards: bool = False) -> Volume:
    """Restores a pickled volume."""
    restored = Volume(_chordal.Source(content, plain_reading("nrrd")), report, None, runs_backwards)
    return restored.surface(**words) if words else restored


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
    steps = _steps(spacing, origin, affine)
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
    from chordal._load import load

    shape = load(path, unit=unit)
    if not isinstance(shape, Volume):
        raise TypeError(f"array: {os.fspath(path)} holds {shape.kind}, not samples on a lattice: load it")
    if spacing is None and origin is None and affine is None:
        return shape
    return volume(shape.array, spacing=spacing, origin=origin, affine=affine, unit=unit)


def _steps(spacing: Any, origin: Any, affine: Any) -> Any:
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
