"""Which surface of a volume is meant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, SupportsFloat

from chordal import _chordal
from chordal._arguments import number, text, warn


def meant_of(known: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """What was said of a surface before, and what is said now, which counts."""
    said = {name: value for name, value in given.items() if value is not None}
    # A level takes the place of labels, and they that of a level.
    others = {"iso": ("labels",), "labels": ("iso", "inside")}
    replaced = {name for own in said for name in others.get(own, ())}
    return {**{name: value for name, value in known.items() if name not in replaced}, **said}


def meant(
    source: _chordal.Source,
    *,
    iso: SupportsFloat | None,
    inside: Literal["high", "low"] | None,
    border: Literal["capped", "open"] | None,
    labels: Sequence[int] | Literal["all"] | None,
    smooth: str | SupportsFloat | None,
) -> _chordal.Source:
    """A volume with the surface that is meant; the same shape where nothing is said of one."""
    words = {"iso": iso, "inside": inside, "border": border, "labels": labels, "smooth": smooth}
    said = [name for name, value in words.items() if value is not None]
    if not said:
        return source
    if source.kind != "volume":
        raise TypeError(f"{', '.join(said)}: for samples on a lattice; these are {source.kind}")
    arguments: _chordal.Meant = {
        "iso": None if iso is None else number("iso", iso),
        "inside": text("inside", inside),
        "border": text("border", border) or "capped",
        "labels": None if labels is None else [] if labels == "all" else _labels(labels),
        "smooth": None if smooth is None else smooth if isinstance(smooth, str) else repr(number("smooth", smooth)),
    }
    if iso is not None and inside is None and labels is None:
        _warn_of_distances(source, arguments["iso"])
    return source.surface(arguments)


def _warn_of_distances(source: _chordal.Source, level: float | None) -> None:
    """Says it where samples are taken for distances, below 0 inside, and most at the ends of the lattice are inside."""
    import numpy as np

    samples = np.asarray(_chordal.samples(source)[0])
    if level != 0 or samples.dtype.kind != "f":
        return
    ends = np.concatenate([samples.take((0, -1), axis).ravel() for axis in range(3)])
    if np.mean(ends < 0) > 0.5:
        warn(
            "iso: at level 0 floating-point samples are taken for distances, negative inside, and most at the ends of the "
            "lattice are; say inside='high' if they are positive inside, or inside='low' if this is meant"
        )


def _labels(labels: Sequence[int] | str) -> list[int]:
    found = [int(label) for label in labels]
    if not found:
        raise ValueError("labels: one label at least, or 'all'")
    return found
