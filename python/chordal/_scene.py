"""The content of a scene: `Part`, `Node`, and the `Attribute` of a part."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

from chordal import _chordal
from chordal._hints import Guessed
from chordal._html import table

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    _Kind = Literal["normal", "tangent", "uv", "color", "group", "custom", "blended"]
    _Domain = Literal["vertex", "corner", "face"]


@dataclass(frozen=True, eq=False)
class Attribute:
    """Data of a mesh's vertices, corners or faces, other than positions.

    >>> import chordal
    >>> one = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], uv=[(0, 0), (1, 0), (0, 1)])
    >>> one.attributes
    (<Attribute: uv, one row for each vertex, (3, 2)>,)
    """

    #: The kind of data: "normal", "tangent", "uv", "color", "group" (the number of a material or group), "custom" (any other
    #: data of the file), or "blended" (morph targets and weights of joints).
    kind: _Kind
    #: The number of the set of texture coordinates or colours, or a name.
    of: int | str | None
    #: The elements that have a row: "vertex"; "corner", with three rows for each face; or "face".
    domain: _Domain
    #: The rows: n, or n × k. Not copied, read-only.
    values: NDArray[np.float64]

    def __repr__(self) -> str:
        name = self.kind if self.of in (None, 0) else f"{self.kind} {self.of}"
        return f"<Attribute: {name}, one row for each {self.domain}, {self.values.shape}>"


@dataclass(frozen=True)
class Node:
    """A node of a scene, which places a part.

    >>> import chordal
    >>> one = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    >>> one.nodes[one.roots[0]].part
    0
    """

    #: The name in the file, or empty.
    name: str
    #: The index of the part that it shows, if it shows one.
    part: int | None
    #: The indices of its children.
    children: tuple[int, ...]
    #: Its 4 × 4 matrix, rows first, from its own space to that of its parent.
    matrix: tuple[tuple[float, float, float, float], ...]


class Part(Guessed):
    """One mesh of a scene, in its own coordinates. `Mesh.parts` has all of them.

    >>> import chordal
    >>> one = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    >>> one.parts[0].vertices.shape, one.parts[0].attribute("normal")
    ((3, 3), None)
    """

    __slots__ = ("_facts", "_index", "_source")

    def __init__(self, source: _chordal.Source, index: int, facts: dict[str, Any]) -> None:
        self._source: Final = source
        self._index: Final = index
        self._facts: Final = facts

    @property
    def name(self) -> str:
        """The name in the file, or empty."""
        return str(self._facts["name"])

    @property
    def vertices(self) -> NDArray[np.float64]:
        """The positions, n × 3. Not copied, read-only."""
        return self._array("vertices")

    @property
    def faces(self) -> NDArray[np.int32]:
        """The vertices of each face, m × 3, counter-clockwise from its front. Not copied, read-only."""
        return self._array("faces")

    @property
    def attributes(self) -> tuple[Attribute, ...]:
        """Normals, texture coordinates, colours, materials, and any other data of the file."""
        return attributes_of(self._facts, lambda k: self._array("attribute", k))

    def attribute(self, kind: _Kind, of: int | str | None = None) -> Attribute | None:
        """The attribute of a kind, the first one or the one with a number or name; None if there is none."""
        return first_of(self.attributes, kind, of)

    @property
    def normals(self) -> NDArray[np.float64] | None:
        """Its normals: n × 3, or 3 m × 3 for corners; None if there are none."""
        return self._values("normal")

    @property
    def uv(self) -> NDArray[np.float64] | None:
        """Its first texture coordinates, n × 2 or, for corners, 3 m × 2, with v up; None if there are none."""
        return self._values("uv")

    @property
    def colors(self) -> NDArray[np.float64] | None:
        """Its first colours, n × 3 or n × 4, from 0 to 1; None if there are none."""
        return self._values("color")

    @property
    def bounds(self) -> NDArray[np.float64]:
        """The lowest and the highest corner of its box in its own coordinates, 2 × 3."""
        return bounds_of(self.vertices)

    def __copy__(self) -> Part:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Part:
        return self

    def __reduce__(self) -> Any:
        # Of the scene its own part goes along and no other.
        text, blocks = _chordal.scene_state(self._source)
        facts = json.loads(text)
        part = facts["parts"][self._index]
        kept: list[bytes] = []
        for holder, key in numbers_in(part):
            kept.append(blocks[holder[key]])
            holder[key] = len(kept) - 1
        state = {"parts": [part], "frame": facts["frame"]}
        return _again, (json.dumps(state), kept)

    def _values(self, kind: _Kind) -> NDArray[np.float64] | None:
        attribute = self.attribute(kind)
        return None if attribute is None else attribute.values

    def _array(self, name: str, attribute: int | None = None) -> NDArray[Any]:
        import numpy as np

        return np.asarray(_chordal.scene_array(self._source, self._index, name, attribute))

    def _repr_html_(self) -> str:
        rows = [("size", f"{self._facts['faces']:,} triangles, {self._facts['vertices']:,} vertices")]
        for one in self.attributes:
            of = "" if one.of is None else f" {one.of}"
            rows.append((f"{one.kind}{of}", f"{' × '.join(str(n) for n in one.values.shape)}, by {one.domain}"))
        return table(f"Part {self.name}".strip(), rows)

    def __repr__(self) -> str:
        name = f" {self.name!r}" if self.name else ""
        return f"<Part{name}: {self._facts['faces']:,} triangles, {self._facts['vertices']:,} vertices>"


def _again(state: str, blocks: list[bytes]) -> Part:
    """Restores a pickled part, as the only one of its scene."""
    source = _chordal.scene_of_state(state, blocks, None)
    return Part(source, 0, json.loads(_chordal.scene_facts(source))["parts"][0])


def numbers_in(part: dict[str, Any]) -> list[tuple[dict[str, Any], str]]:
    """The entries of a part's state that refer to blocks of numbers, as pairs of a dictionary and a key."""
    geometry = [(part, name) for name in ("positions", "faces", "position_id") if part.get(name) is not None]
    marks = [accessor for mark in part.get("marks", ()) for accessor in mark["accessors"]]
    return geometry + [(holder, "block") for holder in (*part["attributes"], *marks)]


class SeveralPartsError(AttributeError, ValueError):
    """The error for data of the only part of a scene, if the scene has another number of parts. It is an `AttributeError`, so
    that code which inspects all attributes of an object skips it.
    """

    def __init__(self, count: int) -> None:
        what = "nothing is in it" if count == 0 else "look at those of mesh.parts, as in mesh.parts[0].uv"
        super().__init__(f"this scene has {count} parts: {what}")


def attributes_of(part: dict[str, Any], values: Callable[[int], NDArray[Any]]) -> tuple[Attribute, ...]:
    """The attributes of a part; `values` returns the rows of the k-th. Texture coordinates have v up, whatever the file has."""

    def read(k: int, kind: str) -> NDArray[Any]:
        import numpy as np

        rows = values(k)
        if kind != "uv" or not part["v_is_down"]:
            return rows
        flipped: NDArray[Any] = np.array([0.0, 1.0]) + rows * np.array([1.0, -1.0])
        flipped.flags.writeable = False
        return flipped

    return tuple(
        Attribute(facts["kind"], facts["of"], facts["domain"], read(k, facts["kind"]))
        for k, facts in enumerate(part["attributes"])
    )


def first_of(attributes: tuple[Attribute, ...], kind: _Kind, of: int | str | None = None) -> Attribute | None:
    """The attribute of a kind, the first one or the one with a number or name."""
    number_or_name = of if of is not None or kind not in ("uv", "color") else 0
    matches = (a for a in attributes if a.kind == kind and (number_or_name is None or a.of == number_or_name))
    return next(matches, None)


def bounds_of(vertices: NDArray[np.float64]) -> NDArray[np.float64]:
    """The lowest and the highest corner of the bounding box of points."""
    import numpy as np

    if len(vertices) == 0:
        raise ValueError("an empty mesh has no bounds: nothing is in it")
    return np.array([vertices.min(axis=0), vertices.max(axis=0)])


def nodes_of(facts: dict[str, Any]) -> tuple[Node, ...]:
    """The nodes of a scene."""

    def rows(matrix: list[float]) -> Any:
        return tuple(tuple(float(matrix[4 * column + row]) for column in range(4)) for row in range(4))

    return tuple(
        Node(node["name"], node["part"], tuple(node["children"]), rows(node["matrix"])) for node in facts["nodes"]
    )
