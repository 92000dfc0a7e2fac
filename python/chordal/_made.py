"""Outcomes of budgets: checks whether they meet the budget, and adapts them to file formats."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from chordal._errors import BudgetUnmet

if TYPE_CHECKING:
    from chordal import _chordal
    from chordal._options import Option

Result = TypeVar("Result")


@dataclass(frozen=True)
class Form:
    """The form of a file: its format, the options for its numbers, and a callback for progress."""

    format: str
    options: Sequence[Option] = ()
    progress: Callable[[str, int, int], object] | None = None


def of_outcome(outcome: _chordal.Outcome, make: Callable[[_chordal.Outcome], Result]) -> Result:
    """The result of an outcome, if it meets its budget; else `BudgetUnmet` carries it."""
    result = make(outcome)
    if outcome.unmet is not None:
        raise BudgetUnmet(outcome.unmet, result)
    return result


def remade(
    outcome: _chordal.Outcome,
    make: Callable[[_chordal.Outcome], object],
    form: Form,
) -> _chordal.Outcome:
    """The outcome of the same budget for a format, including its rounding. If that is not met, `BudgetUnmet` carries the result
    of `make`.
    """
    for_format = outcome.remake(form.format, form.options, form.progress)
    # If the budget was not met before, either, the caller knows, and may write the best result.
    if outcome.unmet is None:
        of_outcome(for_format, make)
    return for_format


def counted(count: int, one: str, many: str) -> str:
    """A number with its noun."""
    return f"{count:,} {one if count == 1 else many}"
