"""`Mesh`: triangles with their bound."""

from __future__ import annotations

from typing import TYPE_CHECKING

from chordal._made import Made, counted

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Mesh(Made):
    """Triangles with their bound. `Shape.mesh` makes it; it does not change.

    >>> import chordal
    >>> mesh = chordal.load(b"v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n", format="obj").mesh(tol=0.1)
    >>> mesh.faces
    array([[0, 1, 2]], dtype=int32)
    >>> mesh.report["certificate"]["valid"]["boundary_edges"]
    3
    """

    __slots__ = ()

    @property
    def vertices(self) -> NDArray[np.float64]:
        """The coordinates, n × 3. Nothing is copied, so it is for reading only; `.copy()` can be written to."""
        return self._array("vertices")

    @property
    def faces(self) -> NDArray[np.int32]:
        """Indices into the vertices, m × 3, counter-clockwise seen from the front. Not copied, for reading only."""
        return self._array("faces")

    def _size(self) -> str:
        output = self.report["certificate"]["output"]
        vertices = counted(output["vertices"], "vertex", "vertices")
        return f"{counted(output['triangles'], 'triangle', 'triangles')}, {vertices}"
