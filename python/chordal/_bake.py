"""Sampling signed distances on a lattice."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, SupportsFloat, SupportsIndex

from chordal import _chordal
from chordal._arguments import function
from chordal._budget import Length, Share, length_options
from chordal._errors import BudgetError, BudgetUnmet
from chordal._hints import keywords_hinted
from chordal._option_tables import BAKE
from chordal._options import options
from chordal._registry import registered
from chordal._sourced import Sourced

if TYPE_CHECKING:
    from chordal._volume import Volume

class Bakeable(Sourced):
    """Shapes whose distance can be sampled."""

    __slots__ = ()

    @keywords_hinted
    def bake(
        self,
        *,
        cells: SupportsIndex | None = None,
        tol: Length | None = None,
        rel: Share | None = None,
        band: SupportsFloat | None = None,
        bound: bool = False,
        progress: Callable[[str, int, int], object] | None = None,
    ) -> Volume:
        """The signed distance to the shape, negative inside, on a lattice of cubes with `cells` along the longest side.

        With `tol` or `rel` instead, the number of cells is chosen so that the zero surface of the interpolant is proved to be
        within that length of the shape; `BudgetUnmet` has the best result. With `band`, samples are distances only within so
        many cells of the surface. `bound` proves the zero surface for `cells`, too. The `report` of the result has the
        largest error of distances, at samples and between them, and how inside was decided. Other threads, Ctrl-C and
        `progress` are as for `Shape.mesh`. Raises `Refused` for curves.

        >>> import chordal
        >>> corner = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        >>> solid = chordal.Mesh(corner, [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])
        >>> solid.bake(cells=8).report["certificate"]["baked"]["solid"]["sentence"]
        'the mesh is a solid'
        >>> solid.bake(tol=0.05).bound.at_most <= 0.05
        True
        """
        return _baked(self._source, cells=cells, tol=tol, rel=rel, band=band, bound=bound, progress=progress)


def _baked(
    source: _chordal.Source,
    *,
    cells: SupportsIndex | None,
    tol: Length | None,
    rel: Share | None,
    band: SupportsFloat | None,
    bound: bool,
    progress: Callable[[str, int, int], object] | None,
) -> Volume:
    """The sampled distances; raises `BudgetUnmet` with the best result if the budget was not met."""
    length = length_options(tol, rel)
    if (cells is None) == (not length):
        raise BudgetError("cells, tol, rel: give one of them")
    given = options(BAKE, cells=cells, band=band, bound=bound)
    samples, report, unmet = source.bake([*length, *given], function("progress", progress))
    volume = registered.volume(samples, report)
    if unmet is not None:
        raise BudgetUnmet(unmet, volume)
    return volume
