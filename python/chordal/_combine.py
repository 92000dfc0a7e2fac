"""Booleans: solids combined as triangles."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from chordal import _chordal
from chordal._arguments import function
from chordal._budget import Length, Share, budget_arguments

if TYPE_CHECKING:
    from chordal._mesh import Mesh
    from chordal._shape import Shape

#: The names of all of them.
OPERATIONS: tuple[str, ...] = ("union", "difference", "intersection")


def is_triangles(thing: object) -> bool:
    """Whether operators combine it without a budget: triangles that were read, given or made."""
    from chordal._mesh import Mesh
    from chordal._shape import Shape

    return isinstance(thing, Mesh) or (isinstance(thing, Shape) and thing.kind == "triangles")


def combined(
    first: Shape | Mesh,
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
    return Mesh.of(_chordal.combine(_compiled("first", first), others, budget, "ply", function("progress", progress)))


def _step(step: object) -> tuple[str, _chordal.Source | _chordal.Outcome]:
    if not isinstance(step, tuple) or len(step) != 2:
        raise TypeError(f"steps: pairs as in ('difference', other), not {type(step).__name__}")
    operation, other = step
    if operation not in OPERATIONS:
        raise ValueError(f"steps: one of {', '.join(OPERATIONS)}, not {operation!r}")
    return operation, _compiled("steps", other)


def _compiled(name: str, thing: object) -> _chordal.Source | _chordal.Outcome:
    from chordal._mesh import Mesh
    from chordal._shape import Shape

    if isinstance(thing, Shape):
        return thing._source
    if isinstance(thing, Mesh):
        return thing._outcome
    raise TypeError(f"{name}: a Shape or a Mesh, not {type(thing).__name__}")
