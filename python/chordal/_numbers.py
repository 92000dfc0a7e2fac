"""Numbers that people pass: checked, and named when they are wrong."""

from __future__ import annotations

import math
import operator
from typing import SupportsFloat

from chordal._errors import BudgetError


def number(name: str, value: object) -> float:
    """A finite number as Python's own float; numpy's numbers will do, texts and truth values will not."""
    if isinstance(value, (bool, str, bytes)) or not isinstance(value, SupportsFloat):
        raise TypeError(f"{name}: a number, not {type(value).__name__}")
    found = float(value)
    if not math.isfinite(found):
        raise BudgetError(f"{name}: a finite number, not {found}")
    return found


def count(name: str, value: object) -> int:
    """A whole number of at least 1."""
    try:
        if isinstance(value, bool):
            raise TypeError
        found = operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        raise TypeError(f"{name}: a whole number, not {type(value).__name__}") from None
    if not 1 <= found < 2**64:
        raise BudgetError(f"{name}: a whole number of at least 1, not {found}")
    return found
