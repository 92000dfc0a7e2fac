"""Budgets: keyword arguments as options of the command."""

from __future__ import annotations

import re
from decimal import Decimal
from fractions import Fraction
from typing import SupportsFloat

from chordal._arguments import number
from chordal._errors import BudgetError
from chordal._option_tables import MESH
from chordal._options import Option, options
from chordal._units import VOLUME_METRES
from chordal._view import View, words_of

#: A length in units of the shape, or a text with a unit, as in "0.1mm".
Length = SupportsFloat | str
#: A share of the diagonal of the shape's box, as in 0.001, or a text, as in "0.1%".
Share = SupportsFloat | str
#: Seconds, or a text with a unit, as in "20s", "2m" or "500ms".
Time = SupportsFloat | str


def budget_options(
    *,
    tol: Length | None,
    rel: Share | None,
    view: str | View | None = None,
    counted: str,
    **given: object,
) -> list[Option]:
    """The options of a budget, which has a limit. `counted` names the count that the caller takes."""
    limits = [tol, rel, given.get("pixels"), view, given.get("triangles"), given.get("segments")]
    if all(limit is None for limit in limits):
        raise BudgetError(
            "a budget is needed: tol=0.1 in units, rel=0.001 of the diagonal, "
            f'pixels=1 with view="1920x1080 fov=45 dist=4", or {counted}=5000'
        )
    return [*length_options(tol, rel), *options(MESH, view=None if view is None else words_of(view), **given)]


def length_options(tol: Length | None, rel: Share | None) -> list[Option]:
    """The option for the largest distance, if one is given."""
    argument = length_argument(tol, rel)
    return [] if argument is None else [("tol", *argument)]


def length_argument(tol: Length | None, rel: Share | None) -> tuple[str, str] | None:
    """A length as the command reads it, with the keyword that it came from."""
    if tol is not None and rel is not None:
        raise BudgetError("tol, rel: give one of them, they are both a length")
    return _tol(tol) or _rel(rel)


def length(name: str, value: Length) -> str:
    """A length as text, in the syntax of the command."""
    return value if isinstance(value, str) else repr(number(name, value))


def length_in(name: str, value: Length, unit: str | None) -> float:
    """A length as a number in a unit. Percentages are refused: the diagonal of a volume that is read block by block is unknown."""
    if not isinstance(value, str):
        return number(name, value)
    match = re.fullmatch(r"\s*([0-9.eE+-]+)\s*([a-z]*)\s*", value)
    try:
        count = Decimal(match[1]) if match else None
    # Decimal raises this for texts that only look like numbers, such as "1e".
    except ArithmeticError:
        count = None
    if match is None or count is None or match[2] not in ("", *VOLUME_METRES):
        raise BudgetError(f"{name}: a length in units, or a text as in '0.1mm', not {value!r}")
    if not match[2]:
        return float(count)
    if unit is None:
        raise BudgetError(f"{name}: nothing says the unit of the volume, which {value!r} needs: unit=\"mm\" does")
    # Exact fractions, rounded once at the end.
    return float(Fraction(count) * VOLUME_METRES[match[2]] / VOLUME_METRES[unit])


def _tol(tol: Length | None) -> tuple[str, str] | None:
    if tol is None:
        return None
    return "tol", length("tol", tol)


def _rel(rel: Share | None) -> tuple[str, str] | None:
    if rel is None:
        return None
    if not isinstance(rel, str):
        # In decimal arithmetic, so that 0.001 equals "0.1%" to the last bit.
        return "rel", f"{Decimal(repr(number('rel', rel))) * 100}%"
    if not rel.strip().endswith("%"):
        raise BudgetError(f"rel: a share of the diagonal, as in 0.001 or '0.1%', not '{rel}'")
    return "rel", rel
