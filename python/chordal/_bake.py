"""The lattice of a bake, as Python's arguments say it."""

from __future__ import annotations

from operator import index
from typing import TYPE_CHECKING, SupportsFloat, SupportsIndex

from chordal._arguments import number
from chordal._budget import Length, Share, budget_arguments
from chordal._errors import BudgetError, BudgetUnmet

if TYPE_CHECKING:
    from chordal import _chordal
    from chordal._volume import Volume


def baked(
    source: _chordal.Source | _chordal.Outcome,
    *,
    cells: SupportsIndex | None,
    tol: Length | None,
    rel: Share | None,
    band: SupportsFloat | None,
    bound: bool,
) -> Volume:
    """The distances; raises `BudgetUnmet` with the best where a length was not reached."""
    from chordal._volume import Volume

    length = budget_arguments(tol=tol, rel=rel, pixels=None, view=None, counted="cells", is_needed=False)["length"]
    if (cells is None) == (length is None):
        raise BudgetError("cells, tol, rel: give one of them")
    arguments: _chordal.BakeArguments = {
        "cells": None if cells is None else index(cells),
        "length": length,
        "band": None if band is None else number("band", band),
        "bound": bound,
    }
    made, report, unmet = source.bake(arguments)
    volume = Volume(made, report)
    if unmet is not None:
        raise BudgetUnmet(unmet, volume)
    return volume
