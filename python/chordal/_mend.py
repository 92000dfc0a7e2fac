"""Repairs by name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, SupportsIndex

from chordal import _chordal
from chordal._arguments import function, warn, whole
from chordal._budget import Length, length
from chordal._hints import keywords_hinted
from chordal._made import counted
from chordal._sourced import Sourced

if TYPE_CHECKING:
    from chordal._mesh import Mesh
    from chordal._shape import Progress


class Mendable(Sourced):
    """What can be mended: shapes of triangles."""

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
        """The triangles after the repairs that are asked for, in the order of this list; nothing else is changed.

        `all` is every one, exactly, with all holes: what a print needs. `weld` makes vertices with equal coordinates one,
        or those within a length of each other. `drop_duplicates` drops faces that repeat an earlier one, whichever way they
        are wound ("any"), or only those wound "alike". `resolve_t_junctions` cuts faces where a vertex lies in the middle
        of their edge, exactly or within a length. `orient` turns closed pieces outwards; one within another that faces the
        same way stays solid (`nested` is "keep") or becomes a "cavity". `fill_holes` fills all, or those with at most so many edges.

        A `UserWarning` says how many holes are left where they were to be filled.

        The bound says how far the surface moved, and `report["certificate"]["mended"]` what each repair changed. Raises
        `Refused` for what has no triangles, and where nothing would be left. Docs: `docs/mend.md`.

        >>> import chordal
        >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        >>> open_one = chordal.Mesh(corners, [(0, 2, 1), (0, 1, 3), (1, 2, 3)])
        >>> whole = open_one.mend(fill_holes=True)
        >>> len(whole.faces), whole.report["certificate"]["valid"]["closed"]
        (4, True)
        """
        from chordal._mesh import Mesh

        which = None if drop_duplicates is False else "any" if drop_duplicates is True else drop_duplicates
        holes = None if fill_holes is False else 0 if fill_holes is True else whole("fill_holes", fill_holes)
        arguments: _chordal.MendArguments = {
            "all": bool(all),
            "weld": _closeness("weld", weld),
            "drop_duplicates": which,
            "drop_degenerate": bool(drop_degenerate),
            "resolve_t_junctions": _closeness("resolve_t_junctions", resolve_t_junctions),
            "split_nonmanifold": bool(split_nonmanifold),
            "orient": bool(orient),
            "nested": str(nested),
            "fill_holes": holes,
            "drop_unused": bool(drop_unused),
        }
        repairs = [value for name, value in arguments.items() if name != "nested"]
        if not [value for value in repairs if value is not None and value is not False]:
            raise ValueError("name a repair: all=True, weld=True, orient=True, fill_holes=True, …")
        made = Mesh._of(_chordal.mend(self._source, arguments, "ply", function("progress", progress)))
        if arguments["all"] or holes is not None:
            _warn_of_holes(made, holes)
        return made


def _warn_of_holes(made: Mesh, most: int | None) -> None:
    """Says how many holes are left of a mesh whose holes were to be filled, and what would close them."""
    valid = made._valid
    count = valid["boundary_loops"] + valid["boundary_chains"]
    if count == 0:
        return
    left = f"{counted(count, 'hole is', 'holes are')} left, of {counted(valid['boundary_edges'], 'edge', 'edges')}"
    if most:
        warn(f"{left}: fill_holes=True fills those of more than {most} edges, too")
        return
    low, high = made.bounds
    # A millionth of the size: what single precision keeps of coordinates.
    near = float(max(high - low)) * 1e-6
    warn(
        f"{left}: no face fits them as the vertices are; join those that are nearly one first, as in "
        f"mend(all=True, weld={near:.1g}), or longer"
    )


def _closeness(name: str, value: bool | Length) -> str | None:
    """Nothing, an empty text for exact, or a length."""
    if isinstance(value, bool):
        return "" if value else None
    return length(name, value)
