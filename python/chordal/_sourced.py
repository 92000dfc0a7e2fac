"""`Sourced`: objects with a shape of the compiled part."""

from __future__ import annotations

from chordal import _chordal
from chordal._option_tables import READING
from chordal._options import options


class Sourced:
    """An object whose shape is held by the compiled part."""

    __slots__ = ()

    @property
    def _source(self) -> _chordal.Source:
        raise NotImplementedError


def plain_reading(format: str, unit: str | None = None) -> _chordal.Reading:
    """The options for reading bytes that we wrote ourselves: the format, and defaults."""
    return {"name": None, "options": options(READING, format=format, unit=unit), "align": 0.0}
