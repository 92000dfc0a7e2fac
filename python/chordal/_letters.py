"""`text` and `svg`: letters and drawings as fields, by the names of shape scripts."""

from __future__ import annotations

import os
from typing import Literal, SupportsFloat

from chordal import _chordal, _files
from chordal._arguments import number
from chordal._field import Field
from chordal._files import shown
from chordal._load import load, read
from chordal._option_tables import READING
from chordal._options import options
from chordal._shape import Shape
from chordal._sourced import plain_reading

#: The share of each line's advance width that lies left of x = 0.
_ALIGNMENTS = {"left": 0.0, "center": 0.5, "right": 1.0}


def text(
    text: str,
    font: str | os.PathLike[str],
    tolerance: SupportsFloat,
    em: SupportsFloat = 1,
    align: Literal["left", "center", "right"] = "left",
    **axes: SupportsFloat,
) -> Field:
    """The letters of a text in a font, as a 2D shape: the exact distance to polygons within `tolerance` of the outlines. If
    outlines overlap, the area that they fill is computed first, and the value inside of it may be a lower bound. `em` is the
    length of the font's em. `align` says whether the lines, by their advance widths, start at x = 0, are centred there or end
    there. `axes` are coordinates of a variable font, as in `wght=700`. `Field.notes` has the distance of the polygons from
    the outlines.

    Raises `ReadError` for a text that the font cannot set, and `OSError` if the font cannot be read.
    """
    length = number("tolerance", tolerance)
    if align not in _ALIGNMENTS:
        raise ValueError(f"align: 'left', 'center' or 'right', not {align!r}")
    reading = plain_reading("ttf")
    reading["name"] = shown(font)
    reading["options"] += options(READING, text=text, em=em)
    reading["options"] += [("axis", tag, f"{tag}={number(f'axes, {tag}', value)!r}") for tag, value in axes.items()]
    reading["align"] = _ALIGNMENTS[align]
    return _filled(read(_files.read(font), reading), shown(font), length)


def svg(name: str | os.PathLike[str], tolerance: SupportsFloat) -> Field:
    """The filled area of a drawing, as a 2D shape with y up: the exact distance to polygons within `tolerance` of its
    curves. If curves or shapes of the drawing overlap, the value inside may be a lower bound; outside it is exact.
    `Field.notes` has the distance of the polygons from the curves.

    Raises `ReadError` if the file is not a drawing, and `OSError` if it cannot be read.
    """
    length = number("tolerance", tolerance)
    drawing = load(name, format="svg")
    return _filled(drawing, shown(name), length)


def _filled(drawing: Shape, name: str, tolerance: float) -> Field:
    """The field of a drawing's filled regions."""
    value = _chordal.drawing_field(drawing._source, name, tolerance)
    return Field(value, None, (_filled, (drawing, name, tolerance), {}))
