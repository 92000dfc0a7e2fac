"""Options that select a surface of a volume."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, SupportsFloat, SupportsIndex

from chordal import _chordal
from chordal._arguments import number, warn
from chordal._option_tables import SURFACE
from chordal._options import options


def meant_of(known: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """The earlier options of a surface, overridden by the ones given now."""
    options = {name: value for name, value in given.items() if value is not None}
    # A level replaces labels, and labels replace a level.
    replaces = {"iso": ("labels",), "labels": ("iso", "inside")}
    replaced = {name for option in options for name in replaces.get(option, ())}
    return {**{name: value for name, value in known.items() if name not in replaced}, **options}


def meant(
    source: _chordal.Source,
    *,
    iso: SupportsFloat | None,
    inside: Literal["high", "low"] | None,
    border: Literal["capped", "open"] | None,
    labels: Sequence[SupportsIndex] | SupportsIndex | Literal["all"] | None,
    smooth: str | SupportsFloat | None,
) -> _chordal.Source:
    """A volume with the chosen surface; the same shape if no option is given."""
    words = {"iso": iso, "inside": inside, "border": border, "labels": labels, "smooth": smooth}
    names = [name for name, value in words.items() if value is not None]
    if not names:
        return source
    if source.kind != "volume":
        raise TypeError(f"{', '.join(names)}: for samples on a lattice; these are {source.kind}")
    if border not in (None, "capped", "open"):
        raise ValueError(f"border: 'capped' or 'open', not {border!r}")
    listed = labels if labels is None or isinstance(labels, str) and labels == "all" else ",".join(map(str, _labels(labels)))
    width = smooth if smooth is None or isinstance(smooth, str) else repr(number("smooth", smooth))
    given = options(SURFACE, iso=iso, inside=inside, border=border == "open", labels=listed, smooth=width)
    if iso is not None and inside is None and labels is None:
        _warn_of_unclear_sides(source, number("iso", iso))
    return source.surface(given)


#: The share of samples at the ends of a lattice on the inner side from which on there is a warning. Chosen: a scanned body
#: reaches the first and last layers, which is less than this share of all ends.
_UNCLEAR = 1 / 3


def _warn_of_unclear_sides(source: _chordal.Source, level: float | None) -> None:
    """Warns if the inside at level 0 follows from the samples alone, and the ends of the lattice have both signs."""
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
    numbers = label_list("labels", labels)
    if not numbers:
        raise ValueError("labels: one label at least, or 'all'")
    return numbers


def label_list(name: str, labels: Any) -> list[int]:
    """Labels from a sequence or a single number. Floats that are whole numbers are accepted, as numpy's `unique` returns them."""
    if isinstance(labels, str):
        raise TypeError(f"{name}: labels as whole numbers, as in {name}=[1, 2], not {labels!r}")
    sequence = labels if isinstance(labels, Iterable) else [labels]
    return [_label(name, label) for label in sequence]


def _label(name: str, label: Any) -> int:
    try:
        return operator.index(label)
    except TypeError:
        whole = number(name, label)
        if not whole.is_integer():
            raise ValueError(f"{name}: whole numbers, not {whole:g}") from None
        return int(whole)
