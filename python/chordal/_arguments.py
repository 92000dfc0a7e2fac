"""Checks of single arguments, whose errors name the argument."""

from __future__ import annotations

import math
import operator
import os
import sys
import warnings
from collections.abc import Callable
from typing import SupportsFloat, TypeVar

from chordal._errors import BudgetError

Function = TypeVar("Function", bound=Callable[..., object])


def number(name: str, value: object) -> float:
    """A finite number as a float of Python; numpy's numbers are accepted, texts and truth values are not."""
    try:
        if isinstance(value, (bool, str, bytes)) or not isinstance(value, SupportsFloat):
            raise TypeError
        converted = float(value)
    except TypeError:
        raise TypeError(f"{name}: a number, not {type(value).__name__}") from None
    if not math.isfinite(converted):
        raise BudgetError(f"{name}: a finite number, not {converted}")
    return converted


def vector(name: str, value: tuple[object, ...]) -> tuple[float, float, float]:
    """Three numbers from the arguments of a function that takes `*value`: three of them, or a single vector."""
    import numpy as np

    argument = value[0] if len(value) == 1 else value
    parts = argument.tolist() if isinstance(argument, np.ndarray) else argument
    if not isinstance(parts, (list, tuple)) or len(parts) != 3:
        raise ValueError(f"{name}: three numbers, as in (1, 0, 0), not {argument!r}")
    x, y, z = (number(name, part) for part in parts)
    return x, y, z


def whole(name: str, value: object, least: int = 1) -> int:
    """A whole number of at least `least`."""
    try:
        if isinstance(value, bool):
            raise TypeError
        integer = operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        raise TypeError(f"{name}: a whole number, not {type(value).__name__}") from None
    if not least <= integer < 2**64:
        raise BudgetError(f"{name}: a whole number of at least {least}, not {integer}")
    return integer


def warn(message: str) -> None:
    """A `UserWarning` for the line that called this package."""
    package = os.path.dirname(__file__)
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and os.path.dirname(frame.f_code.co_filename) == package:
        frame, level = frame.f_back, level + 1
    warnings.warn(message, stacklevel=level)


def text(name: str, value: str | None) -> str | None:
    """A text, or None."""
    if value is None or isinstance(value, str):
        return value
    raise TypeError(f"{name}: a text, not {type(value).__name__}")


def function(name: str, value: Function | None) -> Function | None:
    """A function, or None."""
    if value is None or callable(value):
        return value
    raise TypeError(f"{name}: a function, not {type(value).__name__}")
