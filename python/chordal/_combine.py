"""Booleans: solids combined as triangles."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

from chordal import _chordal
from chordal._arguments import function
from chordal._bound import Bound
from chordal._budget import Length, Share, Time, length_options
from chordal._errors import Refused
from chordal._interop import mesh_of
from chordal._option_tables import MESH
from chordal._options import options
from chordal._sourced import Sourced

if TYPE_CHECKING:
    from chordal._mesh import Mesh
    from chordal._shape import Shape

#: The names of all of them.
OPERATIONS: tuple[str, ...] = ("union", "difference", "intersection")


#: How the sentence begins where no point is inside of what was asked for: the code "empty" is that of empty shapes, too.
_NOTHING = "nothing would be left"


class Combinable(Sourced):
    """What can be combined as a solid."""

    __slots__ = ()

    def combine(
        self,
        *steps: tuple[Literal["union", "difference", "intersection"], Shape | Any],
        tol: Length | None = None,
        rel: Share | None = None,
        within: Time | None = None,
        progress: Callable[[str, int, int], object] | None = None,
    ) -> Mesh:
        """The solid combined with others from left to right, as triangles: each step is "union", "difference" or
        "intersection", and the other solid, which may be a file or a mesh of another library.

        Closed triangles are cut as they are. Open ones and other shapes become closed triangles first, within `tol` or
        `rel`, which are needed for them. The bound says how far from the surfaces points may be on the wrong side. `within` is
        for a field that others are combined with, as for `Shape.mesh`.

        Where nothing is left, as of a solid without itself, the mesh has no triangles, and nothing bounds its distance. Raises
        `Refused` where a shape bounds no solid, and `BudgetUnmet` with the best result where
        the check of the result or the budget fails. Other threads, Ctrl-C and `progress` are as for `Shape.mesh`.

        >>> import chordal
        >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        >>> faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
        >>> one = chordal.Mesh(corners, faces)
        >>> two = chordal.Mesh([(x + 0.25, y, z) for x, y, z in corners], faces)
        >>> one.combine(("difference", two)).report["certificate"]["valid"]["closed"]
        True
        """
        return _combined(self, steps, tol=tol, rel=rel, within=within, progress=progress)

    def union(
        self,
        *others: Shape | Any,
        tol: Length | None = None,
        rel: Share | None = None,
        within: Time | None = None,
        progress: Callable[[str, int, int], object] | None = None,
    ) -> Mesh:
        """What is in this solid or in any of the others, which may be a list: `combine`."""
        return self.combine(
            *(("union", other) for other in one_by_one(others)), tol=tol, rel=rel, within=within, progress=progress
        )

    def difference(
        self,
        *others: Shape | Any,
        tol: Length | None = None,
        rel: Share | None = None,
        within: Time | None = None,
        progress: Callable[[str, int, int], object] | None = None,
    ) -> Mesh:
        """This solid without the others: `combine`."""
        return self.combine(
            *(("difference", other) for other in one_by_one(others)), tol=tol, rel=rel, within=within, progress=progress
        )

    def intersection(
        self,
        *others: Shape | Any,
        tol: Length | None = None,
        rel: Share | None = None,
        within: Time | None = None,
        progress: Callable[[str, int, int], object] | None = None,
    ) -> Mesh:
        """What is in this solid and in all of the others: `combine`."""
        return self.combine(
            *(("intersection", other) for other in one_by_one(others)), tol=tol, rel=rel, within=within, progress=progress
        )

    def __or__(self, other: Shape | Any) -> Mesh:
        """The union of closed triangles: `combine`."""
        return self._operated("union", other)

    def __sub__(self, other: Shape | Any) -> Mesh:
        """These closed triangles without others: `combine`."""
        return self._operated("difference", other)

    def __and__(self, other: Shape | Any) -> Mesh:
        """What is in both of two closed triangle meshes: `combine`."""
        return self._operated("intersection", other)

    def _operated(self, operation: str, other: Any) -> Mesh:
        from chordal._shape import Shape

        # A set operation of Python's own types is another matter: the other side may know it.
        found = other if isinstance(other, Shape) else mesh_of(other)
        if found is None:
            return NotImplemented  # type: ignore[no-any-return]
        if self._source.kind != "triangles" or found.kind != "triangles":
            raise TypeError(f"operators combine closed triangles; other shapes need a length: a.{operation}(b, tol=0.01)")
        other = found
        return _combined(self, ((operation, other),), tol=None, rel=None, within=None, progress=None)


def _combined(
    first: Combinable,
    steps: tuple[tuple[str, Any], ...],
    *,
    tol: Length | None,
    rel: Share | None,
    within: Time | None,
    progress: Callable[[str, int, int], object] | None,
) -> Mesh:
    """Solids combined from left to right."""
    from chordal._mesh import Mesh

    if not steps:
        raise ValueError("steps: at least one, as in ('difference', other)")
    budget = [*length_options(tol, rel), *options(MESH, within=within)]
    shapes: list[tuple[str, Combinable]] = [_step(step) for step in steps]
    tell = function("progress", progress)
    first, shapes = _without_nothing(first, shapes)
    if not shapes and isinstance(first, Mesh):
        return first
    others = [(operation, other._source) for operation, other in shapes]
    try:
        return Mesh._of(_chordal.combine(first._source, others, budget, "ply", tell))
    except Refused as refused:
        if not refused.message.startswith(_NOTHING):
            raise
        return _nothing(first)


def _nothing(first: Combinable) -> Mesh:
    """No triangles, where nothing is left of solids. No judge looks at what is not there: nothing bounds what was lost."""
    import numpy as np

    from chordal._mesh import Mesh

    made = Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.uint32), unit=getattr(first, "unit", None))
    return Mesh._of_source(made._source, Bound(0.0, None, "estimated", "solid", "input solids"))


def _without_nothing(
    first: Combinable, steps: list[tuple[str, Combinable]]
) -> tuple[Combinable, list[tuple[str, Combinable]]]:
    """The same without meshes that have no triangles, as differences may be: nothing is a solid, too."""
    left: list[tuple[str, Combinable]] = []
    for operation, other in steps:
        if _is_nothing(other):
            if operation == "intersection":
                first, left = other, []
        elif _is_nothing(first):
            first = other if operation == "union" else first
        else:
            left.append((operation, other))
    return first, left


def _is_nothing(shape: Combinable) -> bool:
    from chordal._mesh import Mesh

    return isinstance(shape, Mesh) and len(shape.vertices) == len(shape.faces) == 0


def _step(step: object) -> tuple[str, Shape]:
    if not isinstance(step, tuple) or len(step) != 2:
        raise TypeError(f"steps: pairs as in ('difference', other), not {type(step).__name__}")
    operation, other = step
    if operation not in OPERATIONS:
        raise ValueError(f"steps: one of {', '.join(OPERATIONS)}, not {operation!r}")
    from chordal._verbs import shaped

    return operation, shaped("steps", other)


def one_by_one(others: tuple[Any, ...]) -> list[Any]:
    """Shapes that are given one after the other, or as a list."""
    return [one for other in others for one in (other if isinstance(other, (list, tuple)) else [other])]
