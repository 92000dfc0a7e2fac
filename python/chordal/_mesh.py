"""`Mesh`: triangles with their bound."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, SupportsFloat

from chordal._bake import Bakeable
from chordal._budget import Length
from chordal._combine import Combinable
from chordal._deviation import Deviation, measured
from chordal._made import Made, counted

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from chordal._shape import Shape


class Mesh(Made, Combinable, Bakeable):
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

    def deviation(
        self,
        other: Shape | Mesh,
        *,
        relative: SupportsFloat = 0.1,
        absolute: Length | None = None,
        max: Length | None = None,
        progress: Callable[[str, int, int], object] | None = None,
    ) -> Deviation:
        """How far this shape and another one are apart, both ways: an interval that is proved.

        The upper end is at most the share `relative` above the lower one, or the length `absolute`. With `max` only the
        side of that limit matters, and `verdict` says it. Lengths are in units, or texts as in "0.1mm" or "0.05%", a
        share of the diagonal of the other shape's box. Patches are meshed on the way, which is added at both ends.

        Other threads, Ctrl-C and `progress` are as for `Shape.mesh`. Raises `Refused` where a shape has no surface.

        >>> import chordal
        >>> one = chordal.triangles([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
        >>> two = chordal.triangles([(0, 0, 2), (1, 0, 2), (0, 1, 2)], [(0, 1, 2)])
        >>> found = one.deviation(two)
        >>> found.bound.at_least <= 2 <= found.bound.at_most
        True
        """
        return measured(
            self._outcome, other, relative=relative, absolute=absolute, max=max, progress=progress
        )

    def _size(self) -> str:
        output = self.report["certificate"]["output"]
        vertices = counted(output["vertices"], "vertex", "vertices")
        return f"{counted(output['triangles'], 'triangle', 'triangles')}, {vertices}"
