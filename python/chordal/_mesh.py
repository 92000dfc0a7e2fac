"""`Mesh`: triangles with their bound."""

from __future__ import annotations

import html
import json
import os
from typing import TYPE_CHECKING, Any, Final

from chordal import _chordal, _files
from chordal._bound import Bound, bound_of
from chordal._errors import BudgetUnmet

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Mesh:
    """Triangles with their bound. `Shape.mesh` makes it; it does not change.

    >>> import chordal
    >>> mesh = chordal.load(b"v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n", format="obj").mesh(tol=0.1)
    >>> mesh.faces
    array([[0, 1, 2]], dtype=int32)
    >>> mesh.report["certificate"]["valid"]["boundary_edges"]
    3
    """

    __slots__ = ("_triangles", "_report")

    def __init__(self, triangles: _chordal.Triangles) -> None:
        self._triangles: Final = triangles
        self._report: Final = triangles.report

    @property
    def vertices(self) -> NDArray[np.float64]:
        """The coordinates, n × 3. Nothing is copied, so it is for reading only; `.copy()` can be written to."""
        import numpy as np

        return np.asarray(self._triangles.vertices)

    @property
    def faces(self) -> NDArray[np.int32]:
        """Indices into the vertices, m × 3, counter-clockwise seen from the front. Not copied, for reading only."""
        import numpy as np

        return np.asarray(self._triangles.faces)

    @property
    def bound(self) -> Bound:
        """How far the mesh is from the true shape, and how that is known."""
        return bound_of(self.report["certificate"]["bound"])

    @property
    def report(self) -> dict[str, Any]:
        """The report of `chordal mesh --json`, which `docs/schema` describes. It is yours to change."""
        report: dict[str, Any] = json.loads(self._report)
        return report

    def to_bytes(self, format: str) -> bytes:
        """The file of that format, as `export` writes it."""
        return self._for(format).write()

    def export(self, path: str | os.PathLike[str]) -> dict[str, Any]:
        """Write a file, in the format that its extension names, and return the report on what is in it.

        A file of that name is replaced, by a whole one and at the end. GLB and STL hold single precision. Their
        rounding counts against the budget, so for them the shape is meshed again, a little finer; the file is then
        the same, byte for byte, as that of the command.
        """
        extension = os.path.splitext(os.fspath(path))[1].lstrip(".")
        if not extension:
            raise ValueError(f"path: the name does not say the format: {_files.shown(path)}")
        written = self._for(extension)
        content = written.write()
        _files.replace(path, content)
        report: dict[str, Any] = json.loads(written.report)
        report["run"].update(output=_files.shown(path), bytes=len(content))
        return report

    def _for(self, format: str) -> _chordal.Triangles:
        remade = self._triangles.remake(format)
        # The best of a budget that was not met may be written all the same: its owner knows.
        return remade if self._triangles.unmet is not None else made(remade)._triangles

    def __repr__(self) -> str:
        return f"<Mesh: {self._counts()}; {self.bound.sentence()}>"

    def _repr_html_(self) -> str:
        rows = (("mesh", self._counts()), ("bound", self.bound.sentence()))
        cells = "".join(f"<tr><th>{name}</th><td>{html.escape(text)}</td></tr>" for name, text in rows)
        return f"<table>{cells}</table>"

    def _counts(self) -> str:
        output = self.report["certificate"]["output"]
        n_triangles, n_vertices = output["triangles"], output["vertices"]
        triangles = f"{n_triangles:,} triangle{'' if n_triangles == 1 else 's'}"
        return f"{triangles}, {n_vertices:,} {'vertex' if n_vertices == 1 else 'vertices'}"


def made(triangles: _chordal.Triangles) -> Mesh:
    """The mesh, if it meets its budget."""
    mesh = Mesh(triangles)
    if triangles.unmet is not None:
        raise BudgetUnmet(triangles.unmet, mesh)
    return mesh
