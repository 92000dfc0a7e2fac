"""`Volume`: samples on a lattice, and their surfaces."""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat, SupportsIndex

from chordal import _chordal
from chordal._arrays import as_asked
from chordal._bound import Bound, bound_of
from chordal._hints import keywords_hinted
from chordal._html import slice_to_png, table
from chordal._images import Imaged
from chordal._meant import meant, meant_of
from chordal._registry import registered
from chordal._report import Report
from chordal._shape import Shape
from chordal._sourced import plain_reading
from chordal._units import unit_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


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
        # The source counts the fastest index first; `array` of an .npy in C order has the first and last index the other way
        # round.
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

        # An affine map takes the lattice to a parallelepiped, whose extremes along each axis are at its corners.
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
        content = _chordal.convert(self._source, "nrrd", (), None, None).write()
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


registered.volume = Volume
