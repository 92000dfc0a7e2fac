"""Units of length by their names."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

#: Metres in a unit. Defined exactly.
METRES = {
    "um": Fraction(1, 10**6),
    "mm": Fraction(1, 1000),
    "cm": Fraction(1, 100),
    "m": Fraction(1),
    "km": Fraction(1000),
    "in": Fraction(254, 10_000),
    "ft": Fraction(3048, 10_000),
}


#: The same with nanometres, the unit of volumes from electron microscopes, which meshes do not support.
VOLUME_METRES = {"nm": Fraction(1, 10**9), **METRES}


#: The names of units in trimesh; the first of each is the one that is written.
TRIMESH_NAMES = {
    "um": ("microns", "micrometers", "um"),
    "mm": ("millimeters", "millimeter", "mm"),
    "cm": ("centimeters", "centimeter", "cm"),
    "m": ("meters", "meter", "m"),
    "km": ("kilometers", "kilometer", "km"),
    "in": ("inches", "inch", "in"),
    "ft": ("feet", "foot", "ft"),
}


def unit_of(metres: float | None) -> str | None:
    """The name of the unit with a length in metres; None if it has none."""
    return next((unit for unit, exact in METRES.items() if float(exact) == metres), None)


def refuse_unknown(unit: object, known: Mapping[str, Fraction] = METRES) -> None:
    """Raise `ValueError` for an unknown unit."""
    if unit not in known:
        raise ValueError(f"unit: one of {', '.join(known)}, not {unit!r}")
