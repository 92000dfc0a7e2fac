"""Booleans: solids combined as triangles."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

from chordal import _chordal
from chordal._arguments import function
from chordal._bound import Bound
from chordal._budget import Length, Share, Time, length_options
from chordal._errors import Refused
from chordal._option_tables import MESH
from chordal._options import options
from chordal._registry import registered
from chordal._sourced import Sourced

if TYPE_CHECKING:
    from chordal._mesh import Mesh
    from chordal._shape import Shape

#: The names of all of them.
OPERATIONS: tuple[str, ...] = ("union", "difference", "intersection")


#: The beginning of the message for an empty result: its code "empty" is also that of empty inputs.
_NOTHING = "nothing would be left"


class Combinable(Sourced):
    """Shapes that can be combined as solids."""

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

        Closed triangles are cut as they are. Open ones and other shapes are first converted to closed triangles, within `tol`
        or `rel`, which they require. The bound is the largest distance from the surfaces at which a point may be on the wrong
        side. `within` is for a field that others are combined with, as for `Shape.mesh`.

        If the result is empty, as the difference of a solid and itself, the mesh has no triangles and no upper bound. Raises
        `Refused` if a shape bounds no solid, and `BudgetUnmet` with the best result if the check of the result or the budget
        fails. Other threads, Ctrl-C and `progress` are as for `Shape.mesh`.

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
        """The union of this solid and others, given one by one or as a list: `combine`."""
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
        """The difference of this solid and others: `combine`."""
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
        """The intersection of this solid and others: `combine`."""
        return self.combine(
            *(("intersection", other) for other in one_by_one(others)), tol=tol, rel=rel, within=within, progress=progress
        )

    def __or__(self, other: Shape | Any) -> Mesh:
        """The union of closed triangles: `combine`."""
        return self._operated("union", other)

    def __sub__(self, other: Shape | Any) -> Mesh:
        """The difference of closed triangles: `combine`."""
        return self._operated("difference", other)

    def __and__(self, other: Shape | Any) -> Mesh:
        """The intersection of closed triangles: `combine`."""
        return self._operated("intersection", other)

    def _operated(self, operation: str, other: Any) -> Mesh:
        # For other types, Python tries the operator of the other operand.
        solid = other if isinstance(other, Combinable) else registered.mesh_of(other)
        if solid is None:
            return NotImplemented  # type: ignore[no-any-return]
        if self._source.kind != "triangles" or solid._source.kind != "triangles":
            raise TypeError(f"operators combine closed triangles; other shapes need a length: a.{operation}(b, tol=0.01)")
        return _combined(self, ((operation, solid),), tol=None, rel=None, within=None, progress=None)


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
    if not steps:
        raise ValueError("steps: at least one, as in ('difference', other)")
    budget = [*length_options(tol, rel), *options(MESH, within=within)]
    shapes: list[tuple[str, Combinable]] = [_step(step) for step in steps]
    tell = function("progress", progress)
    first, shapes = _without_nothing(first, shapes)
    if not shapes and isinstance(first, registered.mesh):
        return first
    others = [(operation, other._source) for operation, other in shapes]
    try:
        return registered.mesh._of(_chordal.combine(first._source, others, budget, "ply", tell))
    except Refused as refused:
        if not refused.message.startswith(_NOTHING):
            raise
        return _nothing(first)


def _nothing(first: Combinable) -> Mesh:
    """A mesh without triangles, for an empty result. The check of results needs triangles, so the distance has no upper bound."""
    import numpy as np

    empty = registered.mesh(np.zeros((0, 3)), np.zeros((0, 3), np.uint32), unit=getattr(first, "unit", None))
    return registered.mesh._of_source(empty._source, Bound(0.0, None, "estimated", "solid", "input solids"))


def _without_nothing(
    first: Combinable, steps: list[tuple[str, Combinable]]
) -> tuple[Combinable, list[tuple[str, Combinable]]]:
    """The same combination without empty meshes, as differences may be: they count as the empty solid."""
    remaining: list[tuple[str, Combinable]] = []
    for operation, other in steps:
        # The second operand is empty: an intersection with it is empty, whatever came before, and a union or difference
        # with it changes nothing.
        if _is_nothing(other):
            if operation == "intersection":
                first, remaining = other, []
        # The result so far is empty: only a union puts anything into it.
        elif _is_nothing(first):
            first = other if operation == "union" else first
        else:
            remaining.append((operation, other))
    return first, remaining


def _is_nothing(shape: Combinable) -> bool:
    return isinstance(shape, registered.mesh) and len(shape.vertices) == len(shape.faces) == 0


def _step(step: object) -> tuple[str, Shape]:
    if not isinstance(step, tuple) or len(step) != 2:
        raise TypeError(f"steps: pairs as in ('difference', other), not {type(step).__name__}")
    operation, other = step
    if operation not in OPERATIONS:
        raise ValueError(f"steps: one of {', '.join(OPERATIONS)}, not {operation!r}")
    return operation, registered.shaped("steps", other)


def one_by_one(others: tuple[Any, ...]) -> list[Any]:
    """Shapes that are given one by one, or as lists."""
    return [shape for other in others for shape in (other if isinstance(other, (list, tuple)) else [other])]
