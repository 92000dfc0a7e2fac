"""`Levels`: levels of detail, each with its bound."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal, SupportsFloat, SupportsIndex, overload

from chordal import _chordal, _files
from chordal._arguments import function, number
from chordal._bound import Bound, bound_of
from chordal._budget import Length, Share, length_options
from chordal._errors import BudgetUnmet
from chordal._hints import Guessed, keywords_hinted
from chordal._html import columns
from chordal._option_tables import LOD, OUTPUT
from chordal._options import options
from chordal._recipe import Recipe, Remakeable
from chordal._registry import registered
from chordal._report import Report
from chordal._sourced import Sourced
from chordal._view import View, words_of

if TYPE_CHECKING:
    from chordal._mesh import Mesh
    from chordal._shape import Progress


@dataclass(frozen=True)
class Level:
    """One of `Levels`.

    >>> import chordal
    >>> coarsest = chordal.shapes.sphere(1).lod(pixels=1, tol=0.02)[-1]
    >>> coarsest.bound.evidence, coarsest.distance > 1
    ('proved', True)
    """

    #: Its triangles.
    mesh: Mesh
    #: The distance of its triangles from the shape itself.
    bound: Bound
    #: The least distance from the eye to the shape's box at which it may be shown; None if no distance is large enough.
    distance: float | None

    def __repr__(self) -> str:
        start = "from no distance on" if self.distance is None else f"from {self.distance:.6g} on"
        return f"<Level: {len(self.mesh.faces):,} triangles, {start}; {self.bound.sentence()}>"


class Levels(Sequence[Level], Guessed, Remakeable):
    """Levels of detail, the finest first, each proved against the shape itself. `Shape.lod` returns them.

    `levels.at(distance)` is the level to show; `export` writes all levels as one glTF or as 3D Tiles. Distances are in units,
    from the eye to the shape's box.

    >>> import chordal
    >>> levels = chordal.shapes.sphere(1).lod(pixels=1, tol=0.02)
    >>> [len(level.mesh.faces) for level in levels] == sorted((len(level.mesh.faces) for level in levels), reverse=True)
    True
    >>> levels.at(0) is levels[0]
    True
    """

    __slots__ = ("_cached", "_facts", "_levels", "_recipe")

    def __init__(self, levels: _chordal.Levels, recipe: Recipe | None = None) -> None:
        self._recipe: Recipe | None = recipe
        self._levels: Final = levels
        self._facts: Final[dict[str, Any]] = json.loads(levels.report)
        self._cached: dict[int, Level] = {}

    @property
    def report(self) -> Report:
        """The report of `chordal lod --json`, which `docs/schema` describes. You may change it."""
        return Report(json.loads(self._levels.report))

    @property
    def bound(self) -> Bound:
        """The bound of the finest level."""
        return bound_of(self._facts["certificate"]["bound"])

    @property
    def distances(self) -> tuple[float | None, ...]:
        """For each level, the least distance from the eye to the box at which it may be shown."""
        return tuple(level["distance"] for level in self._rows())

    def _rows(self) -> list[dict[str, Any]]:
        rows: list[dict[str, Any]] = self._facts["certificate"]["levels"]["levels"]
        return rows

    def at(self, distance: SupportsFloat) -> Level:
        """The coarsest level that may be shown at a distance; the finest if none may."""
        eye_distance = number("distance", distance)
        allowed = [k for k, start in enumerate(self.distances) if start is not None and start <= eye_distance]
        return self[max(allowed, default=0)]

    def __len__(self) -> int:
        return len(self._rows())

    @overload
    def __getitem__(self, index: int) -> Level: ...

    @overload
    def __getitem__(self, index: slice) -> list[Level]: ...

    def __getitem__(self, index: int | slice) -> Level | list[Level]:
        chosen = range(len(self))[index]
        return self._level(chosen) if isinstance(chosen, int) else [self._level(k) for k in chosen]

    def _level(self, k: int) -> Level:
        if k not in self._cached:
            level = self._levels.level(k)
            if level is None:
                raise LookupError("the finest level is cut into tiles: export it as 3D Tiles")
            source, facts = level
            bound = bound_of(json.loads(facts))
            self._cached[k] = Level(registered.mesh._of_source(source, bound), bound, self.distances[k])
        return self._cached[k]

    def export(self, path: str | os.PathLike[str]) -> Report:
        """Write all levels and return the report: one glTF if the name ends in .glb or .gltf (`MSFT_lod`), else a folder of
        3D Tiles with its `tileset.json`.

        Existing files are replaced atomically; `tileset.json` is the last one.
        """
        name = os.fspath(path)
        extension = os.path.splitext(name)[1].lower().lstrip(".")
        report = self.report
        if extension in ("glb", "gltf"):
            content = self._levels.write(extension)
            _files.replace(path, content)
        elif extension:
            raise ValueError(f"path: levels are written as .glb, .gltf, or into a folder as 3D Tiles: {_files.shown(path)}")
        else:
            content, beside = self._levels.tileset()
            os.makedirs(name, exist_ok=True)
            for file_name, file_content in beside:
                _files.replace(os.path.join(name, file_name), file_content)
            _files.replace(os.path.join(name, "tileset.json"), content)
        report["run"].update(output=_files.shown(path), bytes=len(content))
        return report

    def to_bytes(self, format: Literal["glb", "gltf"]) -> bytes:
        """One glTF of all levels, as `export` writes it."""
        return self._levels.write(format)

    def _repr_html_(self) -> str:
        def row(facts: dict[str, Any]) -> tuple[str, str, str, str]:
            start = "" if facts["distance"] is None else f"{facts['distance']:.6g}"
            most = "" if facts["at_most"] is None else f"{facts['at_most']:.3g}"
            return f"{facts['triangles']:,}", most, str(facts["evidence"]), start

        title = f"Levels, against the {self.bound.reference}"
        return columns(title, ("triangles", "off at most", "evidence", "from distance"), map(row, self._rows()))

    def __repr__(self) -> str:
        counts = ", ".join(f"{row['triangles']:,}" for row in self._rows()[:6])
        more = ", …" if len(self) > 6 else ""
        return f"<Levels: {len(self)} of {counts}{more} triangles; the finest {self.bound.sentence()}>"


class Levelled(Sourced):
    """Shapes with a surface, which can have levels of detail."""

    __slots__ = ()

    @keywords_hinted
    def lod(
        self,
        *,
        pixels: SupportsFloat = 1,
        view: str | View = "1920x1080 fov=60",
        nearest: SupportsFloat | None = None,
        tol: Length | None = None,
        rel: Share | None = None,
        distances: Iterable[SupportsFloat] = (),
        uv_error: SupportsFloat | None = None,
        normal_error: SupportsFloat | None = None,
        normals: str | None = None,
        errors: Literal["scaled", "plain"] = "scaled",
        tile_triangles: SupportsIndex | None = None,
        merge: bool = False,
        at: str | None = None,
        quantize: bool = False,
        compress: Literal["meshopt"] | None = None,
        no_source: bool = False,
        progress: Progress | None = None,
    ) -> Levels:
        """Levels of detail for every distance, each proved against the shape itself and with an error of at most `pixels` on
        the screen.

        `view` is the screen and the lens. `nearest` is the least distance of the eye from the shape's box; or `tol` or `rel` is
        the budget of the finest level. Without any of them, the nearest eye is where the box fills the height of the screen.
        `distances` adds rows to the table in the report. `merge` merges all parts into one mesh, so that small ones can vanish
        into others.

        For 3D Tiles, `tile_triangles` cuts a finest level with more triangles into tiles; `at` is the place on the Earth, as
        in "47.37,8.54,400"; and `errors` is the kind of geometric error: "scaled", with which the formula of viewers keeps the
        error in pixels everywhere on the screen, or "plain". `quantize`, `compress` and `no_source` are as for `Mesh.export`.

        Raises as `Shape.mesh`: `BudgetUnmet` with the levels if the finest is not within its budget. Docs: `docs/lod.md`.

        >>> import chordal
        >>> ring = chordal.shapes.arc(0.5, center=(2, 0)).revolve()
        >>> levels = ring.lod(pixels=1, tol=0.01)
        >>> len(levels) > 3 and len(levels[0].mesh.faces) > 2 * len(levels[2].mesh.faces)
        True
        >>> levels.at(1e6).bound.at_most <= ring.mesh(triangles=40).bound.at_most * 40
        True
        """
        numbers = [repr(number("distances", distance)) for distance in distances]
        given = options(
            LOD,
            pixels=pixels,
            view=words_of(view),
            nearest=nearest,
            distances=",".join(numbers) or None,
            uv_error=uv_error,
            normal_error=normal_error,
            normals=normals,
            errors=errors,
            tile_triangles=tile_triangles,
            merge=merge,
            at=at,
        )
        arguments: _chordal.LodArguments = {
            "options": [*length_options(tol, rel), *given],
            "tiles": tile_triangles is not None,
            "output": options(OUTPUT, quantize=quantize, compress=compress, no_source=no_source),
        }
        levels = _levels_of(self, arguments, function("progress", progress))
        unmet = levels._levels.unmet
        if unmet is not None:
            raise BudgetUnmet(unmet, levels)
        return levels


def _levels_of(
    shape: Sourced, arguments: _chordal.LodArguments, progress: Callable[[str, int, int], object] | None = None
) -> Levels:
    return Levels(_chordal.levels(shape._source, arguments, progress), (_levels_of, (shape, arguments), {}))
