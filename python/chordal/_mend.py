"""Repairs by name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, SupportsIndex

from chordal import _chordal
from chordal._arguments import function, warn, whole
from chordal._budget import Length
from chordal._hints import keywords_hinted
from chordal._made import counted
from chordal._option_tables import REPAIRS
from chordal._options import options
from chordal._registry import registered
from chordal._sourced import Sourced

if TYPE_CHECKING:
    from chordal._mesh import Mesh
    from chordal._shape import Progress


class Mendable(Sourced):
    """Shapes of triangles, which can be repaired."""

    __slots__ = ()

    @keywords_hinted
    def mend(
        self,
        *,
        all: bool = False,
        weld: bool | Length = False,
        drop_duplicates: bool | Literal["any", "alike"] = False,
        drop_degenerate: bool = False,
        resolve_t_junctions: bool | Length = False,
        split_nonmanifold: bool = False,
        orient: bool = False,
        nested: Literal["keep", "cavity"] = "keep",
        fill_holes: bool | SupportsIndex = False,
        drop_unused: bool = False,
        progress: Progress | None = None,
    ) -> Mesh:
        """The triangles after the chosen repairs, in the order of the arguments; nothing else is changed.

        `all` applies every repair, without tolerance and to all holes, as a 3D print needs it. `weld` merges vertices with equal
        coordinates, or within a length of each other. `drop_duplicates` drops faces that repeat an earlier one, with either
        winding ("any") or with the same winding ("alike"). `resolve_t_junctions` splits faces that have a vertex on one of
        their edges, exactly or within a length. `orient` orients closed pieces outwards; a piece inside another one with the
        same orientation stays solid (`nested` is "keep") or becomes a "cavity". `fill_holes` fills all holes, or those with at
        most so many edges.

        A `UserWarning` tells how many holes are left if they were to be filled.

        The bound is the distance by which the surface moved, and `report["certificate"]["mended"]` lists the changes of each
        repair. Raises `Refused` for shapes without triangles, and if nothing would be left. Docs: `docs/mend.md`.

        >>> import chordal
        >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        >>> open_one = chordal.Mesh(corners, [(0, 2, 1), (0, 1, 3), (1, 2, 3)])
        >>> whole = open_one.mend(fill_holes=True)
        >>> len(whole.faces), whole.report["certificate"]["valid"]["closed"]
        (4, True)
        """
        repairs = options(
            REPAIRS,
            all=all,
            weld=_closeness(weld),
            drop_duplicates="any" if drop_duplicates is True else drop_duplicates or None,
            drop_degenerate=drop_degenerate,
            resolve_t_junctions=_closeness(resolve_t_junctions),
            split_nonmanifold=split_nonmanifold,
            orient=orient,
            drop_unused=drop_unused,
        )
        most = None if isinstance(fill_holes, bool) else whole("fill_holes", fill_holes)
        if fill_holes is not False:
            repairs.append(("fill-holes", "fill_holes", "" if most is None else str(most)))
        if not repairs:
            raise ValueError("name a repair: all=True, weld=True, orient=True, fill_holes=True, …")
        repairs += options(REPAIRS, nested=nested)
        mended = registered.mesh._of(_chordal.mend(self._source, repairs, "ply", function("progress", progress)))
        if all or fill_holes is not False:
            _warn_of_holes(mended, most)
        return mended


def _warn_of_holes(mesh: Mesh, most: int | None) -> None:
    """Warns of holes that are left after filling, and tells how to close them."""
    valid = mesh._valid
    count = valid["boundary_loops"] + valid["boundary_chains"]
    if count == 0:
        return
    left = f"{counted(count, 'hole is', 'holes are')} left, of {counted(valid['boundary_edges'], 'edge', 'edges')}"
    if most:
        warn(f"{left}: fill_holes=True fills those of more than {most} edges, too")
        return
    low, high = mesh.bounds
    # A millionth of the size: about the rounding of coordinates in single precision.
    near = float(max(high - low)) * 1e-6
    warn(
        f"{left}: no face fits them as the vertices are; join those that are nearly one first, as in "
        f"mend(all=True, weld={near:.1g}), or longer"
    )


def _closeness(value: bool | Length) -> Length | None:
    """The argument of a repair with a tolerance: None for no repair, an empty text for an exact one, or a length."""
    if isinstance(value, bool):
        return "" if value else None
    return value
