"""`Mesh`: triangles with their bound."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Literal

from chordal import _chordal
from chordal._arguments import text
from chordal._arrays import coordinates, indices
from chordal._bound import Bound, bound_of
from chordal._convert import refuse_unknown
from chordal._corners import warn_of_soup, welded
from chordal._curvature import curvatures
from chordal._hints import keywords_hinted
from chordal._interop import Interoperable
from chordal._made import Form, counted, of_outcome, remade
from chordal._notebook import Shown, html_of
from chordal._pieces import Splittable
from chordal._report import Report
from chordal._scene import Attribute, Node, Part, SeveralPartsError, attributes_of, bounds_of, first_of, nodes_of
from chordal._shape import Shape
from chordal._transform import Transformable

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from chordal._budget import Length
    from chordal._convert import Written
    from chordal._field import Field
    from chordal._scene import _Kind


class Mesh(Shape, Interoperable, Transformable, Splittable):
    """Triangles: made within a budget, with their bound, read from a file, or given as arrays. It does not change.

    `Mesh(vertices, faces)` takes n × 3 coordinates and m × 3 indices into them; counter-clockwise is the front. Any real
    numbers and any integers will do; they are copied. `normals` are n × 3, `uv` n × 2 with v up, `colors` n × 3 or n × 4:
    floats from 0 to 1, or bytes. `unit` is the unit of the coordinates, for lengths with a unit. `weld` makes vertices one that
    are equal in everything, and ties those of equal positions; without it a `UserWarning` says where no two triangles share a
    vertex.

    >>> import chordal
    >>> one = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    >>> one.faces
    array([[0, 1, 2]], dtype=int32)
    >>> one.area
    0.5
    >>> one.mesh(tol=0.1).report["certificate"]["valid"]["boundary_edges"]
    3
    """

    __slots__ = ("_bound", "_cached", "_is_given", "_outcome", "_told")

    @keywords_hinted
    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uv: ArrayLike | None = None,
        colors: ArrayLike | None = None,
        unit: str | None = None,
        weld: bool = False,
    ) -> None:
        points, rows = coordinates("vertices", vertices), indices("faces", faces)
        for name, array in (("vertices", points), ("faces", rows)):
            if array.ndim != 2 or array.shape[1] != 3:
                raise ValueError(f"{name}: rows of 3, as in (n, 3), not {array.shape}")
        named: list[tuple[str, NDArray[np.float64]]] = []
        for kind, given, widths in (("normal", normals, (3,)), ("uv", uv, (2,)), ("color", colors, (3, 4))):
            if given is None:
                continue
            values = _colors(given) if kind == "color" else coordinates(kind, given)
            if values.ndim != 2 or values.shape[0] != len(points) or values.shape[1] not in widths:
                raise ValueError(f"{kind}: a row of {widths[0]} for each of {len(points)} vertices, not {values.shape}")
            named.append((kind, values))
        tied = None
        if weld and (rows.size == 0 or int(rows.max()) < len(points)):
            kept, rows, tied = welded(points, rows, [values for _, values in named])
            points, named = points[kept] + 0.0, [(kind, values[kept]) for kind, values in named]
        elif not weld:
            warn_of_soup(points, rows)
        blocks, attributes = [points.tobytes(), rows.tobytes()], []
        for kind, values in named:
            of = None if kind == "normal" else 0
            width = values.shape[1]
            attributes.append({"kind": kind, "of": of, "domain": "vertex", "width": width, "block": len(blocks)})
            blocks.append(values.tobytes())
        part: dict[str, Any] = {"name": "triangles", "positions": 0, "faces": 1, "attributes": attributes}
        if tied is not None:
            part["position_id"] = len(blocks)
            blocks.append(tied.tobytes())
        frame = {"texture_origin": "lower-left" if uv is not None else None}
        state = json.dumps({"parts": [part], "frame": frame})
        self._set(_chordal.scene_of_state(state, blocks, text("unit", unit)), None, None, None)
        self._is_given = True

    def _set(
        self, source: _chordal.Source | None, outcome: _chordal.Outcome | None, bound: Bound | None, report: str | None
    ) -> None:
        self._held = source
        self._recipe = None
        self._outcome = outcome
        self._is_given = False
        self._bound = bound
        self._told = report
        self._cached: dict[str, Any] = {}

    @classmethod
    def _of_source(cls, source: _chordal.Source, bound: Bound | None = None, report: str | None = None) -> Mesh:
        """Triangles that were read, or that are known to be this far from what they stand for."""
        made = cls.__new__(cls)
        made._set(source, None, bound, report)
        return made

    @classmethod
    def _of(cls, outcome: _chordal.Outcome) -> Mesh:
        """Triangles that were made, if they meet their budget."""
        return of_outcome(outcome, cls._unjudged)

    @classmethod
    def _unjudged(cls, outcome: _chordal.Outcome) -> Mesh:
        made = cls.__new__(cls)
        made._set(None, outcome, None, None)
        return made

    @property
    def _text(self) -> str | None:
        """Its report; None where nothing was made."""
        if self._told is None and self._outcome is not None:
            self._told = self._outcome.report
        return self._told

    @property
    def _source(self) -> _chordal.Source:
        if self._held is None:
            assert self._outcome is not None
            self._held = self._outcome.source()
        return self._held

    @property
    def kind(self) -> str:
        """"triangles"."""
        return "triangles"

    @property
    def format(self) -> str:
        """The format that it was read from, as in "glb"; "arrays" for triangles that were given as such."""
        return "arrays" if self._is_given else self._source.format

    @property
    def bound(self) -> Bound:
        """How far it is from the true shape, and how that is known. Triangles that were read or given are the truth
        themselves; those of a file that says how far they are from another are `report`ed on.
        """
        if self._bound is not None:
            return self._bound
        facts = None if self._text is None else json.loads(self._text)["certificate"]["bound"]
        if facts is None:
            return Bound(0.0, 0.0, "proved", "hausdorff", "input triangles")
        return bound_of(facts)

    @property
    def report(self) -> Report:
        """The report of `chordal mesh --json` on what was made, else that of `chordal inspect`. It is yours to change."""
        return self.inspect() if self._text is None else Report(json.loads(self._text))

    @property
    def vertices(self) -> NDArray[np.float64]:
        """The positions of all that is shown, n × 3. Not copied where there is one part, for reading only."""
        return self._array("vertices")

    @property
    def faces(self) -> NDArray[np.int32]:
        """The vertices of each face, m × 3, counter-clockwise from its front. As `vertices`, and in the order of a file."""
        return self._array("faces")

    @property
    def parts(self) -> tuple[Part, ...]:
        """The meshes of the scene, each in its own coordinates and with its attributes."""
        facts = self._scene["parts"]
        return tuple(Part(self._source, k, part) for k, part in enumerate(facts))

    @property
    def nodes(self) -> tuple[Node, ...]:
        """Where the parts stand; `roots` are those without a parent."""
        return nodes_of(self._scene)

    @property
    def roots(self) -> tuple[int, ...]:
        """The indices of nodes without a parent."""
        return tuple(self._scene["roots"])

    @property
    def materials(self) -> list[dict[str, Any]]:
        """The materials, as glTF describes them. Number n of an attribute "group" of "material" is `materials[n - 1]`."""
        found: list[dict[str, Any]] = json.loads(json.dumps(self._scene["materials"]))
        return found

    @property
    def textures(self) -> list[dict[str, Any]]:
        """The textures that materials name, as glTF describes them: each with the index of one of `images` as its "source"."""
        found: list[dict[str, Any]] = json.loads(json.dumps(self._scene["textures"]))
        return found

    @property
    def images(self) -> tuple[bytes | None, ...]:
        """The pictures of the textures, as files of PNG, JPEG or WebP; None for one in another file that was not opened."""
        return tuple(_chordal.scene_image(self._source, k) for k in range(self._scene["images"]))

    @property
    def attributes(self) -> tuple[Attribute, ...]:
        """The attributes of the only part, in the space of the scene; of several, `parts[k].attributes` are those of each."""
        if "attributes" not in self._cached:
            import numpy as np

            parts = self._scene["parts"]
            if len(parts) != 1:
                raise SeveralPartsError(len(parts))
            array = _chordal.scene_array
            self._cached["attributes"] = attributes_of(
                parts[0], lambda k: np.asarray(array(self._source, None, "attribute", k))
            )
        found: tuple[Attribute, ...] = self._cached["attributes"]
        return found

    @property
    def normals(self) -> NDArray[np.float64] | None:
        """The normals of the only part: n × 3, or 3 m × 3 for corners; None where there are none."""
        return self._values("normal")

    @property
    def uv(self) -> NDArray[np.float64] | None:
        """Its first texture coordinates, n × 2 or, for corners, 3 m × 2, with v up; None where there are none."""
        return self._values("uv")

    @property
    def colors(self) -> NDArray[np.float64] | None:
        """Its first colours, n × 3 or n × 4, from 0 to 1; None where there are none."""
        return self._values("color")

    @property
    def tangents(self) -> NDArray[np.float64] | None:
        """Its tangents with the sign of the bitangent, n × 4; None where there are none."""
        return self._values("tangent")

    @property
    def vertex_normals(self) -> NDArray[np.float64]:
        """A normal for each vertex: the mesh's own, else the mean over its faces by area."""
        import numpy as np

        own = self._vertex_rows("normal")
        if own is not None:
            values: NDArray[np.float64] = own
            return values
        sums = np.zeros_like(self.vertices)
        for corner in range(3):
            np.add.at(sums, self.faces[:, corner], self._crossed())
        return _unit(sums)

    @property
    def face_normals(self) -> NDArray[np.float64]:
        """The unit normal of each face, m × 3; 0 where a face has no area."""
        return _unit(self._crossed())

    @property
    def bounds(self) -> NDArray[np.float64]:
        """The lowest and the highest corner of the box, 2 × 3. Raises `ValueError` for an empty mesh."""
        return bounds_of(self.vertices)

    @property
    def extents(self) -> NDArray[np.float64]:
        """The lengths of the box along x, y and z; 0 for an empty mesh."""
        import numpy as np

        if len(self.vertices) == 0:
            return np.zeros(3)
        low, high = self.bounds
        extents: NDArray[np.float64] = high - low
        return extents

    @property
    def area(self) -> float:
        """The sum of the areas of the faces, as rounded."""
        import numpy as np

        return float(np.linalg.norm(self._crossed(), axis=1).sum() / 2)

    @property
    def volume(self) -> float:
        """The volume that closed triangles enclose, as rounded; of others the number has no meaning."""
        import numpy as np

        a, b, c = (self.vertices[self.faces[:, corner]] for corner in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)

    @property
    def center_mass(self) -> NDArray[np.float64]:
        """The centre of the volume of closed triangles, and of the area of others, as rounded."""
        import numpy as np

        if len(self.faces) == 0:
            raise ValueError("an empty mesh has no centre: nothing is in it")
        # Near the origin, so that no digits are lost of what is small and far away.
        middle = self.bounds.mean(axis=0)
        a, b, c = (self.vertices[self.faces[:, corner]] - middle for corner in range(3))
        weights = np.einsum("ij,ij->i", a, np.cross(b, c)) if self.is_watertight else np.zeros(len(a))
        shares = 4
        if weights.sum() == 0:
            weights, shares = np.linalg.norm(np.cross(b - a, c - a), axis=1), 3
        total = weights.sum()
        found: NDArray[np.float64] = middle + (0 if total == 0 else weights @ (a + b + c) / (shares * total))
        return found

    @property
    def euler_number(self) -> int:
        """Vertices minus edges plus faces, counted as for `is_watertight`: 2 for a closed mesh without handles."""
        return int(self._valid["euler"])

    @property
    def is_winding_consistent(self) -> bool:
        """Whether no two faces run along an edge the same way: counted as for `is_watertight`."""
        return bool(self._valid["oriented"])

    def vertex_curvature(self, kind: Literal["mean", "gaussian", "maximum", "minimum"] = "mean") -> NDArray[np.float64]:
        """The curvature at each vertex, as the triangles around it say: one over a length, or over its square for
        "gaussian". Positive where the surface bends away from its outside: a ball has one over its radius. "maximum" and
        "minimum" are the principal curvatures. NaN at borders.

        It is an estimate, without a bound: triangles that are near a surface need not have its curvature.

        >>> import chordal
        >>> ball = chordal.shapes.sphere(2).mesh(tol=0.001)
        >>> abs(float(ball.vertex_curvature().mean()) - 0.5) < 0.01
        True
        """
        import numpy as np

        if kind not in ("mean", "gaussian", "maximum", "minimum"):
            raise ValueError(f"kind: mean, gaussian, maximum or minimum, not {kind!r}")
        gaussian, mean = curvatures(self.vertices, self.faces)
        if kind in ("mean", "gaussian"):
            return mean if kind == "mean" else gaussian
        # The principal ones are the roots of a quadratic; rounding may leave none where they are equal.
        apart: NDArray[np.float64] = np.sqrt(np.maximum(mean * mean - gaussian, 0.0))
        principal: NDArray[np.float64] = mean + apart if kind == "maximum" else mean - apart
        return principal

    def vertex_deviation(self, other: Shape | Any, *, tol: Length | None = None) -> NDArray[np.float64]:
        """How far each vertex is from the triangles of another shape, as rounded; other shapes are meshed within `tol` first.
        `deviation` bounds what lies between the vertices, too.

        >>> import chordal
        >>> one = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
        >>> one.vertex_deviation(chordal.Mesh([(0, 0, 2), (1, 0, 2), (0, 1, 2)], [(0, 1, 2)]))
        array([2., 2., 2.])
        """
        import numpy as np

        return np.abs(self._distances_to(other, tol)(self.vertices))

    def _distances_to(self, other: Shape | Any, tol: Length | None) -> Field:
        """The distance to the triangles of another shape, with a sign."""
        from chordal._verbs import shaped

        return shaped("other", other).to_field(tol=tol)

    @property
    def is_watertight(self) -> bool:
        """Whether every edge has two faces that run along it in opposite ways: counted, by positions where the file has
        no indices.
        """
        return bool(self._valid["closed"])

    def _crossed(self) -> NDArray[np.float64]:
        import numpy as np

        a, b, c = (self.vertices[self.faces[:, corner]] for corner in range(3))
        crossed: NDArray[Any] = np.cross(b - a, c - a)
        return crossed

    @property
    def _valid(self) -> dict[str, Any]:
        if "valid" not in self._cached:
            self._cached["valid"] = self.report["certificate"]["valid"]
        found: dict[str, Any] = self._cached["valid"]
        return found

    @property
    def _scene(self) -> dict[str, Any]:
        if "scene" not in self._cached:
            self._cached["scene"] = json.loads(_chordal.scene_facts(self._source))
        found: dict[str, Any] = self._cached["scene"]
        return found

    def _values(self, kind: _Kind) -> NDArray[np.float64] | None:
        found = first_of(self.attributes, kind)
        return None if found is None else found.values

    def _array(self, name: str) -> NDArray[Any]:
        import numpy as np

        if name not in self._cached:
            outcome = self._outcome
            array = _chordal.scene_array(self._source, None, name, None) if outcome is None else outcome.array(name)
            self._cached[name] = np.asarray(array)
        found: NDArray[Any] = self._cached[name]
        return found

    def _written(self, form: Form, tol: Any, rel: Any) -> Written:
        """GLB and STL hold single precision. Their rounding counts against the budget of what was made within one, so for
        them the shape is meshed again, a little finer; the file is then the same, byte for byte, as the command's.
        """
        refuse_unknown(self, form.format)
        if self._outcome is None:
            return super()._written(form, tol, rel)
        if tol is not None or rel is not None:
            raise TypeError("tol, rel: they are for drawings; this was made within a budget already")
        return remade(self._outcome, Mesh._unjudged, form)

    def __reduce__(self) -> Any:
        state, blocks = _chordal.scene_state(self._source)
        return _again, (state, blocks, self._bound, self._text, self._is_given)

    def _size(self) -> str:
        n_faces, n_vertices = len(self.faces), len(self.vertices)
        return f"{counted(n_faces, 'triangle', 'triangles')}, {counted(n_vertices, 'vertex', 'vertices')}"

    def __repr__(self) -> str:
        if self._text is None and self._bound is None:
            name = f" {self._source.name}" if self._source.name else ""
            return f"<Mesh: {self._size()}, from {self.format}{name}>"
        return f"<Mesh: {self._size()}; {self.bound.sentence()}>"

    def show(self, *, wire: bool = False, deviation: Shape | None = None, height: int = 380) -> Shown:
        """The mesh as a notebook shows it, to be turned by hand: with its edges, or coloured by how far it is from another
        shape, at samples of all its triangles; `deviation` bounds what lies between them. Without that vertices have their
        own colours, and triangles those of their materials; of several parts, as labels are, each has one. It needs no
        network, and stays in a notebook that is exported to HTML. Very large meshes are a picture.

        >>> import chordal
        >>> "<iframe" in chordal.shapes.sphere(1).mesh(tol=0.1).show()._repr_html_() or "the package has no viewer"
        True
        """
        return Shown(self, html_of(self, wire=wire, against=deviation, height=height))

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        return {"text/plain": repr(self), "text/html": html_of(self)}


def _again(state: str, blocks: list[bytes], bound: Bound | None, report: str | None, is_given: bool) -> Mesh:
    """A mesh that was pickled."""
    made = Mesh._of_source(_chordal.scene_of_state(state, blocks, None), bound, report)
    made._is_given = is_given
    return made


def _colors(given: ArrayLike) -> NDArray[np.float64]:
    """Colours from 0 to 1, of floats or of bytes."""
    import numpy as np

    found = np.asanyarray(given)
    if found.dtype.kind == "u" and found.dtype.itemsize < 4:
        return coordinates("color", found) / float(np.iinfo(found.dtype).max)
    values = coordinates("color", found)
    if values.size and (values.min() < 0 or values.max() > 1):
        wrong = values.max() if values.max() > 1 else values.min()
        raise ValueError(f"colors: floats from 0 to 1, or bytes, as in colors.astype(numpy.uint8), not {wrong:g}")
    return values


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    import numpy as np

    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    found: NDArray[np.float64] = np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0)
    return found


