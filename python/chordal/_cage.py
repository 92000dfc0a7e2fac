"""`Cage`: polygons that stand for the smooth surface to which refining them tends."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from operator import index
from typing import TYPE_CHECKING, Any, Final, Literal, SupportsFloat, SupportsIndex

from chordal import _chordal
from chordal._arguments import text
from chordal._arrays import coordinates, indices
from chordal._hints import Guessed

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from chordal._shape import Shape


class Cage(Guessed):
    """A polygon cage: a mesh that refining makes smooth. It does not change.

    `positions` is n × 3; `faces` are lists of three vertices or more, counter-clockwise from their front, or m × k indices.
    `creases` are edges (a, b, sharpness) and `corners` vertices (v, sharpness): sharp for so many rounds, for ever from 10 on.
    `holes` are faces without surface. `boundary` says what becomes of the border, `creasing` how sharpness falls.

    Raises `ValueError` where that is no cage, and says why.

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
        made = cls.__new__(cls)
        object.__setattr__(made, "_cage", cage)
        return made

    def refined(self, levels: SupportsIndex = 1) -> Cage:
        """The cage after so many rounds: the same smooth surface, four times as many faces a round.

        The vertices of the cage come first, under their numbers; the parts of a face follow those of the face before it.
        What is left of creases and corners is kept. Raises `Refused` where that would be too much.
        """
        rounds = index(levels)
        if not 0 <= rounds < 2**32:
            raise ValueError(f"levels: a whole number of at least 0, not {rounds}")
        return Cage._of(self._cage.refined(rounds))

    def shape(self, *, unit: str | None = None) -> Shape:
        """The cage as a `Shape`, to be inspected or meshed within a budget. `unit` is the unit of its coordinates."""
        from chordal._shape import Shape

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
        """n × 3, not copied and not to be written to."""
        import numpy as np

        return np.asarray(self._cage.array("positions"))

    @property
    def faces(self) -> NDArray[np.int32] | list[NDArray[np.int32]]:
        """m × k indices where all faces have k corners, as after a round; else a list of one array a face."""
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
        """Where each face begins in `indices`, and at the end the number of all of them."""
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
        """By which rules it is refined."""
        return self._cage.rules[0]

    @property
    def boundary(self) -> str:
        """What becomes of its border."""
        return self._cage.rules[1]

    @property
    def creasing(self) -> str:
        """How sharpness falls."""
        return self._cage.rules[2]

    def __repr__(self) -> str:
        n_faces, n_vertices = len(self.offsets) - 1, len(self.positions)
        faces = f"{n_faces} face{'' if n_faces == 1 else 's'}"
        return f"<Cage: {faces}, {n_vertices} vert{'ex' if n_vertices == 1 else 'ices'}, {self.scheme}>"


def _row(name: str, value: SupportsIndex) -> int:
    found = index(value)
    if not 0 <= found < 2**32:
        raise ValueError(f"{name}: {found} is no index")
    return found


def _flattened(faces: ArrayLike | Iterable[Sequence[int]]) -> tuple[NDArray[np.uint32], NDArray[np.int64]]:
    """The corners of all faces, and where those of each end."""
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
    """A cage that was pickled."""
    rows = flat.tolist()
    faces = [rows[start:end] for start, end in zip(offsets[:-1], offsets[1:], strict=True)]
    return Cage(positions, faces, **tags)
