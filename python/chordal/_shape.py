"""`Shape`: the content of a file, and the operations on it."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat, SupportsIndex

from chordal import _chordal
from chordal._arguments import function
from chordal._bake import Bakeable
from chordal._budget import Length, Share, Time, budget_options
from chordal._combine import Combinable
from chordal._convert import Convertible
from chordal._deviation import Deviation, measured
from chordal._errors import Refused
from chordal._hints import Guessed, GuessedType, keywords_hinted, refuse_own
from chordal._html import table
from chordal._levels import Levelled
from chordal._meant import meant, meant_of
from chordal._mend import Mendable
from chordal._picture import Pictured
from chordal._polylines import Polylines
from chordal._recipe import Recipe, Remakeable
from chordal._registry import registered
from chordal._report import Report
from chordal._view import View

if TYPE_CHECKING:
    from chordal._cage import Cage
    from chordal._field import Field
    from chordal._mesh import Mesh

#: Called with progress: the name of the stage, the number of steps done, and the total.
Progress = Callable[[str, int, int], object]


class Shape(
    Combinable, Bakeable, Mendable, Levelled, Pictured, Convertible, Remakeable, Guessed, metaclass=GuessedType
):
    """A shape from a file: patches, a cage, a drawing, or curves. Triangles, samples and fields have classes of their own.

    `load` reads it. It is immutable.

    >>> import chordal
    >>> square = b"v 0 0 0\\nv 1 0 0\\nv 1 1 0\\nv 0 1 0\\nf 1 2 3 4\\n"
    >>> cage = chordal.load(square, format="obj", surface="catmull-clark")
    >>> cage.kind, cage.mesh(tol=0.1).bound.reference
    ('cage', 'limit surface')
    """

    __slots__ = ("_held", "_recipe")

    def __init__(self, source: _chordal.Source, recipe: Recipe | None = None) -> None:
        refuse_own(self, source, _chordal.Source)
        self._held: _chordal.Source | None = source
        self._recipe: Recipe | None = recipe

    @property
    def _source(self) -> _chordal.Source:
        assert self._held is not None
        return self._held

    @property
    def kind(self) -> str:
        """The kind of shape: "patches", "surfaces", "triangles", "cage", "drawing", "curves", "volume" or "field"."""
        return self._source.kind

    @property
    def format(self) -> str:
        """The format that it was read from, as in "bpt"."""
        return self._source.format

    @property
    def history(self) -> dict[str, Any]:
        """The steps that led to this shape, as far as they are proved: `steps`, each with its bound, and `total`, the distance
        from the first shape, as in the certificate of a report. For a file it is the history in its certificate, if that is a
        certificate of exactly this geometry; `begins` says why there is no earlier step. For a mesh that was moved or
        assembled, `composed` has the histories of its parts, and `total` counts from the shapes that these began with.

        >>> import chordal, tempfile, os
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     name = os.path.join(folder, "ball.ply")
        ...     report = chordal.shapes.sphere(1).mesh(tol=0.1).export(name)
        ...     total = chordal.load(name).history["total"]
        >>> total["reference"], 0 < total["at_most"] <= 0.1
        ('field', True)
        """
        history: dict[str, Any] = json.loads(_chordal.history(self._source))
        return history

    def inspect(self) -> Report:
        """The report of `chordal inspect`: the kind of the shape, its size, its warnings and its defects."""
        return Report(json.loads(self._source.inspect()))

    @keywords_hinted
    def deviation(
        self,
        other: Shape | Any,
        *,
        relative: SupportsFloat = 0.1,
        absolute: Length | None = None,
        max: Length | None = None,
        progress: Progress | None = None,
    ) -> Deviation:
        """The distance between this shape and another one, in both directions, as a proved interval. The other shape may also
        be a file or a mesh of another library.

        The upper end exceeds the lower one by at most the share `relative`, or by the length `absolute`. With `max`, the
        search stops once it is known on which side of that limit the distance is; `verdict` says so. Lengths are in units, or
        texts as in "0.1mm", or "0.05%" of the diagonal of the other shape's box. Patches are meshed first, and the interval
        is widened by the error of these meshes at both ends.

        Other threads, Ctrl-C and `progress` are as for `Shape.mesh`. Raises `Refused` if a shape has no surface.

        >>> import chordal
        >>> one = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
        >>> two = chordal.Mesh([(0, 0, 2), (1, 0, 2), (0, 1, 2)], [(0, 1, 2)])
        >>> found = one.deviation(two)
        >>> found.bound.at_least <= 2 <= found.bound.at_most
        True
        """
        return measured(
            self._source, other, relative=relative, absolute=absolute, max=max, progress=progress
        )

    @keywords_hinted
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
        effort: Literal["best", "fast"] | None = None,
        require: Literal["proved", "measured", "estimated"] | None = None,
        within: Time | None = None,
        extrude: Length | None = None,
        bevel: Length | None = None,
        iso: SupportsFloat | None = None,
        inside: Literal["high", "low"] | None = None,
        border: Literal["capped", "open"] | None = None,
        labels: Sequence[SupportsIndex] | SupportsIndex | Literal["all"] | None = None,
        smooth: str | SupportsFloat | None = None,
        progress: Progress | None = None,
    ) -> Mesh:
        """Triangles within a budget, with the bound that was reached. A drawing is filled.

        `tol` is the largest distance to the true shape, in units or as a text with a unit; `rel` is the same as a share
        of the diagonal of the shape's box. `pixels` is the largest distance on the screen of `view`. `triangles` is the
        largest number of triangles: the result is the best mesh with no more. For triangles and volumes, `effort` "fast"
        usually takes about a tenth of the time, for two to three times the error.

        Further limits can be added to these; all given limits hold. `angle`, for smooth surfaces, is the largest angle between
        the normals of triangles and of the shape, in degrees. `uv_error` and `normal_error`, with `tol`, `rel` or `pixels`,
        are for triangles with texture coordinates and normals: the largest difference from the input's texture coordinates,
        where 1 is the side of the texture, and the largest angle between normals, in degrees; both are measured.

        For fields, `require` is the evidence that the mesh needs: "proved"; "measured", which is faster; or "estimated", a
        draft that is ready at once and whose error is unknown. By default the bound is proved if the field allows it, and
        measured for functions without a Lipschitz constant. `effort` "best" carries the proof to its end. `within` is a time
        limit, in seconds or as in "2m", after which the best mesh so far is returned with a measured bound; the places
        without a proof are in `report["certificate"]["bound"]["open"]`. By default it is 60 seconds, or none if a proof is
        requested by `require` "proved" or `effort` "best".

        For drawings and letters, `extrude` is the height of a closed solid that stands on z = 0, and `bevel` the width by
        which the edges of both its ends are cut off at 45 degrees: less than half of the height.

        The arguments from `iso` to `smooth` select the surface of a volume, as for `Volume.surface`. A volume needs no
        budget: without one, the bound is as tight as its lattice allows.

        Other Python threads keep running. Ctrl-C ends the call within a tenth of a second. `progress` is called with the
        name of a stage, the number of steps done, and the total; an exception that it raises ends the work and is passed on.

        Raises `BudgetError` for a budget that makes no sense, `BudgetUnmet` with the best mesh if the budget was not met,
        and `Refused` if the shape cannot be meshed.

        >>> import chordal
        >>> shape = chordal.load(b"v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n", format="obj")
        >>> shape.mesh(rel="0.1%")
        <Mesh: 1 triangle, 3 vertices; between 0 and 0, proved; hausdorff distance to the input triangles>
        """
        if self.kind == "curves":
            raise Refused("unsupported", "curves in space enclose no area to fill with triangles: flatten them")
        words = {"iso": iso, "inside": inside, "border": border, "labels": labels, "smooth": smooth}
        earlier: dict[str, Any] = getattr(self, "_meant", {})
        is_given = any(value is not None for value in words.values())
        source = meant(self._source, **dict.fromkeys(words) | meant_of(earlier, words)) if is_given else self._source
        limits = (tol, rel, pixels, view, angle, uv_error, normal_error, triangles, extrude, bevel, require)
        if source.kind == "volume" and all(limit is None for limit in limits):
            budget = []
        else:
            budget = budget_options(
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
                within=within,
                extrude=extrude,
                bevel=bevel,
                counted="triangles",
            )
        return registered.mesh._of(source.mesh(budget, "ply", function("progress", progress)))

    def to_field(self, *, tol: Length | None = None, rel: Share | None = None) -> Field:
        """The signed distance to the triangles, negative inside, as a `Field` that can be cut, blended, and evaluated at points.

        For a mesh that is a solid, the distance is exact. For an open mesh, inside is where its winding number is above a
        half, and only the sign of the value can be relied on. Other shapes are meshed first, within `tol` or `rel`, and the
        field is the distance to these triangles. Docs: `docs/meshes-in-fields.md`.

        >>> import chordal
        >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        >>> solid = chordal.Mesh(corners, [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])
        >>> solid.to_field()([[0.25, 0.25, -2.0], [0.25, 0.25, 0.125]])
        array([ 2.   , -0.125])
        """
        if isinstance(self, registered.field):
            return self
        mesh = self if isinstance(self, registered.mesh) else self.mesh(tol=tol, rel=rel)
        return registered.field_of_mesh(mesh)

    def cage(self) -> Cage:
        """The polygons of a cage. Raises `Refused` for anything else.

        >>> import chordal
        >>> square = b"v 0 0 0\\nv 1 0 0\\nv 1 1 0\\nv 0 1 0\\nf 1 2 3 4\\n"
        >>> chordal.load(square, format="obj", surface="catmull-clark").cage()
        <Cage: 1 face, 4 vertices, catmull-clark>
        """
        return registered.cage._of(self._source.cage())

    @keywords_hinted
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
        """The curves of a drawing as polylines within a budget, one for each subpath.

        The arguments are those of `Curve.flatten`. `Polyline.source` is the number of the element in the file.

        >>> import chordal
        >>> circle = chordal.load(b'<svg xmlns="http://www.w3.org/2000/svg"><circle r="1"/></svg>')
        >>> lines = circle.flatten(tol=0.01)
        >>> len(lines), lines[0].closed, lines.bound.at_most <= 0.01
        (1, True, True)
        """
        budget = budget_options(
            tol=tol, rel=rel, pixels=pixels, view=view, segments=segments, spacing=spacing, counted="segments"
        )
        if self.kind not in ("curves", "drawing"):
            raise Refused("unsupported", f"{self._source.kinds} hold no curves to flatten: mesh them")
        return Polylines._of(self._source.mesh(budget, "json", function("progress", progress)))

    def _repr_html_(self) -> str:
        name = self._source.name
        return table(type(self).__name__, [("kind", self.kind), ("format", self.format), *([("file", name)] if name else [])])

    def __repr__(self) -> str:
        name = f" {self._source.name}" if self._source.name else ""
        return f"<{type(self).__name__}: {self.kind}, from {self.format}{name}>"
