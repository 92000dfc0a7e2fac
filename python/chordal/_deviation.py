"""`Deviation`: the distance between two shapes."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, SupportsFloat

from chordal import _chordal
from chordal._arguments import function
from chordal._bound import Bound, bound_of
from chordal._budget import Length
from chordal._hints import Guessed
from chordal._html import table
from chordal._option_tables import DEVIATION
from chordal._options import options
from chordal._registry import registered
from chordal._report import Report

if TYPE_CHECKING:
    from chordal._shape import Shape


@dataclass(frozen=True)
class OneSided:
    """The one-sided Hausdorff distance, from the points of one shape to the other, as a proved interval.

    >>> import chordal
    >>> triangle = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    >>> lifted = chordal.Mesh([(0, 0, 2), (1, 0, 2), (0, 1, 2)], [(0, 1, 2)])
    >>> forward = triangle.deviation(lifted).forward
    >>> forward.at_least <= 2 <= forward.at_most, forward.nearest[2]
    (True, 2.0)
    """

    #: Some point is at least this far.
    at_least: float
    #: No point is farther than this.
    at_most: float
    #: The point with the largest distance that was found.
    point: tuple[float, float, float]
    #: The point of the other shape that is nearest to it.
    nearest: tuple[float, float, float]


@dataclass(frozen=True)
class Deviation(Guessed):
    """The distance between two shapes, in units. `Shape.deviation` computes it.

    >>> import chordal
    >>> triangle = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    >>> lifted = chordal.Mesh([(0, 0, 2), (1, 0, 2), (0, 1, 2)], [(0, 1, 2)])
    >>> triangle.deviation(lifted, max=1).verdict
    'exceeds'
    """

    #: The symmetric Hausdorff distance, as a proved interval.
    bound: Bound
    #: The distance from the points of this shape to the other one.
    forward: OneSided
    #: The distance from the points of the other shape to this one.
    backward: OneSided
    #: Whether the interval is as narrow as requested; it is proved in any case.
    reached: bool
    #: The side of `max` on which the distance is: "within", "exceeds" or "undecided"; None without `max`.
    verdict: str | None
    #: The report of `chordal deviation --json`.
    report: Report = field(compare=False)

    @property
    def at_least(self) -> float:
        """A lower bound of the Hausdorff distance."""
        return self.bound.at_least

    @property
    def at_most(self) -> float | None:
        """An upper bound of the Hausdorff distance; None if there is none."""
        return self.bound.at_most

    def _repr_html_(self) -> str:
        rows = [("verdict", self.verdict or ""), ("bound", self.bound.sentence())]
        for title, side in (("from this one", self.forward), ("from the other", self.backward)):
            rows.append((title, f"between {side.at_least:.6g} and {side.at_most:.6g}, farthest at {_place(side.point)}"))
        return table("Deviation", [(title, text) for title, text in rows if text])

    def __repr__(self) -> str:
        verdict = "" if self.verdict is None else f"; {self.verdict}"
        return f"<Deviation: {self.bound.sentence()}{verdict}>"


def measured(
    one: _chordal.Source,
    other: Shape | Any,
    *,
    relative: SupportsFloat,
    absolute: Length | None,
    max: Length | None,
    progress: Callable[[str, int, int], object] | None,
) -> Deviation:
    """The distance between two shapes."""
    second = registered.shaped("other", other)._source
    given = options(DEVIATION, relative=relative, absolute=absolute, max=max)
    report = Report(json.loads(one.deviation(second, given, function("progress", progress))))
    facts = report["deviation"]
    return Deviation(
        bound=bound_of(report["certificate"]["bound"]),
        forward=_one_sided(facts["forward"]),
        backward=_one_sided(facts["backward"]),
        reached=facts["reached"],
        verdict=facts["verdict"],
        report=report,
    )


def _place(point: tuple[float, float, float]) -> str:
    return f"({', '.join(f'{x:.6g}' for x in point)})"


def _one_sided(facts: Mapping[str, Any]) -> OneSided:
    [x, y, z], [u, v, w] = facts["from"], facts["to"]
    return OneSided(float(facts["at_least"]), float(facts["at_most"]), (x, y, z), (u, v, w))
