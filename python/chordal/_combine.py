"""Booleans: solids combined as triangles."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

from chordal import _chordal
from chordal._arguments import function
from chordal._budget import Length, Share, budget_arguments

if TYPE_CHECKING:
    from chordal._mesh import Mesh
    from chordal._shape import Shape

#: The names of all of them.
OPERATIONS: tuple[str, ...] = ("union", "difference", "intersection")


class Combinable:
    """What can be combined as a solid: shapes and meshes."""

    __slots__ = ()

    def combine(
        self,
        *steps: tuple[Literal["union", "difference", "intersection"], Shape | Mesh],
        tol: Length | None = None,
        rel: Share | None = None,
        progress: Callable[[str, int, int], object] | None = None,
    ) -> Mesh:
        """The solid combined with others from left to right, as triangles: each step is "union", "difference" or
        "intersection", and the other solid.

        Closed triangles are cut as they are. Open ones and other shapes become closed triangles first, within `tol` or
        `rel`, which are needed for them. The bound says how far from the surfaces points may be on the wrong side.

        Raises `Refused` where a shape bounds no solid or nothing is left, and `BudgetUnmet` with the best result where
        the check of the result or the budget fails. Other threads, Ctrl-C and `progress` are as for `Shape.mesh`.

        >>> import chordal
        >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        >>> faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
        >>> one = chordal.triangles(corners, faces)
        >>> two = chordal.triangles([(x + 0.25, y, z) for x, y, z in corners], faces)
        >>> one.combine(("difference", two)).report["certificate"]["valid"]["closed"]
        True
        """
        return _combined(self, steps, tol=tol, rel=rel, progress=progress)

    def __or__(self, other: Shape | Mesh) -> Mesh:
        """The union of closed triangles: `combine`."""
        return self._operated("union", other)

    def __sub__(self, other: Shape | Mesh) -> Mesh:
        """These closed triangles without others: `combine`."""
        return self._operated("difference", other)

    def __and__(self, other: Shape | Mesh) -> Mesh:
        """What is in both of two closed triangle meshes: `combine`."""
        return self._operated("intersection", other)

    def _operated(self, operation: str, other: Shape | Mesh) -> Mesh:
        if not _is_triangles(self) or not _is_triangles(other):
            raise TypeError(
                "operators combine closed triangles; other shapes need a length: a.combine(('difference', b), tol=0.01)"
            )
        return _combined(self, ((operation, other),), tol=None, rel=None, progress=None)


def _is_triangles(thing: object) -> bool:
    """Whether operators combine it without a budget: triangles that were read, given or made."""
    from chordal._mesh import Mesh
    from chordal._shape import Shape

    return isinstance(thing, Mesh) or (isinstance(thing, Shape) and thing.kind == "triangles")


def _combined(
    first: Combinable,
    steps: tuple[tuple[str, Shape | Mesh], ...],
    *,
    tol: Length | None,
    rel: Share | None,
    progress: Callable[[str, int, int], object] | None,
) -> Mesh:
    """Solids combined from left to right."""
    from chordal._mesh import Mesh

    if not steps:
        raise ValueError("steps: at least one, as in ('difference', other)")
    budget = budget_arguments(tol=tol, rel=rel, pixels=None, view=None, counted="triangles", is_needed=False)
    others = [_step(step) for step in steps]
    return Mesh.of(_chordal.combine(compiled("first", first), others, budget, "ply", function("progress", progress)))


def _step(step: object) -> tuple[str, _chordal.Source | _chordal.Outcome]:
    if not isinstance(step, tuple) or len(step) != 2:
        raise TypeError(f"steps: pairs as in ('difference', other), not {type(step).__name__}")
    operation, other = step
    if operation not in OPERATIONS:
        raise ValueError(f"steps: one of {', '.join(OPERATIONS)}, not {operation!r}")
    return operation, compiled("steps", other)


def compiled(name: str, thing: object) -> _chordal.Source | _chordal.Outcome:
    from chordal._mesh import Mesh
    from chordal._shape import Shape

    if isinstance(thing, Shape):
        return thing._source
    if isinstance(thing, Mesh):
        return thing._outcome
    raise TypeError(f"{name}: a Shape or a Mesh, not {type(thing).__name__}")
