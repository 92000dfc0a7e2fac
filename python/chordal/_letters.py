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

#: The share of each line that stands left of x = 0.
_ALIGNMENTS = {"left": 0.0, "center": 0.5, "right": 1.0}


def text(
    text: str,
    font: str | os.PathLike[str],
    tolerance: SupportsFloat,
    em: SupportsFloat = 1,
    align: Literal["left", "center", "right"] = "left",
    **axes: SupportsFloat,
) -> Field:
    """The letters of a text in a font, as a shape of the plane: the exact distance to polygons within `tolerance` of the
    outlines, and a lower bound where outlines overlap. `em` is the length of the font's em; `align`
    says whether lines start at x = 0, or by their advance widths are centred there or end there; `axes` say where those of a
    variable font are, as in `wght=700`. `Field.notes` has the distance of the polygons.

    Raises `ReadError` for what the font cannot set, and `OSError` where there is none.
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
    """What a drawing fills, as a shape of the plane with y up: the exact distance to polygons within `tolerance` of its
    curves, and a lower bound where they overlap. `Field.notes` has the distance of the polygons.

    Raises `ReadError` where the file is no drawing, and `OSError` where there is none.
    """
    length = number("tolerance", tolerance)
    drawing = load(name, format="svg")
    return _filled(drawing, shown(name), length)


def _filled(drawing: Shape, name: str, tolerance: float) -> Field:
    """What a drawing fills."""
    value = _chordal.drawing_field(drawing._source, name, tolerance)
    return Field(value, None, (_filled, (drawing, name, tolerance), {}))
