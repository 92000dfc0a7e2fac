"""What was made within a budget: whether it meets it, and as a file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from chordal._errors import BudgetUnmet

if TYPE_CHECKING:
    from chordal import _chordal

Made = TypeVar("Made")


@dataclass(frozen=True)
class Form:
    """What a file is to be: its format, whether a glTF is quantized and by which codec it is compressed, and who is told of progress."""

    format: str
    packing: tuple[bool, str | None] = (False, None)
    progress: Callable[[str, int, int], object] | None = None


def of_outcome(outcome: _chordal.Outcome, make: Callable[[_chordal.Outcome], Made]) -> Made:
    """What was made, if it meets its budget; else `BudgetUnmet` carries it."""
    made = make(outcome)
    if outcome.unmet is not None:
        raise BudgetUnmet(outcome.unmet, made)
    return made


def remade(
    outcome: _chordal.Outcome,
    make: Callable[[_chordal.Outcome], object],
    form: Form,
) -> _chordal.Outcome:
    """The same within the same budget for a format, whose rounding then counts; else `BudgetUnmet` carries what `make` makes."""
    found = outcome.remake(form.format, form.packing, form.progress)
    # The best of a budget that was not met may be written all the same: its owner knows.
    if outcome.unmet is None:
        of_outcome(found, make)
    return found


def counted(count: int, one: str, many: str) -> str:
    """A number with its noun."""
    return f"{count:,} {one if count == 1 else many}"
