"""Which surface of a volume is meant."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, SupportsFloat, SupportsIndex

from chordal import _chordal
from chordal._arguments import number, warn
from chordal._option_tables import SURFACE
from chordal._options import options


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
    labels: Sequence[SupportsIndex] | SupportsIndex | Literal["all"] | None,
    smooth: str | SupportsFloat | None,
) -> _chordal.Source:
    """A volume with the surface that is meant; the same shape where nothing is said of one."""
    words = {"iso": iso, "inside": inside, "border": border, "labels": labels, "smooth": smooth}
    said = [name for name, value in words.items() if value is not None]
    if not said:
        return source
    if source.kind != "volume":
        raise TypeError(f"{', '.join(said)}: for samples on a lattice; these are {source.kind}")
    if border not in (None, "capped", "open"):
        raise ValueError(f"border: 'capped' or 'open', not {border!r}")
    listed = labels if labels is None or isinstance(labels, str) and labels == "all" else ",".join(map(str, _labels(labels)))
    width = smooth if smooth is None or isinstance(smooth, str) else repr(number("smooth", smooth))
    given = options(SURFACE, iso=iso, inside=inside, open=border == "open", labels=listed, smooth=width)
    if iso is not None and inside is None and labels is None:
        _warn_of_unclear_sides(source, number("iso", iso))
    return source.surface(given)


#: Where more than this share of the ends of a lattice are on the side that is taken for inside, it is said. Chosen: a body reaches
#: the first and last layers of a scan, and less than that of all ends.
_UNCLEAR = 1 / 3


def _warn_of_unclear_sides(source: _chordal.Source, level: float | None) -> None:
    """Says it where the samples alone tell which side of 0 is inside, and the ends of the lattice are on both."""
    import numpy as np

    samples = np.asarray(_chordal.samples(source)[0])
    if level != 0 or samples.dtype.kind not in "fi":
        return
    ends = np.concatenate([samples.take((0, -1), axis).ravel() for axis in range(3)])
    below, above = np.mean(ends < 0), np.mean(ends > 0)
    if min(below, above) <= _UNCLEAR:
        return
    side, other = ("above", "low") if below > above else ("below", "high")
    warn(
        f"iso: at level 0 what is at most ends of the lattice is taken for outside, and so what is {side} the level for inside; "
        f"{max(below, above):.0%} of the ends say so and {min(below, above):.0%} do not: say inside={other!r} for the other side, "
        f"or inside={'high' if other == 'low' else 'low'!r} if this is meant"
    )


def _labels(labels: Sequence[SupportsIndex] | SupportsIndex | str) -> list[int]:
    found = label_list("labels", labels)
    if not found:
        raise ValueError("labels: one label at least, or 'all'")
    return found


def label_list(name: str, labels: Any) -> list[int]:
    """Labels that are given one by one, or as one number; floats that are whole numbers will do, as those of numpy's unique."""
    if isinstance(labels, str):
        raise TypeError(f"{name}: labels as whole numbers, as in {name}=[1, 2], not {labels!r}")
    given = labels if isinstance(labels, Iterable) else [labels]
    return [_label(name, label) for label in given]


def _label(name: str, label: Any) -> int:
    try:
        return operator.index(label)
    except TypeError:
        whole = number(name, label)
        if not whole.is_integer():
            raise ValueError(f"{name}: whole numbers, not {whole:g}") from None
        return int(whole)
