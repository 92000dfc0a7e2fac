"""What was made within a budget: whether it meets it, and as a file."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

from chordal._errors import BudgetUnmet

if TYPE_CHECKING:
    from chordal import _chordal

Made = TypeVar("Made")


def of_outcome(outcome: _chordal.Outcome, make: Callable[[_chordal.Outcome], Made]) -> Made:
    """What was made, if it meets its budget; else `BudgetUnmet` carries it."""
    made = make(outcome)
    if outcome.unmet is not None:
        raise BudgetUnmet(outcome.unmet, made)
    return made


def remade(
    outcome: _chordal.Outcome,
    make: Callable[[_chordal.Outcome], object],
    format: str,
    quantize: bool,
    compress: str | None,
) -> _chordal.Outcome:
    """The same within the same budget for a format, whose rounding then counts; else `BudgetUnmet` carries what `make` makes."""
    found = outcome.remake(format, quantize, compress)
    # The best of a budget that was not met may be written all the same: its owner knows.
    if outcome.unmet is None:
        of_outcome(found, make)
    return found


def counted(count: int, one: str, many: str) -> str:
    """A number with its noun."""
    return f"{count:,} {one if count == 1 else many}"
