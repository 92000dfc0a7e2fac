"""`Bound`: what was lost."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from typing import Any


@dataclass(frozen=True)
class Bound:
    """What was lost: an interval that holds the distance between the true shape and the one that was made.

    >>> import chordal
    >>> mesh = chordal.load(b"v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n", format="obj").mesh(tol="1%")
    >>> mesh.bound
    <Bound: between 0 and 0, proved; hausdorff distance to the input triangles>
    """

    #: The distance is at least this.
    at_least: float
    #: The distance is at most this; None where nothing bounds it from above.
    at_most: float | None
    #: How that is known: "proved", "proved-if", "measured" or "estimated".
    evidence: str
    #: What the distance measures: "hausdorff" looks both ways.
    metric: str
    #: The true shape, as in "bezier patches".
    reference: str
    #: The distance on the screen is at most this many device pixels; None without a view.
    pixels: float | None = None
    #: The largest angle that was found between a triangle's normal and the shape's, in degrees, where one was asked for.
    angle_deg: float | None = None
    #: Where the loss is worst, as far as is known.
    at: tuple[float, ...] | None = None
    #: What a proof rests on, for "proved-if".
    assumptions: tuple[str, ...] = ()
    #: How many samples were taken, for "measured".
    samples: int | None = None

    def __repr__(self) -> str:
        return f"<Bound: {self.sentence()}>"

    def sentence(self) -> str:
        """All of it in one line. Digits are left out such that the interval only grows."""
        least = _short(self.at_least, ROUND_FLOOR)
        if self.at_most is None:
            length = f"at least {least}"
        else:
            length = f"between {least} and {_short(self.at_most, ROUND_CEILING)}"
        known = self.evidence
        if self.assumptions:
            known += f" ({'; '.join(self.assumptions)})"
        if self.samples is not None:
            known += f" ({self.samples} samples)"
        pixels = "" if self.pixels is None else f"; at most {_short(self.pixels, ROUND_CEILING)} px"
        return f"{length}, {known}; {self.metric} distance to the {self.reference}{pixels}"


def bound_of(facts: Mapping[str, Any]) -> Bound:
    """The bound that a report speaks of."""
    return Bound(
        at_least=float(facts["at_least"]),
        at_most=None if facts["at_most"] is None else float(facts["at_most"]),
        evidence=facts["evidence"],
        metric=facts["metric"],
        reference=facts["reference"],
        pixels=None if facts["pixels"] is None else float(facts["pixels"]),
        angle_deg=facts.get("angle_deg"),
        at=None if facts["at"] is None else tuple(float(x) for x in facts["at"]),
        assumptions=tuple(facts.get("assumptions", ())),
        samples=facts.get("samples"),
    )


def _short(number: float, rounding: str) -> str:
    """Three significant digits, rounded to the side that is asked for and not to the nearest."""
    exact = Decimal(number)
    if exact == 0:
        return "0"
    last = Decimal(1).scaleb(exact.adjusted() - 2)
    return f"{float(exact.quantize(last, rounding=rounding)):.3g}"
