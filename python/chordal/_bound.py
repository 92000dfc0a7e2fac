"""`Bound`: the distance between a result and the true shape."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import MAX_EMAX, MIN_EMIN, ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from typing import Any, SupportsFloat

from chordal._hints import Guessed
from chordal._html import table


@dataclass(frozen=True)
class Bound(Guessed):
    """An interval that contains the distance between the true shape and the result.

    >>> import chordal
    >>> mesh = chordal.load(b"v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n", format="obj").mesh(tol="1%")
    >>> mesh.bound
    <Bound: between 0 and 0, proved; hausdorff distance to the input triangles>
    """

    #: The distance is at least this.
    at_least: float
    #: The distance is at most this; None if there is no upper bound.
    at_most: float | None
    #: How the interval is known: "proved", "proved-if", "measured" or "estimated".
    evidence: str
    #: The kind of distance: "hausdorff" is measured in both directions.
    metric: str
    #: The true shape, as in "bezier patches".
    reference: str
    #: The distance on the screen is at most this many device pixels; None without a view.
    pixels: float | None = None
    #: The largest measured angle between normals of triangles and of the shape, in degrees, if the budget has an angle.
    angle_deg: float | None = None
    #: The place of the largest distance, as far as it is known.
    at: tuple[float, ...] | None = None
    #: The assumptions of the proof, for "proved-if".
    assumptions: tuple[str, ...] = ()
    #: The number of samples, for "measured".
    samples: int | None = None

    def _length(self) -> str:
        least = _short(self.at_least, ROUND_FLOOR)
        return f"at least {least}" if self.at_most is None else f"between {least} and {_short(self.at_most, ROUND_CEILING)}"

    def is_within(self, length: SupportsFloat) -> bool:
        """Whether the distance is known, by its evidence, to be at most a length; False if there is no upper bound.

        >>> import chordal
        >>> mesh = chordal.shapes.sphere(1).mesh(tol=0.01)
        >>> mesh.bound.is_within(0.01), mesh.bound.is_within(1e-9)
        (True, False)
        """
        return self.at_most is not None and self.at_most <= float(length)

    def _repr_html_(self) -> str:
        rows = [("length", self._length()), ("evidence", self.evidence), ("metric", self.metric), ("to the", self.reference)]
        if self.pixels is not None:
            rows.append(("on the screen", f"at most {_short(self.pixels, ROUND_CEILING)} px"))
        if self.angle_deg is not None:
            rows.append(("angle", f"{_short(self.angle_deg, ROUND_CEILING)}° at most, as found"))
        if self.samples is not None:
            rows.append(("samples", f"{self.samples:,}"))
        return table("Bound", [*rows, *(("assumed", text) for text in self.assumptions)])

    def __repr__(self) -> str:
        return f"<Bound: {self.sentence()}>"

    def sentence(self) -> str:
        """The bound in one line. Numbers are rounded outwards, so that the interval only grows."""
        evidence = self.evidence
        if self.assumptions:
            evidence += f" ({'; '.join(self.assumptions)})"
        if self.samples is not None:
            evidence += f" ({self.samples} samples)"
        pixels = "" if self.pixels is None else f"; at most {_short(self.pixels, ROUND_CEILING)} px"
        return f"{self._length()}, {evidence}; {self.metric} distance to the {self.reference}{pixels}"


def bound_of(facts: Mapping[str, Any]) -> Bound:
    """The bound in a report."""
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
    """Three significant digits, rounded in the given direction instead of to nearest."""
    exact = Decimal(number)
    if exact == 0:
        return "0"
    context = Context(prec=3, rounding=rounding, Emax=MAX_EMAX, Emin=MIN_EMIN)
    return f"{float(context.plus(exact)):.3g}"
