"""`volume` and `Volume`: samples on a lattice, and the surfaces of them."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat, SupportsIndex

from chordal import _chordal
from chordal._arguments import function, text
from chordal._arrays import coordinates
from chordal._bound import Bound, bound_of
from chordal._budget import BudgetArguments, Length, Share, budget_arguments
from chordal._mesh import Mesh
from chordal._shape import Shape

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from chordal._view import View

_TYPES = {"u1": "uint8", "i1": "int8", "u2": "uint16", "i2": "int16", "u4": "uint32", "i4": "int32"}
_TYPES |= {"u8": "uint64", "i8": "int64", "f4": "float", "f8": "double", "b1": "uint8"}


class Volume(Shape):
    """Samples on a lattice. `volume` makes it of an array, `load` of a file, and `bake` of another shape."""

    __slots__ = ("_report",)

    def __init__(self, source: _chordal.Source, report: str | None = None) -> None:
        super().__init__(source)
        self._report = report

    @property
    def report(self) -> dict[str, Any] | None:
        """The report of `chordal bake`, where the samples are baked: what distances and sides rest on."""
        return None if self._report is None else json.loads(self._report)

    @property
    def bound(self) -> Bound | None:
        """How far the surface where the interpolant vanishes is from the shape that was baked, where that is proved."""
        facts = None if self._report is None else json.loads(self._report)["certificate"]["bound"]
        return None if facts is None else bound_of(facts)

    def mesh(
        self,
        *,
        iso: SupportsFloat | None = None,
        inside: Literal["high", "low"] | None = None,
        border: Literal["capped", "open"] = "capped",
        labels: Sequence[int] | Literal["all"] | None = None,
        smooth: str | SupportsFloat | None = None,
        tol: Length | None = None,
        rel: Share | None = None,
        pixels: SupportsFloat | None = None,
        view: str | View | None = None,
        angle: SupportsFloat | None = None,
        uv_error: SupportsFloat | None = None,
        normal_error: SupportsFloat | None = None,
        triangles: SupportsIndex | None = None,
        effort: Literal["best", "fast"] = "best",
        require: Literal["proved", "measured", "estimated"] | None = None,
        extrude: Length | None = None,
        bevel: Length | None = None,
        progress: Callable[[str, int, int], object] | None = None,
    ) -> Mesh:
        """The surface of the samples at the level `iso`, with its bound against their trilinear interpolant.

        Without a level it is 0.5 for masks and occupancies and 0 for distances; anything else is `Refused`. `inside`
        says on which side of the level the shape is. A shape that reaches the border is closed there, unless `border`
        is "open". With `labels`, a list or "all", every label has a surface of its own; within a budget two that
        meet still have the same triangles there, and `triangles` is for all together, whatever the `effort`. `smooth`, as in
        "1.5mm", "0.8vox" or 1.5, is the standard deviation of a Gaussian over a mask; the bound stays against the
        unsmoothed mask, and `report["certificate"]["smoothed"]` has what smoothing cost. A budget is one as for
        `Shape.mesh`; without any the bound is what the lattice allows. `extrude` and `bevel` are for drawings, and refused.

        >>> import chordal, numpy
        >>> i, j, k = numpy.indices((9, 9, 9)) - 4.0
        >>> ball = chordal.volume(numpy.sqrt(i * i + j * j + k * k) - 3, spacing=0.5, origin=(-2, -2, -2))
        >>> round(float(ball.mesh(iso=0).vertices.max()), 3)
        1.5
        """
        meant: _chordal.Meant = {
            "iso": None if iso is None else float(iso),
            "inside": text("inside", inside),
            "border": border,
            "labels": None if labels is None else [] if labels == "all" else _labels(labels),
            "smooth": None if smooth is None else smooth if isinstance(smooth, str) else repr(float(smooth)),
        }
        source = self._source.surface(meant)
        limits = (tol, rel, pixels, view, angle, uv_error, normal_error, triangles, extrude, bevel)
        nothing = all(limit is None for limit in limits)
        budget = (
            _NO_BUDGET
            if nothing
            else budget_arguments(
                tol=tol,
                rel=rel,
                pixels=pixels,
                view=view,
                angle=angle,
                uv_error=uv_error,
                normal_error=normal_error,
                triangles=triangles,
                counted="triangles",
                effort=effort,
                require=require,
                extrude=extrude,
                bevel=bevel,
            )
        )
        return Mesh.of(source.mesh(budget, "ply", function("progress", progress)))


_NO_BUDGET: BudgetArguments = {
    "length": None,
    "pixels": None,
    "angle_deg": None,
    "uv_error": None,
    "normal_error": None,
    "triangles": None,
    "segments": None,
    "spacing": "fewest",
    "effort": "best",
    "require": None,
    "extrude": None,
    "bevel": None,
}


def _labels(labels: Sequence[int] | str) -> list[int]:
    found = [int(label) for label in labels]
    if not found:
        raise ValueError("labels: one label at least, or 'all'")
    return found


def volume(
    array: ArrayLike,
    *,
    spacing: SupportsFloat | Sequence[SupportsFloat] | None = None,
    origin: Sequence[SupportsFloat] | None = None,
    affine: ArrayLike | None = None,
    unit: str | None = None,
) -> Volume:
    """A volume from an array of three axes: `array[i, j, k]` is the sample at x = i, y = j, z = k.

    `spacing` is the step along each axis, one number or three, and `origin` the place of the first sample; or `affine`
    is the 4 × 4 matrix, or its first three rows, that takes (i, j, k, 1) to space. The samples are copied in their own
    type. NaN is outside.

    >>> import chordal, numpy
    >>> chordal.volume(numpy.eye(4)[:, :, None] * numpy.ones(4), spacing=2)
    <Volume: volume, from nrrd>
    """
    import numpy as np

    found = np.asanyarray(array)
    kind = f"{found.dtype.kind}{found.dtype.itemsize}"
    if found.ndim != 3:
        raise ValueError(f"array: three axes, not {found.ndim}")
    if kind == "f2":
        found, kind = found.astype(np.float32), "f4"
    if kind not in _TYPES:
        raise TypeError(f"array: samples are numbers of up to 64 bits, not {found.dtype}")
    steps = _steps(spacing, origin, affine)
    vectors = [",".join(repr(float(number)) for number in row) for row in steps]
    header = "\n".join(
        [
            "NRRD0004",
            f"type: {_TYPES[kind]}",
            "dimension: 3",
            "space dimension: 3",
            "sizes: " + " ".join(map(str, found.shape)),
            "space directions: " + " ".join(f"({row})" for row in vectors[:3]),
            "endian: little",
            "encoding: raw",
            f"space origin: ({vectors[3]})",
            "",
            "",
        ]
    )
    samples = found.astype(found.dtype.newbyteorder("<"), copy=False).tobytes(order="F")
    reading: _chordal.Reading = {
        "name": None,
        "format": "nrrd",
        "unit": text("unit", unit),
        "up": None,
        "strict": False,
        "lenient": False,
        "drop_nonfinite": False,
        "surface": None,
        "letters": None,
    }
    return Volume(_chordal.Source(header.encode() + samples, reading))


def _steps(spacing: Any, origin: Any, affine: Any) -> Any:
    """The three steps and the origin, as four rows."""
    import numpy as np

    if affine is not None:
        if spacing is not None or origin is not None:
            raise TypeError("affine says spacing and origin already: give one or the other")
        rows = coordinates("affine", affine)
        if rows.shape not in ((3, 4), (4, 4)) or (len(rows) == 4 and rows[3].tolist() != [0, 0, 0, 1]):
            raise ValueError("affine: 3 × 4, or 4 × 4 with a last row of 0, 0, 0, 1")
        return rows[:3].T
    step = coordinates("spacing", 1.0 if spacing is None else spacing)
    if step.shape not in ((), (3,)):
        raise ValueError("spacing: one number or three")
    first = coordinates("origin", (0.0, 0.0, 0.0) if origin is None else origin)
    if first.shape != (3,):
        raise ValueError("origin: three numbers")
    return np.vstack([np.diag(np.broadcast_to(step, 3)), first])
