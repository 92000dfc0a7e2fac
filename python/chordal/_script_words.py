"""Words of shape scripts beside the functions of shapes: coordinates, parameters, boxes of shapes, and checks."""

from __future__ import annotations

import math
from typing import SupportsFloat

from chordal._field import Field, Formula, coordinate

#: Half of a full turn, in radians.
pi: float = math.pi
#: The first coordinate of a point.
x: Formula = coordinate(0)
#: The second coordinate of a point.
y: Formula = coordinate(1)
#: The third coordinate of a point, which is height.
z: Formula = coordinate(2)


def param(name: str, default: SupportsFloat) -> float:
    """A parameter of a shape script. In Python it has its default value: assign another one instead.

    >>> import chordal
    >>> chordal.shapes.param("r", 0.4)
    0.4
    """
    return float(default)


def box_of(shape: Field) -> dict[str, list[float]]:
    """A box that contains a shape: its lowest and highest corner as `"min"` and `"max"`, its `"size"` and its `"center"`, each
    of three numbers, or of two for a 2D shape. It may be larger than the shape: it is `Field.bounds`,
    which for a cut or rotated shape follows from the boxes of its parts.

    Raises `ValueError` for a shape without points, and for one without known bounds.

    >>> from chordal.shapes import box, box_of, move
    >>> [round(x, 6) for x in box_of(move(box(2, 2, 1), 0, 0, 4))["max"]]
    [1.0, 1.0, 4.5]
    """
    if not isinstance(shape, Field):
        raise TypeError(f"shape: a field, not {type(shape).__name__}")
    low, high = shape.bounds
    if any(a > b for a, b in zip(low, high, strict=True)):
        raise ValueError("box_of() needs a shape with points, but this one is empty")
    # A 2D shape is unbounded along z, and 2D points have two coordinates.
    count = 2 if math.isinf(low[2]) and math.isinf(high[2]) else 3
    ends = [(low[k], high[k]) for k in range(count)]
    if not all(math.isfinite(a) and math.isfinite(b) for a, b in ends):
        raise ValueError(
            "box_of() needs a shape with known bounds, but this one has none on some side: intersect it with a box"
        )
    return {
        "min": [a for a, _ in ends],
        "max": [b for _, b in ends],
        "size": [b - a for a, b in ends],
        "center": [0.5 * a + 0.5 * b for a, b in ends],
    }


def check(condition: object, message: str) -> None:
    """Ends a shape script with a message unless a condition holds. In Python it raises `ValueError`."""
    if not condition:
        fail(message)


def fail(message: str) -> None:
    """Ends a shape script with a message. In Python it raises `ValueError`."""
    raise ValueError(message)
