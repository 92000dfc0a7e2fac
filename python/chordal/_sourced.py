"""`Sourced`: what the compiled part knows."""

from __future__ import annotations

from chordal import _chordal


class Sourced:
    """Something that the compiled part holds as a shape."""

    __slots__ = ()

    @property
    def _source(self) -> _chordal.Source:
        raise NotImplementedError


def plain_reading(format: str, unit: str | None = None) -> _chordal.Reading:
    """How bytes of our own are read: of that format, and as they are."""
    return {
        "name": None,
        "format": format,
        "unit": unit,
        "up": None,
        "strict": False,
        "lenient": False,
        "drop_nonfinite": False,
        "surface": None,
        "letters": None,
        "index": None,
    }
