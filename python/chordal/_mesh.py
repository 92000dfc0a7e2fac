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
from chordal._registry import registered
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
    """Triangles: meshed within a budget, with their bound; read from a file; or given as arrays. A mesh is immutable.

    `Mesh(vertices, faces)` takes n × 3 coordinates and m × 3 indices of vertices; faces are counter-clockwise from their
    front. Arrays of any real and any integer type are copied. `normals` are n × 3, `uv` n × 2 with v up, `colors` n × 3 or
    n × 4: floats from 0 to 1, or bytes. `unit` is the unit of the coordinates, for lengths with a unit. `weld` merges vertices
    that are equal in all attributes, and links those with equal positions; without it, a `UserWarning` tells if no two
    triangles share a vertex.

    >>> import chordal
    >>> one = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    >>> one.faces
    array([[0, 1, 2]], dtype=int32)
    >>> one.area
    0.5
    >>> one.mesh(tol=0.1).report["certificate"]["valid"]["boundary_edges"]
    3
    """

    __slots__ = ("_bound", "_cached", "_is_given", "_outcome", "_report_text")

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
        attribute_rows: list[tuple[str, NDArray[np.float64]]] = []
        for kind, given, widths in (("normal", normals, (3,)), ("uv", uv, (2,)), ("color", colors, (3, 4))):
            if given is None:
                continue
            values = _colors(given) if kind == "color" else coordinates(kind, given)
            if values.ndim != 2 or values.shape[0] != len(points) or values.shape[1] not in widths:
                raise ValueError(f"{kind}: a row of {widths[0]} for each of {len(points)} vertices, not {values.shape}")
            attribute_rows.append((kind, values))
        position_ids = None
        # Indices out of range are left to the compiled part, which names them; welding would fail at them first.
        if weld and (rows.size == 0 or int(rows.max()) < len(points)):
            kept, rows, position_ids = welded(points, rows, [values for _, values in attribute_rows])
            # Adding 0.0 turns -0.0 into 0.0, which welding takes for equal.
            points, attribute_rows = points[kept] + 0.0, [(kind, values[kept]) for kind, values in attribute_rows]
        elif not weld:
            warn_of_soup(points, rows)
        blocks, attributes = [points.tobytes(), rows.tobytes()], []
        for kind, values in attribute_rows:
            set_index = None if kind == "normal" else 0
            width = values.shape[1]
            attributes.append({"kind": kind, "of": set_index, "domain": "vertex", "width": width, "block": len(blocks)})
            blocks.append(values.tobytes())
        part: dict[str, Any] = {"name": "triangles", "positions": 0, "faces": 1, "attributes": attributes}
        if position_ids is not None:
            part["position_id"] = len(blocks)
            blocks.append(position_ids.tobytes())
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
        self._report_text = report
        self._cached: dict[str, Any] = {}

    @classmethod
    def _of_source(cls, source: _chordal.Source, bound: Bound | None = None, report: str | None = None) -> Mesh:
        """Triangles from a file, or with a known bound."""
        mesh = cls.__new__(cls)
        mesh._set(source, None, bound, report)
        return mesh

    @classmethod
    def _of(cls, outcome: _chordal.Outcome) -> Mesh:
        """The triangles of an outcome, if they meet their budget."""
        return of_outcome(outcome, cls._unjudged)

    @classmethod
    def _unjudged(cls, outcome: _chordal.Outcome) -> Mesh:
        """The triangles of an outcome, whether or not they meet their budget."""
        mesh = cls.__new__(cls)
        mesh._set(None, outcome, None, None)
        return mesh

    @property
    def _text(self) -> str | None:
        """The text of the report; None for triangles that were read or given."""
        if self._report_text is None and self._outcome is not None:
            self._report_text = self._outcome.report
        return self._report_text

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
        """The format that it was read from, as in "glb"; "arrays" for triangles that were given as arrays."""
        return "arrays" if self._is_given else self._source.format

    @property
    def bound(self) -> Bound:
        """The distance from the true shape, and how it is known. Triangles that were read or given count as the true shape
        themselves; if their file states a distance from another shape, `report` has it.
        """
        if self._bound is not None:
            return self._bound
        facts = None if self._text is None else json.loads(self._text)["certificate"]["bound"]
        if facts is None:
            return Bound(0.0, 0.0, "proved", "hausdorff", "input triangles")
        return bound_of(facts)

    @property
    def report(self) -> Report:
        """The report of `chordal mesh --json` if the mesh was computed, else that of `chordal inspect`. You may change it."""
        return self.inspect() if self._text is None else Report(json.loads(self._text))

    @property
    def vertices(self) -> NDArray[np.float64]:
        """The positions of all visible parts, n × 3. Read-only, and not copied if there is a single part."""
        return self._array("vertices")

    @property
    def faces(self) -> NDArray[np.int32]:
        """The vertices of each face, m × 3, counter-clockwise from its front, in the order of a file. Read-only, as `vertices`."""
        return self._array("faces")

    @property
    def parts(self) -> tuple[Part, ...]:
        """The meshes of the scene, each in its own coordinates and with its attributes."""
        facts = self._scene["parts"]
        return tuple(Part(self._source, k, part) for k, part in enumerate(facts))

    @property
    def nodes(self) -> tuple[Node, ...]:
        """The nodes of the scene, which place its parts; `roots` are those without a parent."""
        return nodes_of(self._scene)

    @property
    def roots(self) -> tuple[int, ...]:
        """The indices of nodes without a parent."""
        return tuple(self._scene["roots"])

    @property
    def materials(self) -> list[dict[str, Any]]:
        """The materials, as glTF describes them. Number n of an attribute "group" of "material" is `materials[n - 1]`."""
        materials: list[dict[str, Any]] = json.loads(json.dumps(self._scene["materials"]))
        return materials

    @property
    def textures(self) -> list[dict[str, Any]]:
        """The textures of the materials, as glTF describes them: "source" is an index into `images`."""
        textures: list[dict[str, Any]] = json.loads(json.dumps(self._scene["textures"]))
        return textures

    @property
    def images(self) -> tuple[bytes | None, ...]:
        """The images of the textures, as PNG, JPEG or WebP files; None for one in another file that was not opened."""
        return tuple(_chordal.scene_image(self._source, k) for k in range(self._scene["images"]))

    @property
    def attributes(self) -> tuple[Attribute, ...]:
        """The attributes of the only part, in the space of the scene. If there are several, see `parts[k].attributes`."""
        if "attributes" not in self._cached:
            import numpy as np

            parts = self._scene["parts"]
            if len(parts) != 1:
                raise SeveralPartsError(len(parts))
            array = _chordal.scene_array
            self._cached["attributes"] = attributes_of(
                parts[0], lambda k: np.asarray(array(self._source, None, "attribute", k))
            )
        attributes: tuple[Attribute, ...] = self._cached["attributes"]
        return attributes

    @property
    def normals(self) -> NDArray[np.float64] | None:
        """The normals of the only part: n × 3, or 3 m × 3 for corners; None if there are none."""
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
    def tangents(self) -> NDArray[np.float64] | None:
        """Its tangents with the sign of the bitangent, n × 4; None if there are none."""
        return self._values("tangent")

    @property
    def vertex_normals(self) -> NDArray[np.float64]:
        """A normal for each vertex: the mesh's own, else the mean of its faces' normals, weighted by area."""
        import numpy as np

        own = self._vertex_rows("normal")
        if own is not None:
            normals: NDArray[np.float64] = own
            return normals
        sums = np.zeros_like(self.vertices)
        for corner in range(3):
            np.add.at(sums, self.faces[:, corner], self._cross_products())
        return _unit(sums)

    @property
    def face_normals(self) -> NDArray[np.float64]:
        """The unit normal of each face, m × 3; 0 for a face without area."""
        return _unit(self._cross_products())

    @property
    def bounds(self) -> NDArray[np.float64]:
        """The lowest and the highest corner of the bounding box, 2 × 3. Raises `ValueError` for an empty mesh."""
        return bounds_of(self.vertices)

    @property
    def extents(self) -> NDArray[np.float64]:
        """The sizes of the bounding box along x, y and z; 0 for an empty mesh."""
        import numpy as np

        if len(self.vertices) == 0:
            return np.zeros(3)
        low, high = self.bounds
        extents: NDArray[np.float64] = high - low
        return extents

    @property
    def area(self) -> float:
        """The sum of the areas of the faces, with rounding errors."""
        import numpy as np

        return float(np.linalg.norm(self._cross_products(), axis=1).sum() / 2)

    @property
    def volume(self) -> float:
        """The volume that closed triangles enclose, with rounding errors; meaningless for open ones."""
        import numpy as np

        a, b, c = (self.vertices[self.faces[:, corner]] for corner in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)

    @property
    def center_mass(self) -> NDArray[np.float64]:
        """The centroid of the volume for closed triangles, of the area for others, with rounding errors."""
        import numpy as np

        if len(self.faces) == 0:
            raise ValueError("an empty mesh has no centre: nothing is in it")
        # Relative to the middle of the box, so that no digits are lost for a small mesh far from the origin.
        middle = self.bounds.mean(axis=0)
        a, b, c = (self.vertices[self.faces[:, corner]] - middle for corner in range(3))
        weights = np.einsum("ij,ij->i", a, np.cross(b, c)) if self.is_watertight else np.zeros(len(a))
        # The centroid of a tetrahedron with a corner at the middle is (a + b + c) / 4, that of a triangle (a + b + c) / 3.
        n_corners = 4
        if weights.sum() == 0:
            weights, n_corners = np.linalg.norm(np.cross(b - a, c - a), axis=1), 3
        total = weights.sum()
        centroid: NDArray[np.float64] = middle + (0 if total == 0 else weights @ (a + b + c) / (n_corners * total))
        return centroid

    @property
    def euler_number(self) -> int:
        """Vertices minus edges plus faces, with vertices as for `is_watertight`: 2 for a closed mesh without handles."""
        return int(self._valid["euler"])

    @property
    def is_winding_consistent(self) -> bool:
        """Whether no two faces use an edge in the same direction, with vertices as for `is_watertight`."""
        return bool(self._valid["oriented"])

    def vertex_curvature(self, kind: Literal["mean", "gaussian", "maximum", "minimum"] = "mean") -> NDArray[np.float64]:
        """The curvature at each vertex, estimated from the triangles around it: one over a length, or over its square for
        "gaussian". It is positive where the surface bends away from its outside: one over the radius for a ball. "maximum" and
        "minimum" are the principal curvatures. NaN at borders.

        It is an estimate, without a bound: triangles close to a surface need not have a similar curvature.

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
        # The principal curvatures are the roots of a quadratic, whose discriminant may be below 0 by rounding if they are equal.
        half_difference: NDArray[np.float64] = np.sqrt(np.maximum(mean * mean - gaussian, 0.0))
        principal: NDArray[np.float64] = mean + half_difference if kind == "maximum" else mean - half_difference
        return principal

    def vertex_deviation(self, other: Shape | Any, *, tol: Length | None = None) -> NDArray[np.float64]:
        """The distance of each vertex to the triangles of another shape, with rounding errors; a shape that is no mesh is
        meshed within `tol` first. `deviation` also bounds the distance between the vertices.

        >>> import chordal
        >>> one = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
        >>> one.vertex_deviation(chordal.Mesh([(0, 0, 2), (1, 0, 2), (0, 1, 2)], [(0, 1, 2)]))
        array([2., 2., 2.])
        """
        import numpy as np

        return np.abs(self._distances_to(other, tol)(self.vertices))

    def _distances_to(self, other: Shape | Any, tol: Length | None) -> Field:
        """The signed distance to the triangles of another shape."""
        return registered.shaped("other", other).to_field(tol=tol)

    @property
    def is_watertight(self) -> bool:
        """Whether every edge has two faces that use it in opposite directions. Vertices are identified by their indices, or by
        their positions if the file has no indices.
        """
        return bool(self._valid["closed"])

    def _cross_products(self) -> NDArray[np.float64]:
        """The normal of each face, with twice its area as its length."""
        import numpy as np

        a, b, c = (self.vertices[self.faces[:, corner]] for corner in range(3))
        products: NDArray[Any] = np.cross(b - a, c - a)
        return products

    @property
    def _valid(self) -> dict[str, Any]:
        if "valid" not in self._cached:
            self._cached["valid"] = self.report["certificate"]["valid"]
        valid: dict[str, Any] = self._cached["valid"]
        return valid

    @property
    def _scene(self) -> dict[str, Any]:
        if "scene" not in self._cached:
            self._cached["scene"] = json.loads(_chordal.scene_facts(self._source))
        scene: dict[str, Any] = self._cached["scene"]
        return scene

    def _values(self, kind: _Kind) -> NDArray[np.float64] | None:
        attribute = first_of(self.attributes, kind)
        return None if attribute is None else attribute.values

    def _array(self, name: str) -> NDArray[Any]:
        import numpy as np

        if name not in self._cached:
            outcome = self._outcome
            array = _chordal.scene_array(self._source, None, name, None) if outcome is None else outcome.array(name)
            self._cached[name] = np.asarray(array)
        rows: NDArray[Any] = self._cached[name]
        return rows

    def _written(self, form: Form, tol: Any, rel: Any) -> Written:
        """GLB and STL store single precision, and the rounding counts against the budget of the mesh. For these formats the
        shape is therefore meshed again, a little finer; the file is then byte for byte that of the command.
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
        """The mesh as an interactive view in a notebook: with its edges (`wire`), or coloured by the distance from the shape
        `deviation`, at samples of all triangles (`Mesh.deviation` also bounds the distance between them). Otherwise colours
        are those of the vertices or of the materials, or each of several parts has its own. The view needs no network and
        is kept when the notebook is exported to HTML. Very large meshes are shown as a picture.

        >>> import chordal
        >>> "<iframe" in chordal.shapes.sphere(1).mesh(tol=0.1).show()._repr_html_() or "the package has no viewer"
        True
        """
        return Shown(self, html_of(self, wire=wire, against=deviation, height=height))

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        return {"text/plain": repr(self), "text/html": html_of(self)}


def _again(state: str, blocks: list[bytes], bound: Bound | None, report: str | None, is_given: bool) -> Mesh:
    """Restores a pickled mesh."""
    mesh = Mesh._of_source(_chordal.scene_of_state(state, blocks, None), bound, report)
    mesh._is_given = is_given
    return mesh


def _colors(given: ArrayLike) -> NDArray[np.float64]:
    """Colours from 0 to 1, given as floats or as bytes."""
    import numpy as np

    array = np.asanyarray(given)
    if array.dtype.kind == "u" and array.dtype.itemsize < 4:
        return coordinates("color", array) / float(np.iinfo(array.dtype).max)
    values = coordinates("color", array)
    if values.size and (values.min() < 0 or values.max() > 1):
        wrong = values.max() if values.max() > 1 else values.min()
        raise ValueError(f"colors: floats from 0 to 1, or bytes, as in colors.astype(numpy.uint8), not {wrong:g}")
    return values


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    import numpy as np

    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    units: NDArray[np.float64] = np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0)
    return units


registered.mesh = Mesh
