"""`Sourced`: what the compiled part knows."""

from __future__ import annotations

from chordal import _chordal
from chordal._option_tables import READING
from chordal._options import options


class Sourced:
    """Something that the compiled part holds as a shape."""

    __slots__ = ()

    @property
    def _source(self) -> _chordal.Source:
        raise NotImplementedError


def plain_reading(format: str, unit: str | None = None) -> _chordal.Reading:
    """How bytes of our own are read: of that format, and as they are."""
    return {"name": None, "options": options(READING, format=format, unit=unit), "align": 0.0}
