"""What a shape script says of itself: its parameters, the boxes of its shapes, and what it checks."""

from __future__ import annotations

import math
from typing import SupportsFloat

from chordal._field import Field


def param(name: str, default: SupportsFloat) -> float:
    """A number that a shape script can be given from outside. In Python it is its default: assign another.

    >>> import chordal
    >>> chordal.shapes.param("r", 0.4)
    0.4
    """
    return float(default)


def box_of(shape: Field) -> dict[str, list[float]]:
    """A box that holds a shape: its lowest and highest corner as `"min"` and `"max"`, its `"size"` and its `"center"`, each
    of three numbers, or of two for a shape without an end along z. It may be larger than need be: it is that of
    `Field.bounds`, which for a cut or a turned shape is the box of what it was made of.

    Raises `ValueError` for a shape without points, and for one whose ends are not known.

    >>> from chordal.shapes import box, box_of, move
    >>> [round(x, 6) for x in box_of(move(box(2, 2, 1), 0, 0, 4))["max"]]
    [1.0, 1.0, 4.5]
    """
    if not isinstance(shape, Field):
        raise TypeError(f"shape: a field, not {type(shape).__name__}")
    low, high = shape.bounds
    if any(a > b for a, b in zip(low, high, strict=True)):
        raise ValueError("box_of() needs a shape with points, and this one has none")
    # A shape of the plane has no end along z, and points of the plane are of two numbers.
    count = 2 if math.isinf(low[2]) and math.isinf(high[2]) else 3
    ends = [(low[k], high[k]) for k in range(count)]
    if not all(math.isfinite(a) and math.isfinite(b) for a, b in ends):
        raise ValueError(
            "box_of() needs a shape whose ends are known, and this one has none on some side: what is common with a box has them"
        )
    return {
        "min": [a for a, _ in ends],
        "max": [b for _, b in ends],
        "size": [b - a for a, b in ends],
        "center": [0.5 * a + 0.5 * b for a, b in ends],
    }


def check(condition: object, message: str) -> None:
    """Ends a shape script with a sentence unless a condition holds: here, by a `ValueError`."""
    if not condition:
        fail(message)


def fail(message: str) -> None:
    """Ends a shape script with a sentence: here, by a `ValueError`."""
    raise ValueError(message)
