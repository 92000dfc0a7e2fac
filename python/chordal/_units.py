"""Units of length by their names."""

from __future__ import annotations

from fractions import Fraction

#: Metres in a unit; exact by definition.
METRES = {
    "um": Fraction(1, 10**6),
    "mm": Fraction(1, 1000),
    "cm": Fraction(1, 100),
    "m": Fraction(1),
    "km": Fraction(1000),
    "in": Fraction(254, 10_000),
    "ft": Fraction(3048, 10_000),
}


def refuse_unknown(unit: object) -> None:
    """Raise `ValueError` for what is no unit."""
    if unit not in METRES:
        raise ValueError(f"unit: one of {', '.join(METRES)}, not {unit!r}")
