"""`Cage`: control polygons of a subdivision surface."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from operator import index
from typing import TYPE_CHECKING, Any, Final, Literal, SupportsFloat, SupportsIndex

from chordal import _chordal
from chordal._arguments import text
from chordal._arrays import coordinates, indices
from chordal._hints import Guessed
from chordal._registry import registered
from chordal._shape import Shape

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


class Cage(Guessed):
    """A control cage: a polygon mesh whose refinement converges to a smooth surface. It is immutable.

    `positions` is n × 3; `faces` are lists of three or more vertices, counter-clockwise from their front, or m × k indices.
    `creases` are edges (a, b, sharpness) and `corners` vertices (v, sharpness), sharp for so many rounds of refinement, and
    forever from 10 on. `holes` are faces without surface. `boundary` is the rule for borders, and `creasing` the rule by
    which sharpness decreases.

    Raises `ValueError` with the reason if they do not form a cage.

    >>> import chordal
    >>> points = [(0, 0, 0), (1, 0, 0), (2, 0, 1), (0, 1, 0), (1, 1, 0), (2, 1, 1)]
    >>> sheet = chordal.Cage(points, [(0, 1, 4, 3), (1, 2, 5, 4)], creases=[(1, 4, 2.5)])
    >>> sheet.refined(2)
    <Cage: 32 faces, 45 vertices, catmull-clark>
    >>> sheet.refined(1).creases
    [(1, 7, 1.5), (4, 7, 1.5)]
    """

    __slots__ = ("_cage",)

    def __init__(
        self,
        positions: ArrayLike,
        faces: ArrayLike | Iterable[Sequence[int]],
        *,
        creases: Iterable[tuple[SupportsIndex, SupportsIndex, SupportsFloat]] = (),
        corners: Iterable[tuple[SupportsIndex, SupportsFloat]] = (),
        holes: Iterable[SupportsIndex] = (),
        scheme: Literal["catmull-clark", "loop", "bilinear"] = "catmull-clark",
        boundary: Literal["none", "edge-only", "edge-and-corner"] = "edge-only",
        creasing: Literal["uniform", "chaikin"] = "uniform",
    ) -> None:
        points = coordinates("positions", positions)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ValueError(f"positions: rows of 3, as in (n, 3), not {points.shape}")
        flat, ends = _flattened(faces)
        tags: _chordal.Tags = {
            "creases": [(_row("creases", a), _row("creases", b), float(sharp)) for a, b, sharp in creases],
            "corners": [(_row("corners", vertex), float(sharp)) for vertex, sharp in corners],
            "holes": [_row("holes", face) for face in holes],
            "scheme": scheme,
            "boundary": boundary,
            "creasing": creasing,
        }
        self._cage: Final = _chordal.Cage(points.tobytes(), flat.tobytes(), ends.tobytes(), tags)

    @classmethod
    def _of(cls, cage: _chordal.Cage) -> Cage:
        wrapped = cls.__new__(cls)
        object.__setattr__(wrapped, "_cage", cage)
        return wrapped

    def refined(self, levels: SupportsIndex = 1) -> Cage:
        """The cage after some rounds of refinement: the same smooth surface, with four times as many faces in each round.

        The vertices of the cage come first, with the same indices; the children of faces are in the order of the faces.
        Creases and corners keep their remaining sharpness. Raises `Refused` if the result would be too large.
        """
        rounds = index(levels)
        if not 0 <= rounds < 2**32:
            raise ValueError(f"levels: a whole number of at least 0, not {rounds}")
        return Cage._of(self._cage.refined(rounds))

    def shape(self, *, unit: str | None = None) -> Shape:
        """The cage as a `Shape`, to inspect it or to mesh it within a budget. `unit` is the unit of its coordinates."""
        return Shape(self._cage.source(text("unit", unit)), (Cage.shape, (self,), {"unit": unit}))

    def __reduce__(self) -> Any:
        scheme, boundary, creasing = self._cage.rules
        tags = {"creases": self.creases, "corners": self.corners, "holes": self.holes}
        tags |= {"scheme": scheme, "boundary": boundary, "creasing": creasing}
        return _again, (self.positions, self.indices, self.offsets, tags)

    def __copy__(self) -> Cage:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Cage:
        return self

    @property
    def positions(self) -> NDArray[np.float64]:
        """The positions of the vertices, n × 3. Not copied, read-only."""
        import numpy as np

        return np.asarray(self._cage.array("positions"))

    @property
    def faces(self) -> NDArray[np.int32] | list[NDArray[np.int32]]:
        """m × k indices if all faces have k corners, as after a round of refinement; else a list with an array for each face."""
        import numpy as np

        flat, offsets = self.indices, self.offsets
        sizes = np.diff(offsets)
        if len(sizes) and (sizes == sizes[0]).all():
            rows: NDArray[np.int32] = flat.reshape(len(sizes), int(sizes[0]))
            return rows
        return [flat[start:end] for start, end in zip(offsets[:-1], offsets[1:], strict=True)]

    @property
    def indices(self) -> NDArray[np.int32]:
        """The vertices of all faces, one face after the other, not copied."""
        import numpy as np

        return np.asarray(self._cage.array("indices"))

    @property
    def offsets(self) -> NDArray[np.int64]:
        """The index into `indices` at which each face begins, and finally their number."""
        import numpy as np

        return np.asarray(self._cage.array("offsets"))

    @property
    def creases(self) -> list[tuple[int, int, float]]:
        """Sharp edges (a, b, sharpness), a below b, in ascending order."""
        return self._cage.creases

    @property
    def corners(self) -> list[tuple[int, float]]:
        """Sharp vertices (v, sharpness), in ascending order."""
        return self._cage.corners

    @property
    def holes(self) -> list[int]:
        """Faces without surface, in ascending order."""
        return self._cage.holes

    @property
    def scheme(self) -> str:
        """The subdivision scheme."""
        return self._cage.rules[0]

    @property
    def boundary(self) -> str:
        """The rule for borders."""
        return self._cage.rules[1]

    @property
    def creasing(self) -> str:
        """The rule by which sharpness decreases."""
        return self._cage.rules[2]

    def __repr__(self) -> str:
        n_faces, n_vertices = len(self.offsets) - 1, len(self.positions)
        faces = f"{n_faces} face{'' if n_faces == 1 else 's'}"
        return f"<Cage: {faces}, {n_vertices} vert{'ex' if n_vertices == 1 else 'ices'}, {self.scheme}>"


def _row(name: str, value: SupportsIndex) -> int:
    row = index(value)
    if not 0 <= row < 2**32:
        raise ValueError(f"{name}: {row} is no index")
    return row


def _flattened(faces: ArrayLike | Iterable[Sequence[int]]) -> tuple[NDArray[np.uint32], NDArray[np.int64]]:
    """The corners of all faces, and the end of each face in that list."""
    import numpy as np

    if isinstance(faces, np.ndarray):
        rows = indices("faces", faces)
        if rows.ndim != 2:
            raise ValueError(f"faces: m × k indices, or a list of lists, not {rows.shape}")
        return rows.reshape(-1), np.arange(1, len(rows) + 1, dtype=np.int64) * rows.shape[1]
    lists = [indices("faces", face) for face in faces]  # type: ignore[union-attr]
    for number, face in enumerate(lists):
        if face.ndim != 1 and face.size:
            raise ValueError(f"faces: face {number} is no list of indices")
    flat = np.concatenate([face.reshape(-1) for face in lists]) if lists else np.zeros(0, np.uint32)
    return flat, np.cumsum([face.size for face in lists], dtype=np.int64)


def _again(positions: Any, flat: Any, offsets: Any, tags: Any) -> Cage:
    """Restores a pickled cage."""
    rows = flat.tolist()
    faces = [rows[start:end] for start, end in zip(offsets[:-1], offsets[1:], strict=True)]
    return Cage(positions, faces, **tags)


registered.cage = Cage
