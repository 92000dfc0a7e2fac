"""`load` and `Shape`: what a file holds."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final, Literal, SupportsFloat, SupportsIndex

from chordal import _chordal, _files
from chordal._arguments import function, number
from chordal._arguments import text as _text
from chordal._arrays import coordinates, indices
from chordal._bake import Bakeable
from chordal._budget import Length, Share, budget_arguments
from chordal._combine import Combinable
from chordal._deviation import Deviation, measured
from chordal._errors import Refused
from chordal._mesh import Mesh
from chordal._polylines import Polylines
from chordal._view import View

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from chordal._cage import Cage

#: Told about progress: the name of the stage, the steps that are done, and those in all.
Progress = Callable[[str, int, int], object]


def load(
    source: str | os.PathLike[str] | bytes | bytearray | memoryview,
    *,
    format: str | None = None,
    unit: str | None = None,
    up: str | None = None,
    strict: bool = False,
    lenient: bool = False,
    drop_nonfinite: bool = False,
    surface: Literal["catmull-clark", "loop", "bilinear", "faceted"] | None = None,
    text: str | None = None,
    em: SupportsFloat | None = None,
    axes: Mapping[str, SupportsFloat] | None = None,
) -> Shape:
    """Read a shape from a file, or from the bytes of one.

    `format` is an extension, as in "bpt" or "glb"; without it the file's own extension counts, then its content.
    `unit` is the unit of the coordinates: um, mm, cm, m, km, in or ft. `up` is the axis that is up: "y" or "z".
    `strict` refuses a glTF file for anything that Khronos' validator calls an error, also for what viewers accept,
    and an .obj whose faces name normals or texture coordinates that it does not have; `lenient` only warns of what is
    wrong without touching its geometry; not both. `drop_nonfinite` drops vertices that are not finite numbers, with
    their faces, and counts them. `surface` is what the polygons of an .obj stand for; without it they are a
    Catmull–Clark cage where the file has subdivision tags, else triangles. `text` is what a font sets, as a drawing;
    `em` is the length of its em, 1 unless said, and `axes` says where axes of a variable font are, as in
    `{"wght": 700}`.

    Raises `ReadError` with the place where the bytes are wrong, and `OSError` where there are none to read.

    >>> import chordal
    >>> chordal.load(b"v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n", format="obj")
    <Shape: triangles, from obj>
    """
    if strict and lenient:
        raise ValueError("strict and lenient: one of them")
    name = None
    if isinstance(source, (bytes, bytearray, memoryview)):
        content = bytes(source)
    elif isinstance(source, (str, os.PathLike)):
        name, content = _files.shown(source), _files.read(source)
    else:
        raise TypeError(f"source: a path or bytes, not {type(source).__name__}")
    if text is None and (em is not None or axes is not None):
        raise ValueError("em, axes: they are for the text that a font sets; add text=")
    letters = None
    if text is not None:
        tags = [(str(tag), number(f"axes, {tag}", value)) for tag, value in (axes or {}).items()]
        letters = (_text("text", text) or "", 1.0 if em is None else number("em", em), tags)
    reading: _chordal.Reading = {
        "name": name,
        "format": _text("format", format),
        "unit": _text("unit", unit),
        "up": _text("up", up),
        "strict": bool(strict),
        "lenient": bool(lenient),
        "drop_nonfinite": bool(drop_nonfinite),
        "surface": _text("surface", surface),
        "letters": letters,
    }
    source_of = _chordal.Source(content, reading)
    if source_of.kind == "volume":
        from chordal._volume import Volume

        return Volume(source_of)
    return Shape(source_of)


def triangles(vertices: ArrayLike, faces: ArrayLike, *, unit: str | None = None) -> Shape:
    """A triangle mesh from arrays: `vertices` n × 3 coordinates, `faces` m × 3 indices into them.

    Any real numbers and any integers will do; they are copied. Counter-clockwise is the front. `unit` is the unit of
    the coordinates, for lengths with a unit.

    >>> import chordal
    >>> chordal.triangles([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    <Shape: triangles, from ply>
    """
    points, rows = coordinates("vertices", vertices), indices("faces", faces)
    for name, array in (("vertices", points), ("faces", rows)):
        if array.ndim != 2 or array.shape[1] != 3:
            raise ValueError(f"{name}: rows of 3, as in (n, 3), not {array.shape}")
    return Shape(_chordal.Source.triangles(points.tobytes(), rows.tobytes(), _text("unit", unit)))


class Shape(Combinable, Bakeable):
    """What a file holds: patches, triangles, a drawing, or curves in space. `load` makes it; it does not change."""

    __slots__ = ("_source",)

    def __init__(self, source: _chordal.Source) -> None:
        self._source: Final = source

    @property
    def kind(self) -> str:
        """What it is: "patches", "surfaces", "triangles", "cage", "drawing", "curves", "volume" or "field"."""
        return self._source.kind

    @property
    def format(self) -> str:
        """The format that it was read from, as in "bpt"."""
        return self._source.format

    def inspect(self) -> dict[str, Any]:
        """The report of `chordal inspect`: what it is, its size, its warnings, and whether it is sound."""
        report: dict[str, Any] = json.loads(self._source.inspect())
        return report

    def deviation(
        self,
        other: Shape | Mesh,
        *,
        relative: SupportsFloat = 0.1,
        absolute: Length | None = None,
        max: Length | None = None,
        progress: Progress | None = None,
    ) -> Deviation:
        """How far this shape and another one are apart, both ways: an interval that is proved.

        The upper end is at most the share `relative` above the lower one, or the length `absolute`. With `max` only the
        side of that limit matters, and `verdict` says it. Lengths are in units, or texts as in "0.1mm" or "0.05%", a
        share of the diagonal of the other shape's box. Patches are meshed on the way, which is added at both ends.

        Other threads, Ctrl-C and `progress` are as for `Shape.mesh`. Raises `Refused` where a shape has no surface.

        >>> import chordal
        >>> one = chordal.triangles([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
        >>> two = chordal.triangles([(0, 0, 2), (1, 0, 2), (0, 1, 2)], [(0, 1, 2)])
        >>> found = one.deviation(two)
        >>> found.bound.at_least <= 2 <= found.bound.at_most
        True
        """
        return measured(
            self._source, other, relative=relative, absolute=absolute, max=max, progress=progress
        )

    def mesh(
        self,
        *,
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
        progress: Progress | None = None,
    ) -> Mesh:
        """Triangles within a budget, with the bound that was reached. A drawing is filled.

        `tol` is the largest distance to the true shape, in units or as a text with a unit; `rel` the same as a share
        of the diagonal of the shape's box. `pixels` is the largest distance on the screen of `view`. `triangles` is
        the most triangles: the best mesh with no more than these; of triangles and volumes, `effort` "fast" mostly takes
        about a tenth of the time, for two to three times the error. `angle`, beside one of them and for smooth surfaces, is the
        largest angle between the triangles' normals and the shape's, in degrees. `uv_error` and
        `normal_error`, beside `tol`, `rel` or `pixels`, are for triangles that have texture coordinates and normals: the
        largest distance to those of the input, where 1 is the texture's side, and the largest angle, in degrees; both are
        measured. All that are given hold. `require` is the
        evidence that a field's mesh needs: "proved"; "measured", which is sooner there; or "estimated", for a draft that is there
        at once and whose distance nobody knows. Unless it is said, a proof
        where there is anything to prove with, and a measurement for functions without a Lipschitz constant. `extrude` is
        the height to which a drawing or letters are raised, as a closed solid that stands on z = 0, and `bevel` how wide
        the edges of both its ends are cut off at 45 degrees: less than half of the height.

        Other Python threads run meanwhile. Ctrl-C ends it within a tenth of a second. `progress` is called with the
        name of a stage, the steps done and those in all; what it raises ends the work and comes back unchanged.

        Raises `BudgetError` for a budget without sense, `BudgetUnmet` with the best mesh where it was not reached,
        and `Refused` where it cannot be.

        >>> import chordal
        >>> shape = chordal.load(b"v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n", format="obj")
        >>> shape.mesh(rel="0.1%")
        <Mesh: 1 triangle, 3 vertices; between 0 and 0, proved; hausdorff distance to the input triangles>
        """
        budget = budget_arguments(
            tol=tol,
            rel=rel,
            pixels=pixels,
            view=view,
            angle=angle,
            uv_error=uv_error,
            normal_error=normal_error,
            triangles=triangles,
            effort=effort,
            require=require,
            extrude=extrude,
            bevel=bevel,
            counted="triangles",
        )
        if self.kind == "curves":
            raise Refused("unsupported", "curves in space enclose no area to fill with triangles: flatten them")
        return Mesh.of(self._source.mesh(budget, "ply", function("progress", progress)))

    def cage(self) -> Cage:
        """The polygons of a cage. Raises `Refused` for anything else.

        >>> import chordal
        >>> square = b"v 0 0 0\\nv 1 0 0\\nv 1 1 0\\nv 0 1 0\\nf 1 2 3 4\\n"
        >>> chordal.load(square, format="obj", surface="catmull-clark").cage()
        <Cage: 1 face, 4 vertices, catmull-clark>
        """
        from chordal._cage import Cage

        return Cage._of(self._source.cage())

    def flatten(
        self,
        *,
        tol: Length | None = None,
        rel: Share | None = None,
        pixels: SupportsFloat | None = None,
        view: str | View | None = None,
        segments: SupportsIndex | None = None,
        spacing: Literal["fewest", "even"] = "fewest",
        progress: Progress | None = None,
    ) -> Polylines:
        """The curves of a drawing as straight lines within a budget, one polyline for each subpath.

        Everything is as for `Curve.flatten`. `Polyline.source` is the number of the element in the file.

        >>> import chordal
        >>> circle = chordal.load(b'<svg xmlns="http://www.w3.org/2000/svg"><circle r="1"/></svg>')
        >>> lines = circle.flatten(tol=0.01)
        >>> len(lines), lines[0].closed, lines.bound.at_most <= 0.01
        (1, True, True)
        """
        budget = budget_arguments(
            tol=tol, rel=rel, pixels=pixels, view=view, segments=segments, spacing=spacing, counted="segments"
        )
        if self.kind not in ("curves", "drawing"):
            raise Refused("unsupported", f"{self.kind} hold no curves to flatten: mesh them")
        return Polylines.of(self._source.mesh(budget, "json", function("progress", progress)))

    def __repr__(self) -> str:
        name = f" {self._source.name}" if self._source.name else ""
        return f"<{type(self).__name__}: {self.kind}, from {self.format}{name}>"
