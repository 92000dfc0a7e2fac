"""`Sourced`: what the compiled part knows."""

from __future__ import annotations

from chordal import _chordal


class Sourced:
    """Something that the compiled part holds as a shape."""

    __slots__ = ()

    @property
    def _source(self) -> _chordal.Source:
        raise NotImplementedError
